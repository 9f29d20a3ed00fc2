"""The softcradle command: its arguments, its tables of results, and one module for each subcommand."""
