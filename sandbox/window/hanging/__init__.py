"""The hanging cradle: soft contacts beside pymunk's rigid ones."""
