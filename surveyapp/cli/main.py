"""The entry of the command line: finds the command, runs it, turns errors into exit codes.

Exit codes: 0 good; 1 a confirmed limit or test is not met; 2 bad input; 3 internal fault. Only the
module of the chosen command is imported, so that ``--help`` is instant.
"""

from __future__ import annotations

import argparse
import contextlib
import importlib
import os
import re
import sys
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from types import ModuleType
from typing import Any, NoReturn, Self

from surveyapp import __version__
from surveyapp.cli.languages import in_wished
from surveyapp.cli.numbers import finite
from surveyapp.cli.output import print_json
from surveyapp.cli.refusals import of_argparse, told
from surveyapp.cli.safe_output import safe_output
from surveyapp.cli.waiting import Waiting
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.languages import either, said
from surveyapp.languages.said import Said, Translate

EXIT_GOOD, EXIT_LIMIT, EXIT_INPUT, EXIT_FAULT = 0, 1, 2, 3


@dataclass(frozen=True, slots=True)
class Command:
    """One command: its name, the module that holds it, and its line in the help."""

    name: str
    module: str
    summary: str
    waits: bool = True
    """Whether a bar is shown while it runs; screens and those with a bar of their own have none."""
    speaks: bool = False
    """Whether what it prints is made of the texts of the record and follows the language."""


COMMANDS: tuple[Command, ...] = (
    Command("open", "open_project", "open the terminal screens on one project", waits=False),
    Command("orient", "orient", "field book to gyro north, constant and grid azimuth", speaks=True),
    Command("check", "check", "apply every limit and test that the data can answer", speaks=True),
    Command(
        "adjust", "adjust", "traverse or .gkf network to coordinates, sigmas and tests", speaks=True
    ),
    Command(
        "report", "report", "the survey record as PDF, or a blank field-book form", speaks=True
    ),
    Command(
        "diagnose",
        "diagnose",
        "which effect does the model lack, and how sure is that",
        speaks=True,
    ),
    Command(
        "calibrate",
        "calibrate",
        "a sensor log to parameters, sigmas and a sensor card",
        waits=False,
    ),
    Command(
        "spectrum",
        "spectrum",
        "interference lines of a record, and a magnetic bias budget",
        waits=False,
    ),
    Command("motion", "motion", "state of motion of a vehicle, and its path", waits=False),
    Command(
        "north", "north", "north by a rate sensor: on a total station, indexed, turned", waits=False
    ),
    Command(
        "allan",
        "allan",
        "Allan deviation and noise coefficients of a sensor log",
        waits=False,
    ),
    Command(
        "programme", "programme", "a guided calibration, step by step, to its card", waits=False
    ),
    Command("compensate", "compensate", "a sensor card applied to a log", waits=False),
    Command(
        "filter",
        "filter",
        "a filter on a sensor log: deviation before, after, and its lag",
        waits=False,
    ),
    Command(
        "close", "close", "seal a project or a session with a hash chain in the ledger", speaks=True
    ),
    Command("reopen", "reopen", "open what was closed; the ledger keeps the reason", speaks=True),
    Command("compare", "compare", "what changed between two results, and because of what"),
    Command(
        "import",
        "import_file",
        "field files of total stations and gyros into a project",
        waits=False,
    ),
    Command("instrument", "instrument", "read a total station on the cable", waits=False),
    Command("export", "export", "results, points, drawings, maps; a project as zip"),
    Command(
        "batch", "batch", "many projects, one row each; failures are told, not fatal", waits=False
    ),
    Command("new", "new", "make a new project folder"),
    Command("models", "models", "instrument cards and what is known of them"),
    Command("predict", "predict", "how far two headings will miss each other, and what helps"),
    Command("shaft", "shaft", "orientation through one shaft or two, joined with the gyro"),
    Command("plan", "plan", "method, points and minutes for a wanted interval at this latitude"),
    Command("simulate", "simulate", "a simulated project with any effect, its truth apart"),
    Command(
        "practise", "practise", "observe a simulated instrument, then see the truth", waits=False
    ),
    Command("demo", "demo", "orient the measured samples: printed against computed"),
)


