"""What is known from outside, each number with its source, beside what softcradle finds."""
