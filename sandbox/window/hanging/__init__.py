"""The hanging cradle, once with soft contacts and once with the rigid contacts of pymunk."""
