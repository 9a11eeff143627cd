"""The real command line in this process: exit code, standard output, standard error."""

from __future__ import annotations

import contextlib
import io
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from surveyapp.cli.main import main

GOOD_TOML = """\
format = 1
name = "Test"
crs = "EPSG:4546"
angle_unit = "dms"

[[instrument]]
id = "G1"
card = "wild-gak1"
constant = { arcsec = -9.7, sigma_arcsec = 3.0 }

[[station]]
name = "A"
e = 431630.663
n = 3811452.311

[[station]]
name = "B"
e = 431634.860
n = 3811581.143

[[orientation]]
id = "run"
station = "A"
target = "B"
instrument = "G1"
method = "tracking"
purpose = "survey"
book = "observations/run.csv"
"""

GOOD_BOOK = """\
seq,kind,value,unit,face,side,target
1,backsight,40-00-00,,L,,B
2,backsight,220-00-04,,R,,B
3,reversal,359-00-00,,,L,
4,reversal,1-00-00,,,R,
5,reversal,359-00-40,,,L,
6,reversal,0-59-20,,,R,
7,reversal,359-01-20,,,L,
8,reversal,0-58-40,,,R,
9,backsight,40-00-02,,L,,B
10,backsight,220-00-02,,R,,B
"""


@dataclass(frozen=True)
class Outcome:
    """What a command did."""

    code: int
    out: str
    err: str

    @property
    def json(self) -> dict[str, Any]:
        """The one JSON object on standard output; NaN and Infinity are refused."""
        value = json.loads(self.out, parse_constant=_refuse)
        assert isinstance(value, dict)
        return value


def _refuse(constant: str) -> None:
    raise AssertionError(f"{constant} in the JSON")


def run(*arguments: str | Path) -> Outcome:
    """Run ``surveyapp`` with these arguments."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = main([str(argument) for argument in arguments])
    return Outcome(code, out.getvalue(), err.getvalue())


def good_project(folder: Path, *, toml: str = GOOD_TOML, book: str = GOOD_BOOK) -> Path:
    """Write a project that orients, or one with other text."""
    (folder / "observations").mkdir(parents=True, exist_ok=True)
    (folder / "project.toml").write_text(toml, encoding="utf-8")
    (folder / "observations" / "run.csv").write_text(book, encoding="utf-8")
    return folder
