"""The `softcradle` command: finds the command that is asked for and imports that one alone, so that help is instant."""

from __future__ import annotations

import argparse
import difflib
import os
import signal
import sys
import warnings
from collections.abc import Sequence
from importlib import import_module
from typing import Any, NamedTuple, NoReturn, Protocol, cast

from softcradle.sandbox.user_error import UserError


class Command(NamedTuple):
    """A command: its name, the module with its `add_arguments` and `main`, and its line in the help."""

    name: str
    module: str
    help: str


COMMANDS: tuple[Command, ...] = (
    Command(
        "play", "softcradle.sandbox.cli.commands.play", "open the window; softcradle without a command does it too"
    ),
    Command("scenes", "softcradle.sandbox.cli.commands.scenes", "list the scenes, or print one to start your own from"),
    Command(
        "check",
        "softcradle.sandbox.cli.commands.check",
        "say whether scene files are right, and what is wrong with them",
    ),
    Command("run", "softcradle.sandbox.cli.commands.run", "compute a scene: table of results, .npz or .csv"),
    Command("render", "softcradle.sandbox.cli.commands.render", "make a film or pictures of a scene"),
    Command(
        "compare",
        "softcradle.sandbox.cli.commands.compare",
        "set chains side by side: one film, one report, all numbers",
    ),
    Command("figures", "softcradle.sandbox.cli.commands.figures", "draw the paper's figures, and write their numbers"),
    Command("chart", "softcradle.sandbox.cli.commands.chart", "speed against accuracy, beside other integrators"),
    Command("stability", "softcradle.sandbox.cli.commands.stability", "map where each method breaks, and how"),
    Command("maps", "softcradle.sandbox.cli.commands.maps", "map where a struck cluster moves like a rigid body"),
    Command(
        "experiment",
        "softcradle.sandbox.cli.commands.experiment",
        "fit the bed of the paper's experiment to what it lost",
    ),
    Command("claims", "softcradle.sandbox.cli.commands.claims", "check what the paper states: claims and measurements"),
)


class CommandModule(Protocol):
    """What the module of a command provides."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        """Declare the command's arguments."""

    def main(self, args: argparse.Namespace) -> int:
        """Do it; return the exit code. Raises UserError."""


class Parser(argparse.ArgumentParser):
    """An ArgumentParser whose refusals are one sentence, like all others."""

    def error(self, message: str) -> NoReturn:
        """Raise `message` as a UserError."""
        raise UserError(f"{message} (see {self.prog} --help)")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line `arguments` (those of the process if None); return the exit code, 2 for a user's mistake."""
    if arguments is None:
        # A terminated command ends like an interrupted one: it cleans up half-written files.
        signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    try:
        return _run(list(sys.argv[1:] if arguments is None else arguments))
    except UserError as error:
        print(f"softcradle: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("softcradle: interrupted", file=sys.stderr)
        return 130
    except BrokenPipeError:  # the reader of our output has gone, as in `softcradle scenes | head -1`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 141


def _run(arguments: list[str]) -> int:
    parser, parsers = _parsers()
    arguments = arguments or ["play"]
    wanted = next((word for word in arguments if not word.startswith("-")), None)
    module = None
    if wanted is not None:
        module = _module(wanted)
        module.add_arguments(parsers[wanted])
    args = parser.parse_args(arguments)
    if module is None:
        parser.print_help()
        return 0
    with warnings.catch_warnings():
        warnings.showwarning = _say_warning
        return module.main(args)


def _say_warning(message: Warning | str, *_: Any, **__: Any) -> None:
    print(f"softcradle: warning: {message}", file=sys.stderr)


def _module(name: str) -> CommandModule:
    for command in COMMANDS:
        if command.name == name:
            return cast(CommandModule, import_module(command.module))
    names = [command.name for command in COMMANDS]
    near = difflib.get_close_matches(name, names, n=1)
    hint = f"did you mean {near[0]}?" if near else f"there are {', '.join(names)}"
    raise UserError(f"there is no command {name!r}; {hint}")


def _parsers() -> tuple[Parser, dict[str, Parser]]:
    """The parser, and that of each command, still without the command's arguments."""
    parser = Parser(
        prog="softcradle",
        formatter_class=_Help,
        description="Rows of beads that only push on each other, softly: see them collide, and trust what you see.",
        epilog="softcradle COMMAND --help says more. A scene is a name from `softcradle scenes` or a file of your own.",
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version and exit")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", dest="command")
    return parser, {
        command.name: commands.add_parser(command.name, help=command.help, description=f"{command.help}.".capitalize())
        for command in COMMANDS
    }


class _Help(argparse.HelpFormatter):
    """Help in which the longest name of a command fits before its line: argparse forgets that names are indented."""

    def add_argument(self, action: argparse.Action) -> None:
        """Measure it, and leave room for two blanks more."""
        super().add_argument(action)
        self._action_max_length = max(self._action_max_length, 4 + max(len(command.name) for command in COMMANDS))


class _Version(argparse.Action):
    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        from softcradle.physics.version import version  # reads the installation: not for every start

        print(f"softcradle {version()}")
        parser.exit()
