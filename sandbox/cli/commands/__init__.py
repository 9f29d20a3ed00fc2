"""One module for each subcommand, with the functions `add_arguments` and `main`. `softcradle.sandbox.cli.main` lists
them.
"""
