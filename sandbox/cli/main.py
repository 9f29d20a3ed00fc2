"""The `softcradle` command and the list of its subcommands. Each is imported when it is run, so that help is instant."""

from __future__ import annotations

import argparse
import difflib
import os
import signal
import sys
import warnings
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, NoReturn, Protocol

from softcradle.sandbox.user_error import UserError


class CommandModule(Protocol):
    """What the module of a command provides."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        """Declare the command's arguments."""

    def main(self, args: argparse.Namespace) -> int:
        """Run the command and return its exit code. Raises UserError."""


class Command(NamedTuple):
    """A command: its name, its line in the help, and the function that imports its module."""

    name: str
    help: str
    load: Callable[[], CommandModule]


def _load_play() -> CommandModule:
    from softcradle.sandbox.cli.commands import play

    return play


def _load_scenes() -> CommandModule:
    from softcradle.sandbox.cli.commands import scenes

    return scenes


def _load_check() -> CommandModule:
    from softcradle.sandbox.cli.commands import check

    return check


def _load_run() -> CommandModule:
    from softcradle.sandbox.cli.commands import run

    return run


def _load_render() -> CommandModule:
    from softcradle.sandbox.cli.commands import render

    return render


def _load_compare() -> CommandModule:
    from softcradle.sandbox.cli.commands import compare

    return compare


def _load_figures() -> CommandModule:
    from softcradle.sandbox.cli.commands import figures

    return figures


def _load_chart() -> CommandModule:
    from softcradle.sandbox.cli.commands import chart

    return chart


def _load_stability() -> CommandModule:
    from softcradle.sandbox.cli.commands import stability

    return stability


def _load_maps() -> CommandModule:
    from softcradle.sandbox.cli.commands import maps

    return maps


def _load_experiment() -> CommandModule:
    from softcradle.sandbox.cli.commands import experiment

    return experiment


def _load_claims() -> CommandModule:
    from softcradle.sandbox.cli.commands import claims

    return claims


COMMANDS = (
    Command("play", "open the window, as softcradle without a command does", _load_play),
    Command("scenes", "list the scenes, or print the file of one", _load_scenes),
    Command("check", "check scene files and report every problem", _load_check),
    Command("run", "compute a scene: tables of results, .npz or .csv", _load_run),
    Command("render", "write a film, pictures or a kymograph of a scene", _load_render),
    Command("compare", "compare chains side by side: a film, a report and numbers", _load_compare),
    Command("figures", "draw the paper's figures, and write their numbers", _load_figures),
    Command("chart", "chart cost against error, beside other integrators", _load_chart),
    Command("stability", "map where each method fails, and how", _load_stability),
    Command("maps", "map where a struck cluster moves like a rigid body", _load_maps),
    Command("experiment", "fit bed friction to the losses of the paper's experiment", _load_experiment),
    Command("claims", "measure what the paper claims, and judge each claim", _load_claims),
)


class Parser(argparse.ArgumentParser):
    """An ArgumentParser that refuses in one sentence, as the rest of the command does."""

    def error(self, message: str) -> NoReturn:
        """Raise `message` as a UserError."""
        raise UserError(f"{message} (see {self.prog} --help)")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line `arguments` (None: those of the process); return the exit code, 2 for a user's mistake."""
    if arguments is None:
        # A terminated command ends like an interrupted one: half-written files are removed.
        signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    try:
        return _run(list(sys.argv[1:] if arguments is None else arguments))
    except UserError as error:
        print(f"softcradle: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("softcradle: interrupted", file=sys.stderr)
        return 130
    except BrokenPipeError:  # the reader of the output has closed it, as in `softcradle scenes | head -1`
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
        warnings.showwarning = _show_warning
        return module.main(args)


def _show_warning(message: Warning | str, *_: Any, **__: Any) -> None:
    print(f"softcradle: warning: {message}", file=sys.stderr)


def _module(name: str) -> CommandModule:
    """The module of the command of that name; UserError where there is none."""
    for command in COMMANDS:
        if command.name == name:
            return command.load()
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
    """Help with a column that the longest name of a command fits; argparse does not count the indent of the names."""

    def add_argument(self, action: argparse.Action) -> None:
        """Add the argument, and make the column as wide as an indented name and two spaces."""
        super().add_argument(action)
        self._action_max_length = max(self._action_max_length, 4 + max(len(command.name) for command in COMMANDS))


class _Version(argparse.Action):
    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        from softcradle.physics.version import version  # reads the installation: not for every start

        print(f"softcradle {version()}")
        parser.exit()
