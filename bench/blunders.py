"""Planted blunders: which are told, which stay silent with harm; how often clean projects alarm.

A clean project is simulated (two calibrations, two surveys of one line, both ends of the line
fixed or not; or, lean, one calibration and one survey of a line without coordinates of its own),
read and checked through the public interface. Then one blunder is planted into its files as a hand
makes it. It is told where the project is refused or a confirmed check is not met;
it is silent with harm where nothing is told and the grid azimuth is off by more than three of its
own sigmas; "asked" are those of them that a warning or a check that only warns asks about. What no
second session, no fixed coordinates and no card could have told is listed with what would be needed
to see it.
"""

from __future__ import annotations

import math
import tempfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from bench._blunder_plants import PLANTS, Files
from bench.coverage import specification, write_files
from surveyapp import api
from surveyapp.core.simulate.project import project_files, simulate_reversal_project
from surveyapp.core.simulate.specification import SwingMethod
from surveyapp.errors import SurveyError
from surveyapp_models.angles import wrap_pi

METHODS: tuple[SwingMethod, ...] = ("tracking", "transit", "amplitude")
LATITUDES_DEG = (47.0, -26.0, 62.0)
HARM = 3.0
"""Sigmas by which a silent result must be off to count."""


@dataclass(frozen=True, slots=True)
class Clean:
    """A clean project with its true azimuth [rad] and what could tell a blunder of it."""

    files: Files
    azimuth: float
    fixed: bool


