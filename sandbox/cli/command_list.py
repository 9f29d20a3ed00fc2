"""The subcommands: name, help, and module, which is imported when the command is run; and their parsers, which refuse in one
sentence, and refuse an option that is given twice."""

from __future__ import annotations

import argparse
from importlib import import_module
from typing import TYPE_CHECKING, Any, NamedTuple, NoReturn, Protocol, cast

from softcradle.sandbox.user_error import UserError

if TYPE_CHECKING:
    from _typeshed import SupportsWrite


class CommandModule(Protocol):
    """What the module of a command provides."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        """Declare the command's arguments."""

    def main(self, args: argparse.Namespace) -> int:
        """Run the command and return its exit code. Raises UserError."""


class Command(NamedTuple):
    """A command: its name, its line in the help, and the name of its module where that is another."""

    name: str
    help: str
    module: str = ""

    def load(self) -> CommandModule:
        """Import the module."""
        return cast(CommandModule, import_module(f"softcradle.sandbox.cli.commands.{self.module or self.name}"))


COMMANDS = (
    Command("play", "open the window, as softcradle without a command does"),
    Command("scenes", "list the scenes, or print the file of one"),
    Command("methods", "list the methods, and what each is for", "method_list"),
    Command("check", "check scene files and report every problem"),
    Command("run", "compute a scene: tables of results, .npz or .csv"),
    Command("render", "write a film, pictures or a kymograph of a scene"),
    Command("page", "write a page in which the beads of a scene live, for any browser"),
    Command("compare", "compare chains side by side: a film, a report and numbers"),
    Command("figures", "draw the paper's figures, and write their numbers"),
    Command("chart", "chart cost against error, beside other integrators"),
    Command("stability", "map where each method fails, and how"),
    Command("maps", "map where a struck cluster moves like a rigid body"),
    Command("sweep", "compute a study of many points, on this machine or many"),
    Command("experiment", "fit bed friction to the losses of the paper's experiment"),
    Command("claims", "measure what the paper claims, and judge each claim"),
    Command("verify", "check numbers that are known from outside, each with its source"),
    Command("warm", "compile all methods ahead of their first use"),
    Command("completion", "print what lets bash, zsh or fish complete the command"),
)


class Parser(argparse.ArgumentParser):
    """An ArgumentParser that refuses in one sentence, as the rest of the command does."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings)
        for name in (None, "store"):
            self.register("action", name, _StoreOnce)
        self.add_argument(
            "-q", "--quiet", action="store_true", default=argparse.SUPPRESS,
            help="leave out progress and the names of written files",
        )  # fmt: skip

    def print_help(self, file: SupportsWrite[str] | None = None) -> None:
        """Print the help; argparse itself would be silent where it cannot be written."""
        print(self.format_help(), end="", file=file)

    def error(self, message: str) -> NoReturn:
        """Raise `message` as a UserError."""
        raise UserError(f"{message} (see {self.prog} --help)")


class _StoreOnce(argparse.Action):
    """Store a value; argparse would let the last of several replace the others in silence."""

    def __call__(
        self, parser: argparse.ArgumentParser, namespace: argparse.Namespace, values: Any, option: str | None = None
    ) -> None:
        if option and getattr(namespace, self.dest, self.default) is not self.default:
            parser.error(f"argument {'/'.join(self.option_strings)}: is given twice")
        setattr(namespace, self.dest, values)


def command_parsers() -> tuple[Parser, dict[str, Parser]]:
    """The parser, and that of each command, still without the command's arguments."""
    parser = Parser(
        prog="softcradle",
        formatter_class=_Help,
        description="Rows of beads that only push on each other, softly: see them collide, and trust what you see.",
        epilog="softcradle COMMAND --help says more. A scene is a name from `softcradle scenes` or a file of your own. "
        "Exit codes: 0; 2 for what cannot be done; 3 where a run gave up before its end; 4 for a sweep that lost points.",
    )
    parser.add_argument("-V", "--version", action=_Version, nargs=0, help="print the version and exit")
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
