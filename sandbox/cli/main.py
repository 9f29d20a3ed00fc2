"""The `softcradle` command with its subcommands. An error is reported as a message of one sentence and an exit code.

The module of a subcommand is imported only when the subcommand runs. If an option is given twice, the parsers report an
error.
"""

from __future__ import annotations

import argparse
import difflib
import io
import logging
import os
import signal
import sys
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib import import_module
from typing import TYPE_CHECKING, Any, NamedTuple, NoReturn, Protocol, TextIO, cast

from softcradle.sandbox.console import is_quiet, set_quiet
from softcradle.sandbox.user_error import (
    CLOSED_PIPE,
    GAVE_UP,
    HUNG_UP,
    INTERRUPTED,
    MISTAKE,
    TERMINATED,
    GaveUpError,
    UserError,
    reason,
)

if TYPE_CHECKING:
    from _typeshed import SupportsWrite


class CommandModule(Protocol):
    """Interface that the module of each subcommand implements."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        """Declare the arguments of the command."""

    def main(self, args: argparse.Namespace) -> int:
        """Run the command and return its exit code. Raise UserError for a mistake of the user."""


class Command(NamedTuple):
    """Subcommand of `softcradle`. A command consists of its name and its line in the help. The name is also the name of
    its module.
    """

    name: str
    help: str

    def load(self) -> CommandModule:
        """Import and return the module of the command."""
        return cast(CommandModule, import_module(f"softcradle.sandbox.cli.commands.{self.name}"))


COMMANDS = (
    Command("play", "open the window, as softcradle without a command does"),
    Command("scenes", "list the scenes, or print the file of one"),
    Command("methods", "list the methods, and what each is for"),
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
    Command("fit", "fit free values of a scene to measured data, or search values for a goal"),
    Command("experiment", "fit bed friction to the losses of the paper's experiment"),
    Command("claims", "measure what the paper claims, and judge each claim"),
    Command("verify", "check numbers that are known from outside, each with its source"),
    Command("warm", "compile all methods ahead of their first use"),
    Command("completion", "print what lets bash, zsh or fish complete the command"),
)


class Parser(argparse.ArgumentParser):
    """ArgumentParser that raises UserError with a message of one sentence. The parser of argparse would print its
    usage.
    """

    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings)
        for name in (None, "store"):
            self.register("action", name, _StoreOnce)
        self.add_argument(
            "-q", "--quiet", action="store_true", default=argparse.SUPPRESS,
            help="leave out progress and the names of written files",
        )  # fmt: skip

    def print_help(self, file: SupportsWrite[str] | None = None) -> None:
        """Print the help. If the output cannot be written, raise an error. The method of argparse would ignore it."""
        print(self.format_help(), end="", file=file)

    def error(self, message: str) -> NoReturn:
        """Raise a UserError with the text `message`."""
        raise UserError(f"{message} (see {self.prog} --help)")


class _StoreOnce(argparse.Action):
    """Action that stores the value of an option and rejects a repeated option. The action of argparse would keep the
    last value without a message.
    """

    def __call__(
        self, parser: argparse.ArgumentParser, namespace: argparse.Namespace, values: Any, option: str | None = None
    ) -> None:
        if option and getattr(namespace, self.dest, self.default) is not self.default:
            parser.error(f"argument {'/'.join(self.option_strings)}: is given twice")
        setattr(namespace, self.dest, values)


def command_parsers() -> tuple[Parser, dict[str, Parser]]:
    """Return the main parser, and the parser of each command by the name of the command. The arguments of the commands
    are not declared yet.
    """
    parser = Parser(
        prog="softcradle",
        formatter_class=_Help,
        description="Rows of beads that only push on each other, softly: see them collide, and trust what you see.",
        epilog="softcradle COMMAND --help says more. A scene is a name from `softcradle scenes` or a file of your own. "
        "Exit codes: 0; 1 where verify finds a number that is not met; 2 for what cannot be done; 3 where a run "
        "gave up before its end; 4 for a sweep that lost points.",
    )
    parser.add_argument("-V", "--version", action=_Version, nargs=0, help="print the version and exit")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", dest="command")
    return parser, {
        command.name: commands.add_parser(command.name, help=command.help, description=f"{command.help}.".capitalize())
        for command in COMMANDS
    }


class _Help(argparse.HelpFormatter):
    """Help formatter whose first column is as wide as the longest command name. The formatter of argparse ignores that
    command names are indented.
    """

    def add_argument(self, action: argparse.Action) -> None:
        """Add the argument. Widen the first column to the longest indented name plus two spaces."""
        super().add_argument(action)
        self._action_max_length = max(self._action_max_length, 4 + max(len(command.name) for command in COMMANDS))


class _Version(argparse.Action):
    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        # Importing the version reads the metadata of the installation. At the top of the module, it would slow down
        # every start.
        from softcradle.physics.version import version

        print(f"softcradle {version()}")
        parser.exit()


ERASE_LINE = "\r\x1b[K"
OTHER_WORDS = {"list": "scenes", "open": "play", "show": "play", "view": "play", "video": "render", "film": "render"}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line `arguments` and return the exit code. If `arguments` is None, use the arguments of the
    process.

    The exit codes are:

    * 0: success
    * 1: `verify` found a wrong number
    * 2: mistake of the user
    * 3: a simulation gave up before its end
    * 4: a sweep lost points
    * 129 and 143: hang-up signal and termination signal
    * 130: interrupt
    * 141: the reader of the output closed the pipe
    """
    if arguments is None:
        # A terminated command ends in the same way as an interrupted command, because half-written files must be
        # removed.
        for number in (getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name)):
            # Signals that are ignored at the start remain ignored, for example under nohup.
            if signal.getsignal(number) != signal.SIG_IGN:
                signal.signal(number, lambda number, _: sys.exit(128 + number))
        for stream in (sys.stdout, sys.stderr):  # The encoding of these streams may lack subscripts and Greek letters.
            if isinstance(stream, io.TextIOWrapper):
                stream.reconfigure(errors="replace")
    try:
        return _flushed(list(sys.argv[1:] if arguments is None else arguments))
    except UserError as error:
        print(f"softcradle: {error}", file=sys.stderr)
        return GAVE_UP if isinstance(error, GaveUpError) else MISTAKE
    except KeyboardInterrupt:
        print("softcradle: interrupted", file=sys.stderr)
        return INTERRUPTED
    except SystemExit as error:
        if error.code in (TERMINATED, HUNG_UP):
            print("softcradle: terminated", file=sys.stderr)
        raise
    except BrokenPipeError:  # The reader has closed the pipe, as in `softcradle scenes | head -1`.
        discard(sys.stdout)
        return CLOSED_PIPE


