"""Mutated .gkf files and project folders never end in a fault: 1500 files, 2400 projects.

Bytes, numbers, names and lines of sound files are changed at random; every command answers with
0, 1 or 2, without a traceback and without NaN, within 20 s. The suite runs a seeded part of it.
``SURVEYAPP_PART=gkf|projects`` takes one part, ``SURVEYAPP_FROM``, ``SURVEYAPP_COUNT`` and
``SURVEYAPP_SECONDS`` some of its numbers: each number is a seed of its own. Seconds are those of
the processor, so that a busy machine makes no fault.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import random
import shutil
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from bench._parts import FaultsFoundError, Part
from surveyapp.cli.main import main as command
from tests.network.hostile_numbers import mutated

ROOT = Path(__file__).resolve().parents[1]
NETWORKS = ROOT.parent / "shared" / "data" / "networks"
SAMPLES = ("johannesburg-1966", "gi-b1-1966", "tongjin-2015", "synthetic-breakthrough")
COMMANDS = ("orient", "check", "adjust", "predict", "shaft", "diagnose", "report", "export")
COUNTS = {"gkf": 1500, "projects": 2400}
LONGEST_S = 20.0


@dataclass(slots=True)
class Tally:
    """Exit codes, the longest answer, and every fault with its seed."""

    codes: Counter[int] = field(default_factory=Counter)
    longest: float = 0.0
    faults: list[str] = field(default_factory=list)

    def add(self, name: str, arguments: list[str]) -> None:
        """Run a command and judge its answer."""
        code, seconds, text = run_one(arguments)
        self.codes[code] += 1
        self.longest = max(self.longest, seconds)
        if code not in (0, 1, 2) or seconds > LONGEST_S:
            self.faults.append(f"{name}, {arguments[0]}: {code}, {seconds:.1f} s, {text[-300:]}")


def run_one(arguments: list[str]) -> tuple[int, float, str]:
    """Exit code (4 where a number is NaN or infinite), seconds of processor and what was said."""
    out, err = io.StringIO(), io.StringIO()
    began = time.process_time()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = command(arguments)
    if code in (0, 1, 2) and "--json" in arguments and not _is_json(out.getvalue()):
        code = 4
    return code, time.process_time() - began, out.getvalue() + err.getvalue()


def _is_json(text: str) -> bool:
    """Whether it is one object without NaN or Infinity; a name may hold these words."""
    odd: list[str] = []
    try:
        json.loads(text, parse_constant=odd.append)
    except ValueError:
        return False
    return not odd


def run() -> list[str]:
    """Both parts, or the one that is asked for."""
    part = os.environ.get("SURVEYAPP_PART")
    lines = []
    for name, work in (("gkf", _networks), ("projects", _projects)):
        if part in (None, name):
            lines += _campaign(name, work)
    return lines


def _campaign(name: str, work: Callable[[Iterator[int], Path, Tally], None]) -> list[str]:
    part, tally = Part(COUNTS[name]), Tally()
    with tempfile.TemporaryDirectory() as folder:
        work(iter(part), Path(folder), tally)
    codes = dict(sorted(tally.codes.items()))
    told = [
        f"mutated {name} {part.told}: exit codes {codes}, longest {tally.longest:.1f} s, "
        f"{len(tally.faults)} with a fault"
    ]
    if tally.faults:
        raise FaultsFoundError(told + [f"  {fault}" for fault in tally.faults[:12]])
    return told


def _networks(seeds: Iterator[int], folder: Path, tally: Tally) -> None:
    sources = sorted(NETWORKS.rglob("*.gkf"))
    path = folder / "mutated.gkf"
    for seed in seeds if sources else ():
        rng = random.Random(seed)
        path.write_bytes(mutated(rng.choice(sources).read_bytes(), rng))
        tally.add(f"seed {seed}", ["adjust", str(path), "--json"])


def _projects(seeds: Iterator[int], folder: Path, tally: Tally) -> None:
    for seed in seeds:
        rng = random.Random(seed)
        place = folder / f"p{seed}"
        source = ROOT / "projects" / rng.choice(SAMPLES)
        shutil.copytree(source, place, ignore=shutil.ignore_patterns("results", "ledger.jsonl"))
        files = [place / "project.toml", *sorted((place / "observations").glob("*.csv"))]
        path = rng.choice((files[0], rng.choice(files)))
        path.write_bytes(mutated(path.read_bytes(), rng))
        name = rng.choice(COMMANDS)
        tally.add(f"seed {seed}", arguments_of(name, place))
        shutil.rmtree(place)


def arguments_of(name: str, place: Path) -> list[str]:
    """A command on a project."""
    if name == "report":
        return ["report", str(place), "-o", str(place / "results.pdf"), "--json"]
    if name == "export":
        return ["export", "zip", str(place), f"{place}.zip", "--json"]
    return [name, str(place), "--json"]
