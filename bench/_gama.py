"""GNU Gama as a peer: what ``gama-local`` answered, before anything is made of its time.

``gama-local`` ends with exit code 0 also where it has adjusted nothing (a closed network of 1000
points without approximate coordinates): only its XML tells.
"""

from __future__ import annotations

import math
import shutil
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Final
from xml.etree.ElementTree import Element, ParseError

from defusedxml.ElementTree import parse

PROGRAM: Final = "gama-local"
SPACE: Final = "{http://www.gnu.org/software/gama/gama-local-adjustment}"
MOST_S: Final = 600.0
ALIKE: Final = 1e-3
"""Largest relative difference of two a-posteriori standard deviations of one adjustment."""


@dataclass(frozen=True, slots=True)
class Expected:
    """What our own adjustment of the same file found: degrees of freedom and sigma 0 [-]."""

    dof: int
    sigma0: float


@dataclass(frozen=True, slots=True)
class Answer:
    """Seconds of the peer, and why they cannot be compared; empty where they can."""

    seconds: float
    refused: str = ""


def there() -> bool:
    """Whether the program is on the PATH."""
    return shutil.which(PROGRAM) is not None


def adjusted(path: Path, expected: Expected) -> Answer:
    """Adjust a .gkf file with the peer, and look at what it answered."""
    program = shutil.which(PROGRAM)
    if program is None:
        return Answer(math.nan, f"{PROGRAM} is not on the PATH")
    out = path.with_suffix(".out.xml")
    out.unlink(missing_ok=True)
    start = time.perf_counter()
    try:
        run = subprocess.run(
            [program, str(path), "--cov-band", "0", "--xml", str(out)],
            capture_output=True,
            text=True,
            check=False,
            timeout=MOST_S,
        )
    except subprocess.TimeoutExpired:
        return Answer(MOST_S, f"no answer within {MOST_S:g} s")
    seconds = time.perf_counter() - start
    if run.returncode:
        told = (run.stderr or run.stdout).strip().splitlines()
        return Answer(seconds, f"exit code {run.returncode}: {told[-1] if told else 'no word'}")
    return Answer(seconds, refused(out, expected))


def refused(out: Path, expected: Expected) -> str:
    """Why an XML answer is no adjustment of our network; empty where it is one."""
    try:
        root = parse(out).getroot()
    except (OSError, ParseError) as failure:
        return f"its answer cannot be read ({failure})"
    if root is None:
        return "its answer is empty"
    error = root.find(f".//{SPACE}error")
    if error is not None:
        words = " ".join("".join(error.itertext()).split())
        return f"it ended in an error ({error.get('category', '')}: {words})"
    try:
        dof = int(_text(root, "degrees-of-freedom"))
        sigma0 = float(_text(root, "aposteriori")) / float(_text(root, "apriori"))
    except ValueError as failure:
        return f"its answer holds no adjustment ({failure})"
    if dof != expected.dof:
        return f"it adjusted another network ({dof} degrees of freedom, ours {expected.dof})"
    if not math.isclose(sigma0, expected.sigma0, rel_tol=ALIKE):
        return f"it found another result (sigma 0 {sigma0:.5g}, ours {expected.sigma0:.5g})"
    return ""


def _text(root: Element, name: str) -> str:
    found = root.find(f".//{SPACE}{name}")
    if found is None or not found.text:
        raise ValueError(f"no {name}")
    return found.text


def compared(path: Path, ours_s: float, expected: Expected) -> str:
    """The peer's part of a line: its time and the ratio, or why there is none."""
    answer = adjusted(path, expected)
    if answer.refused:
        return f"; {PROGRAM} no ratio: {answer.refused}"
    return f"; {PROGRAM} {answer.seconds:.2f} s, ratio {answer.seconds / ours_s:.1f}"
