"""The entry of the command line: finds the command, runs it, turns errors into exit codes.

Exit codes: 0 good; 1 a confirmed limit or test is not met; 2 bad input; 3 internal fault. Only the
module of the chosen command is imported, so that ``--help`` is instant.
"""

from __future__ import annotations

import argparse
import importlib
import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from types import ModuleType
from typing import NoReturn

from surveyapp import __version__
from surveyapp.cli.output import print_json
from surveyapp.errors import Problem, SurveyError, nearest_names

EXIT_GOOD, EXIT_LIMIT, EXIT_INPUT, EXIT_FAULT = 0, 1, 2, 3


@dataclass(frozen=True, slots=True)
class Command:
    """One command: its name, the module that holds it, and its line in the help."""

    name: str
    module: str
    summary: str


COMMANDS: tuple[Command, ...] = (
    Command("open", "open_project", "open the terminal screens on one project"),
    Command("orient", "orient", "field book to gyro north, constant and grid azimuth"),
    Command("check", "check", "apply every limit and test that the data can answer"),
    Command("new", "new", "make a new project folder"),
    Command("models", "models", "instrument cards and what is known of them"),
    Command("plan", "plan", "method, points and minutes for a wanted interval at this latitude"),
    Command("simulate", "simulate", "a simulated project with any effect, its truth apart"),
    Command("demo", "demo", "orient the measured samples: printed against computed"),
)


class Parser(argparse.ArgumentParser):
    """An argument parser whose errors are survey errors."""

    def error(self, message: str) -> NoReturn:
        """Raise instead of leaving: the error may have to be printed as JSON."""
        raise SurveyError(Problem(what=message, where=self.prog, hint=f"See {self.prog} --help."))


def main(arguments: Sequence[str]) -> int:
    """Run one command and return its exit code."""
    as_json = "--json" in arguments
    try:
        return _run(list(arguments))
    except SurveyError as error:
        _tell(error, as_json=as_json)
        return EXIT_INPUT
    except KeyboardInterrupt:
        return 130
    except BrokenPipeError:
        sys.stderr.close()
        return EXIT_GOOD
    except Exception as fault:  # the last resort: a fault of ours, never a traceback for a surveyor
        if os.environ.get("SURVEYAPP_DEBUG"):
            raise
        what = f"internal fault: {type(fault).__name__}: {fault}"
        hint = "This is a fault of the program. Set SURVEYAPP_DEBUG=1 to see where."
        _tell(SurveyError(Problem(what=what, hint=hint)), as_json=as_json)
        return EXIT_FAULT


def _run(arguments: list[str]) -> int:
    if not arguments:
        return int(_module("open_project").run_home())
    first = arguments[0]
    if first in ("-h", "--help", "help"):
        print(help_text())
        return EXIT_GOOD
    if first in ("-V", "--version"):
        print(f"surveyapp {__version__}")
        return EXIT_GOOD
    names = {command.name: command for command in COMMANDS}
    if first not in names:
        raise SurveyError(
            Problem(
                what="there is no command of this name",
                where="surveyapp",
                found=first,
                hint=nearest_names(first, names),
            )
        )
    module = _module(names[first].module)
    parser = Parser(prog=f"surveyapp {first}", description=names[first].summary)
    module.add_arguments(parser)
    return int(module.run(parser.parse_args(arguments[1:])))


def _module(name: str) -> ModuleType:
    return importlib.import_module(f"surveyapp.cli.{name}")


def help_text() -> str:
    """The help of the program: every command in one line."""
    width = max(len(command.name) for command in COMMANDS)
    lines = [
        "usage: surveyapp [COMMAND] [...]",
        "",
        "Gyro-theodolite orientation for mine surveying. Without a command: the terminal screens.",
        "",
        "commands:",
    ]
    lines += [f"  {command.name:<{width}}  {command.summary}" for command in COMMANDS]
    lines += [
        "",
        "surveyapp COMMAND --help tells the options; --json prints one JSON object.",
        "Exit codes: 0 good; 1 a confirmed limit or test not met; 2 bad input; 3 internal fault.",
    ]
    return "\n".join(lines)


def _tell(error: SurveyError, *, as_json: bool) -> None:
    if as_json:
        problems = [problem.to_dict() for problem in error.problems]
        print_json({"schema": "surveyapp.error/1", "problems": problems})
        return
    for problem in error.problems:
        head = f"{problem.where}: {problem.what}" if problem.where else problem.what
        print(head, file=sys.stderr)
        for label, text in (
            ("found", problem.found),
            ("expected", problem.expected),
            ("", problem.hint),
        ):
            if text:
                print(f"  {label + ': ' if label else ''}{text}", file=sys.stderr)