def clean_projects(count: int, seed: int, *, lean: bool = False) -> Iterator[Clean]:
    """Simulated projects without a blunder; in every second the line has fixed coordinates.

    A lean one has a single calibration and a single survey, and coordinates of an old plan only.
    """
    rng = np.random.default_rng(seed)
    rounds = 1 if lean else 2
    for number in range(count):
        method, latitude = METHODS[number % 3], LATITUDES_DEG[(number // 3) % 3]
        spec = specification(method, latitude, rng)
        project = simulate_reversal_project(spec, rng, calibrations=rounds, surveys=rounds)
        files = project_files(project)
        survey = next(s for s in project.sessions if s.purpose == "survey")
        fixed = number % 2 == 0 and not lean
        if fixed:
            toml = files["project.toml"]
            for name in ("U1", "U2"):
                toml = toml.replace(f'name = "{name}"\n', f'name = "{name}"\nfixed = true\n')
            files["project.toml"] = toml
        yield Clean(files, survey.simulated.spec.line_azimuth, fixed)


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of one project.

    ``asked`` are the warnings and the checks that only warn.
    """

    told: tuple[str, ...]
    error: float | None
    sigma: float | None
    asked: frozenset[str] = frozenset()

    @property
    def harmful(self) -> bool:
        """Whether the azimuth is off by more than a user of its sigma expects."""
        if self.error is None or self.sigma is None:
            return False
        return abs(self.error) > HARM * self.sigma


def judged(files: Files, azimuth: float) -> Outcome:
    """Check and orient one project."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_files(folder, files)
        try:
            result = api.orient(folder)
        except SurveyError:
            return Outcome(("refused",), None, None)
        failed = [check for check in result.checks if check.passed is False]
        told = tuple(check.rule for check in failed if check.confirmed)
        asked = frozenset(check.rule for check in failed if not check.confirmed)
        asked |= {warning.code for warning in result.warnings}
    lines = [line for line in result.lines if line.grid_azimuth is not None]
    if not lines or lines[0].grid_azimuth is None:
        return Outcome(told or ("no azimuth",), None, None)
    found = lines[0].grid_azimuth
    true = azimuth + (math.pi if lines[0].station == "U2" else 0.0)
    return Outcome(told, wrap_pi(found.value - true), found.sigma, asked)


NEEDED = {
    "clamp": "a second clamping of the line, or fixed coordinates",
    "ends of": "fixed coordinates of both ends",
    "known azimuths in gon": "coordinates of the known line",
    "other hemisphere": "times of the swing cannot tell (the period is that of the other latitude)",
    "lambda of": "times of the turning points or passages: the period",
    "another target": "fixed coordinates, or a second session of the line",
    "known azimuth": "coordinates of the known line, or a second known line",
    "scale": "two clampings of the line, or a second session clamped elsewhere",
    "card of another": "times of the turning points or passages: the period",
    "station 1 deg": "coordinates of the target, or a traverse from the calibration line",
    "line 1 deg": "a traverse from the calibration line: the coordinates of both ends agree",
    "face": "sights in both faces, a second session",
    "sight": "sights before and after in both faces, a second session",
    "tape zero": "tape zeros before and after, five readings each",
    "turning point": "six turning points or more, with their times",
    "passage": "five passages or more",
    "scale reading": "six scale readings or more",
    "books": "a second session of the line, or fixed coordinates",
}
"""What would be needed to see what stays silent."""


def needed(name: str) -> str:
    """What would be needed to see a blunder."""
    return next((text for key, text in NEEDED.items() if name.startswith(key)), "-")


def alarms(count: int, seed: int) -> tuple[int, Counter[str]]:
    """Clean projects that alarm, and the rules that do."""
    wrong, rules = 0, Counter[str]()
    for clean in clean_projects(count, seed):
        told = judged(clean.files, clean.azimuth).told
        wrong += bool(told)
        rules.update(told)
    return wrong, rules


def planted(count: int, seed: int, *, lean: bool = False) -> dict[str, list[tuple[bool, Outcome]]]:
    """Outcomes of planted blunders by name, with whether the line had fixed coordinates.

    What is asked about in the clean project too says nothing of the blunder and is left out.
    """
    rng = np.random.default_rng(seed)
    found: dict[str, list[tuple[bool, Outcome]]] = {name: [] for name in PLANTS}
    done = 0
    while done < count:
        for clean in clean_projects(6, seed + 1000 + done, lean=lean):
            before = judged(clean.files, clean.azimuth).asked
            for name, plant in PLANTS.items():
                files = plant(clean.files, rng)
                if files is not None:
                    outcome = judged(files, clean.azimuth)
                    outcome = replace(outcome, asked=outcome.asked - before)
                    found[name].append((clean.fixed, outcome))
                    done += 1
    return found


def table(found: dict[str, list[tuple[bool, Outcome]]]) -> list[str]:
    """What became of the planted blunders, by name."""
    total = sum(map(len, found.values()))
    silent = {
        name: [o for _, o in items if not o.told and o.harmful] for name, items in found.items()
    }
    mute = [outcome for items in silent.values() for outcome in items]
    asked = sum(bool(outcome.asked) for outcome in mute)
    lines = [f"planted {total}, silent with harm {len(mute)}, of these asked about {asked}"]
    lines.append(
        "blunder                          planted  told  harmless  silent  asked  with fixed ends"
    )
    for name, items in found.items():
        told = sum(bool(o.told) for _, o in items)
        mute, fixed = (
            silent[name],
            sum(not o.told and o.harmful for is_fixed, o in items if is_fixed),
        )
        warned = sum(bool(o.asked) for o in mute)
        rest = len(items) - told - len(mute)
        words = Counter(code for o in mute for code in o.asked)
        why = f"  {needed(name)}" if mute else ""
        why += f" [{', '.join(code for code, _ in words.most_common(3))}]" if words else ""
        lines.append(
            f"{name:<32} {len(items):>7} {told:>5} {rest:>9} {len(mute):>7} {warned:>6} {fixed:>6}"
            f"{why}"
        )
    return lines


def run(clean: int = 400, blunders: int = 1000, lean: int = 500) -> list[str]:
    """Clean projects, then blunders in full programmes and in lean ones."""
    wrong, rules = alarms(clean, 20261128)
    lines = [f"clean projects {clean}, that alarm {wrong} ({wrong / clean:.1%})"]
    lines += [f"  {rule}: {number}" for rule, number in rules.most_common()]
    lines += ["two calibrations, two surveys", *table(planted(blunders, 20261129))]
    lines += ["one calibration, one survey, no coordinates of the line"]
    return lines + table(planted(lean, 20261130, lean=True))
