"""One module for each subcommand, with `add_arguments` and `main`; softcradle.sandbox.cli.main lists them."""
