"""One module a command: `add_arguments(parser)` and `main(args) -> exit code`; softcradle.sandbox.cli.main lists them."""
