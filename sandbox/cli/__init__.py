"""The softcradle command: arguments, console, tables, one module a command."""
