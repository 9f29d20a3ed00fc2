"""`softcradle completion SHELL`: print a script for a shell. With this script, the shell completes commands, options,
methods and scenes.
"""

import argparse

SHELLS = ("bash", "zsh", "fish")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("shell", choices=SHELLS, help='such as: eval "$(softcradle completion bash)" in ~/.bashrc')


def main(args: argparse.Namespace) -> int:
    """Print the completion script."""
    from argcomplete.shell_integration import shellcode

    print(shellcode(["softcradle"], shell=args.shell))
    return 0
