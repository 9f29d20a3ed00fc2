"""The list of the subcommands: name, help and module, which is imported when the command is run."""

from __future__ import annotations

import argparse
from importlib import import_module
from typing import NamedTuple, Protocol, cast


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