def _flushed(arguments: list[str]) -> int:
    """Run the command and flush its output. The output is flushed even if the command fails."""
    try:
        try:
            return _run(arguments)
        finally:
            sys.stdout.flush()
    except BrokenPipeError:
        raise
    # Errors of output files have already become UserErrors. The remaining errors concern the standard output.
    except OSError as error:
        discard(sys.stdout)
        unnamed = "the current folder" if isinstance(error, FileNotFoundError) else "standard output"
        raise UserError(f"cannot write to {error.filename or unnamed}: {reason(error)}") from None


def _run(arguments: list[str]) -> int:
    parser, parsers = command_parsers()
    if "_ARGCOMPLETE" in os.environ:
        _complete(parser, parsers)
    arguments = arguments or ["play"]
    wanted = next((word for word in arguments if not word.startswith("-")), None)
    module = None
    if wanted is not None:
        module = _module(wanted)
        module.add_arguments(parsers[wanted])
    args, unknown = parser.parse_known_args(arguments)
    if unknown:
        parsers.get(wanted or "", parser).error(f"unrecognized arguments: {' '.join(unknown)}")
    if module is None:
        parser.print_help()
        return 0
    set_quiet(getattr(args, "quiet", False))
    with warnings.catch_warnings(), compilation_shown():
        warnings.showwarning = _show_warning
        return _with_extras(module, args)


def _with_extras(module: CommandModule, args: argparse.Namespace) -> int:
    """Run the command. Raise UserError if the command needs a package that is not installed."""
    from softcradle.physics.extras import needed_for

    try:
        with needed_for(f"softcradle {args.command}", "window" if args.command == "play" else None):
            return module.main(args)
    except ImportError as error:
        # If a compiled module is interrupted while it is loaded, it raises an ImportError with this cause.
        if isinstance(error.__cause__, KeyboardInterrupt | SystemExit):
            raise error.__cause__ from None
        raise UserError(str(error)) from None


def _complete(parser: Parser, parsers: dict[str, Parser]) -> None:
    """Print the completions that the shell has requested, and exit."""
    import argcomplete

    for command in COMMANDS:
        command.load().add_arguments(parsers[command.name])
    argcomplete.autocomplete(parser)


def _show_warning(message: Warning | str, *_: Any, **__: Any) -> None:
    print(f"softcradle: warning: {message}", file=sys.stderr)


def _module(name: str) -> CommandModule:
    """Return the module of the command `name`. Raise UserError if the command does not exist."""
    for command in COMMANDS:
        if command.name == name:
            return command.load()
    names = [command.name for command in COMMANDS]
    near = [OTHER_WORDS[name]] if name in OTHER_WORDS else difflib.get_close_matches(name, names, n=1)
    hint = f"did you mean {near[0]}?" if near else f"there are {', '.join(names)}"
    raise UserError(f"there is no command {name!r}; {hint}")


def discard(stream: TextIO) -> None:
    """Redirect the stream to the null device. If the stream were not redirected, Python would try again to write the
    buffered output when it exits.
    """
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


class CompileNotes(logging.Handler):
    """Logging handler that prints the messages of the logger `softcradle`."""

    def __init__(self, stream: TextIO) -> None:
        super().__init__(logging.INFO)
        self._stream, self._follows = stream, stream.isatty()

    def emit(self, record: logging.LogRecord) -> None:
        """Print the message. Warnings are printed as lines. On a terminal, progress is printed on a line that the next
        message replaces.
        """
        if record.levelno >= logging.WARNING:
            self._stream.write(f"softcradle: {record.getMessage()}\n")
        elif self._follows:
            self._stream.write(f"{ERASE_LINE}{record.getMessage()}")
        self._stream.flush()

    def close(self) -> None:
        """Erase the last progress message from the terminal."""
        if self._follows:
            self._stream.write(ERASE_LINE)
        super().close()


@contextmanager
def compilation_shown() -> Iterator[None]:
    """Print warnings while the block runs. Also print the progress of compilation, unless the user has requested quiet
    output.
    """
    logger, notes = logging.getLogger("softcradle"), CompileNotes(sys.stderr)
    level, passed_on = logger.level, logger.propagate
    if is_quiet():
        notes.setLevel(logging.WARNING)
        # Messages about waiting for kernels are progress, not warnings.
        notes.addFilter(lambda record: record.module != "kernel_tiers")
    logger.addHandler(notes)
    logger.setLevel(logging.INFO)
    logger.propagate = False
    try:
        yield
    finally:
        logger.removeHandler(notes)
        notes.close()
        logger.setLevel(level)
        logger.propagate = passed_on
