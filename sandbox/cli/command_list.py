"""The list of the subcommands: name, help and module, which is imported when the command is run."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import NamedTuple, Protocol


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


def _load_sweep() -> CommandModule:
    from softcradle.sandbox.cli.commands import sweep

    return sweep


def _load_experiment() -> CommandModule:
    from softcradle.sandbox.cli.commands import experiment

    return experiment


def _load_claims() -> CommandModule:
    from softcradle.sandbox.cli.commands import claims

    return claims


def _load_verify() -> CommandModule:
    from softcradle.sandbox.cli.commands import verify

    return verify


def _load_methods() -> CommandModule:
    from softcradle.sandbox.cli.commands import method_list

    return method_list


def _load_warm() -> CommandModule:
    from softcradle.sandbox.cli.commands import warm

    return warm


def _load_completion() -> CommandModule:
    from softcradle.sandbox.cli.commands import completion

    return completion


COMMANDS = (
    Command("play", "open the window, as softcradle without a command does", _load_play),
    Command("scenes", "list the scenes, or print the file of one", _load_scenes),
    Command("methods", "list the methods, and what each is for", _load_methods),
    Command("check", "check scene files and report every problem", _load_check),
    Command("run", "compute a scene: tables of results, .npz or .csv", _load_run),
    Command("render", "write a film, pictures or a kymograph of a scene", _load_render),
    Command("compare", "compare chains side by side: a film, a report and numbers", _load_compare),
    Command("figures", "draw the paper's figures, and write their numbers", _load_figures),
    Command("chart", "chart cost against error, beside other integrators", _load_chart),
    Command("stability", "map where each method fails, and how", _load_stability),
    Command("maps", "map where a struck cluster moves like a rigid body", _load_maps),
    Command("sweep", "compute a study of many points, on this machine or many", _load_sweep),
    Command("experiment", "fit bed friction to the losses of the paper's experiment", _load_experiment),
    Command("claims", "measure what the paper claims, and judge each claim", _load_claims),
    Command("verify", "check numbers that are known from outside, each with its source", _load_verify),
    Command("warm", "compile all methods ahead of their first use", _load_warm),
    Command("completion", "print what lets bash, zsh or fish complete the command", _load_completion),
)
