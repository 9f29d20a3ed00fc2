"""What makes files that the project ships: run by hand, no part of the package."""
