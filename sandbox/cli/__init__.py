"""The `softcradle` command. The package contains its arguments, its tables of results, and one module for each
subcommand.
"""