ARGUMENT = re.compile(r"`([A-Za-z][A-Za-z0-9_]*)`")
OPTIONS = {"columns": "--map", "units": "--unit", "fixed": "--fix"}
"""Options that are called otherwise than the arguments of the API that they give."""


class Typed(Said):
    """A text that has its options put in after it was translated: no catalogue holds them."""

    __slots__ = ("origin", "put_in")
    origin: str
    put_in: Callable[[str], str]

    @classmethod
    def of(cls, text: str, put_in: Callable[[str], str]) -> Self:
        """The English of ``text`` with what is put in, and how that is done."""
        found = cls(put_in(text), {})
        found.origin, found.put_in = text, put_in
        return found

    def told(self, translate: Translate) -> str:
        """The text in the language of ``translate``."""
        if isinstance(self.origin, Said):
            return self.put_in(self.origin.told(translate))
        return self.put_in(translate(self.origin, None, 0))


NEGATIVE = re.compile(r"-\.?\d")
"""How a negative number begins, and a list of numbers (``-2.6,0.4``): no option does."""


class Parser(argparse.ArgumentParser):
    """An argument parser whose errors are survey errors."""

    def __init__(self, **given: Any) -> None:
        """Let ``-2.6,0.4`` be a value: the parser knows single negative numbers only."""
        super().__init__(**given)
        self._negative_number_matcher = NEGATIVE

    def error(self, message: str) -> NoReturn:
        """Raise instead of leaving: the error may have to be printed as JSON."""
        missing = message.removeprefix("the following arguments are required: ")
        expected = missing if missing != message else ""
        what = "an argument is missing" if expected else of_argparse(message)
        hint = said("See {prog} --help.", prog=self.prog)
        raise SurveyError(Problem(what=what, where=self.prog, expected=expected, hint=hint))

    def parse_strictly(self, arguments: Sequence[str]) -> argparse.Namespace:
        """Parse; what is left over is refused with the nearest options.

        Raises
        ------
        SurveyError
        """
        options, rest = self.parse_known_intermixed_args(arguments)
        if not rest:
            return options
        known = [name for action in self._actions for name in action.option_strings if name[2:]]
        raise SurveyError(
            Problem(
                what="there is no such option" if rest[0][:1] == "-" else "one argument too many",
                where=self.prog,
                found=rest[0],
                expected="the options of this command",
                hint=nearest_names(rest[0], known),
            )
        )

    def as_typed(self, problem: Problem) -> Problem:
        """A problem that names arguments of the API, with the options that gave them.

        The API names an argument alone (``where``), or between backticks within a text.
        """
        known = {name for action in self._actions for name in action.option_strings}

        def option(name: str) -> str | None:
            found = OPTIONS.get(name, f"--{name.replace('_', '-')}")
            return found if found in known else None

        def typed(text: str) -> str:
            if "`" not in text:
                return text
            return Typed.of(text, lambda x: ARGUMENT.sub(lambda y: option(y[1]) or y[0], x))

        return Problem(
            what=typed(problem.what),
            where=option(problem.where) or typed(problem.where),
            found=problem.found,
            expected=typed(problem.expected),
            hint=typed(problem.hint),
        )

    def _get_value(self, action: argparse.Action, arg_string: str) -> Any:
        """The value of an option; a number must be finite."""
        if action.type not in (int, float):
            return super()._get_value(action, arg_string)
        whole = action.type is int
        value = finite(arg_string)
        if value is not None and not (whole and value % 1):
            return int(value) if whole else value
        raise SurveyError(
            Problem(
                what="this is no whole number" if whole else "this is no number",
                where=action.option_strings[0] if action.option_strings else self.prog,
                found=arg_string,
                expected="a whole number" if whole else "a finite number",
            )
        )

    def _check_value(self, action: argparse.Action, value: object) -> None:
        if action.choices is None or value in action.choices:
            return
        raise SurveyError(
            Problem(
                what="this is none of the possible values",
                where=action.option_strings[-1] if action.option_strings else self.prog,
                found=str(value),
                expected=either(str(choice) for choice in action.choices),
                hint=nearest_names(str(value), [str(choice) for choice in action.choices]),
            )
        )


