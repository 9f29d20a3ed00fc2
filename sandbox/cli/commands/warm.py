"""`softcradle warm`: compile the kernels of all methods before they are used for the first time."""

import argparse

from softcradle.sandbox.console import note
from softcradle.sandbox.user_error import UserError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("methods", metavar="METHOD", nargs="*", help="methods to compile (default: all)")


def main(args: argparse.Namespace) -> int:
    """Compile all kernels."""
    from time import perf_counter

    from softcradle.physics.warm_up import warm

    began = perf_counter()
    try:
        warm(args.methods or None)
    except ValueError as error:
        raise UserError(str(error)) from None
    note(f"{', '.join(args.methods) or 'all methods'} ready, in {perf_counter() - began:.1f} s")
    return 0
