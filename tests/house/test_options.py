"""Errors of the API name its arguments; the command line puts its options in their place."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

from surveyapp.cli.main import COMMANDS, parser_of
from surveyapp.errors import Problem
from surveyapp.languages import in_language, said, shown

ROOT = Path(__file__).resolve().parents[2] / "surveyapp"
ROOMS = ("api", "workflows", "io", "diagnosis", "core", "domain")
OPTION = re.compile(r"(?<![\w-])--[a-z][a-z-]+")
WHOLE = ("surveyapp ", "dask ", "diagnose --")
"""A command that is told with its options is no speech of options."""
FIELDS = ("what", "found", "expected", "hint")


def texts(node: ast.AST) -> str:
    """Every text that stands in a node."""
    own = [node.value] if isinstance(node, ast.Constant) and isinstance(node.value, str) else []
    return " ".join([*own, *map(texts, ast.iter_child_nodes(node))])


def told_in_an_error(node: ast.AST) -> bool:
    """Whether a node is a problem, or what is put into one under its name."""
    if isinstance(node, ast.Call):
        return ast.unparse(node.func) == "Problem"
    if isinstance(node, ast.Assign | ast.AugAssign | ast.AnnAssign):
        names = node.targets if isinstance(node, ast.Assign) else [node.target]
        return any(ast.unparse(name).lower() in FIELDS for name in names)
    return False


def test_no_error_of_the_api_speaks_of_an_option() -> None:
    faults = []
    for room in ROOMS:
        for path in sorted((ROOT / room).rglob("*.py")):
            text = path.read_text(encoding="utf-8")
            if not OPTION.search(text):
                continue
            for node in filter(told_in_an_error, ast.walk(ast.parse(text))):
                told = texts(node)
                if OPTION.search(told) and not any(word in told for word in WHOLE):
                    faults.append(f"{path.relative_to(ROOT)}:{getattr(node, 'lineno', 0)}")
    assert faults == []


@pytest.mark.parametrize(
    ("command", "given", "shown"),
    [
        ("orient", Problem("x", "session"), Problem("x", "--session")),
        ("import", Problem("x", "columns"), Problem("x", "--map")),
        (
            "import",
            Problem("x", "a", "", "`units` hz= gon"),
            Problem("x", "a", "", "--unit hz= gon"),
        ),
        (
            "import",
            Problem("x", hint="`skip_damaged` leaves such lines out"),
            Problem("x", hint="--skip-damaged leaves such lines out"),
        ),
        ("orient", Problem("x", "`units` foot"), Problem("x", "`units` foot")),
        ("north", Problem("x", "rate_sigma_deg_h"), Problem("x", "--rate-sigma-deg-h")),
    ],
)
def test_the_command_line_shows_the_option_that_gave_an_argument(
    command: str, given: Problem, shown: Problem
) -> None:
    parser = parser_of(next(item for item in COMMANDS if item.name == command))
    assert parser.as_typed(given) == shown


@pytest.mark.parametrize("marked", [True, False])
def test_options_are_put_into_the_words_of_every_language(marked: bool) -> None:
    """Of a text with values, and of a literal that the catalogue knows by its place."""
    parser = parser_of(next(item for item in COMMANDS if item.name == "import"))
    plain = "`skip_damaged` leaves such lines out and lists them"
    hint = said("`columns` {name}=COLUMN names it", name="mag_x_uT") if marked else plain
    typed = parser.as_typed(Problem("x", hint=hint)).hint
    option = "--map mag_x_uT=COLUMN" if marked else "--skip-damaged"
    assert typed.startswith(option)
    for language in ("de", "ru", "zh"):
        with in_language(language):
            told = shown(typed)
        assert option in told
        assert "`" not in told
        assert told != typed