def parser_of(command: Command) -> Parser:
    """The parser of a command, with its options."""
    summary = command.summary
    parser = Parser(prog=f"surveyapp {command.name}", description=summary, allow_abbrev=False)
    _module(command.module).add_arguments(parser)
    return parser


def _hint(word: str, names: Iterable[str]) -> str:
    """What to call instead of a word that is no command."""
    if os.path.isdir(word):  # noqa: PTH112 - pathlib is not loaded for this
        return said("`surveyapp open {folder}` opens a project", folder=word)
    return nearest_names(word, names)


def main(arguments: Sequence[str]) -> int:
    """Run one command and return its exit code."""
    with safe_output():
        return _main(arguments)


def _main(arguments: Sequence[str]) -> int:
    as_json = "--json" in arguments
    try:
        code = _run(list(arguments))
        _flush()
    except SurveyError as error:
        return _tell(error, EXIT_INPUT, as_json=as_json)
    except KeyboardInterrupt:
        return 130
    except BrokenPipeError:  # the reader has seen enough, as head does
        _leave_output()
        return EXIT_GOOD
    except Exception as fault:  # the last resort: a fault of ours, never a traceback for a surveyor
        if os.environ.get("SURVEYAPP_DEBUG"):
            raise
        refused, code = _told_fault(fault)
        return _tell(refused, code, as_json=as_json and code == EXIT_FAULT)
    return code


def _told_fault(fault: Exception) -> tuple[SurveyError, int]:
    if isinstance(fault, OSError) and fault.filename is None and fault.strerror:
        _leave_output()
        where, hint = "standard output", "Is the disk full?"
        what = said("the result cannot be written ({strerror})", strerror=fault.strerror)
        return SurveyError(Problem(what=what, where=where, hint=hint)), EXIT_INPUT
    what = said("internal fault: {name}: {fault}", name=type(fault).__name__, fault=fault)
    hint = "This is a fault of the program. Set SURVEYAPP_DEBUG=1 to see where."
    return SurveyError(Problem(what=what, hint=hint)), EXIT_FAULT


def _flush() -> None:
    """Write what is still held back while an error can be told; a closed output is None."""
    if sys.stdout is not None:
        sys.stdout.flush()


def _leave_output() -> None:
    """Give up standard output, so that nothing is written to it again at the very end."""
    with contextlib.suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


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
                hint=_hint(first, names),
            )
        )
    command = names[first]
    parser = parser_of(command)
    options = parser.parse_strictly(arguments[1:])
    try:
        with contextlib.ExitStack() as stack:
            if command.speaks:
                stack.enter_context(in_wished())
            bar = Waiting(first, sys.stderr if command.waits else None)
            options.advance = stack.enter_context(bar).advance
            return int(_module(command.module).run(options))
    except SurveyError as error:
        raise SurveyError([parser.as_typed(problem) for problem in error.problems]) from None


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


def _tell(error: SurveyError, code: int, *, as_json: bool) -> int:
    """Tell every problem, as JSON on standard output if that can be written; return the code."""
    try:
        if as_json:
            problems = [problem.to_dict() for problem in error.problems]
            print_json({"schema": "surveyapp.error/1", "problems": problems})
            _flush()
            return code
    except OSError:  # told on standard error instead
        _leave_output()
    with in_wished():
        for text in told(error):
            print(text, file=sys.stderr)
    return code
