"""Modules of the subcommands. Each module has the functions `add_arguments` and `main`. `softcradle.sandbox.cli.main`
contains the list of subcommands.
"""
