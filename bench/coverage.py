"""Does ``interval95_arcsec`` hold the truth? Every method, five latitudes, both hemispheres.

The route of every run: integrate the two-axis equation of motion, write a project with its field
book, read and orient it through the public interface, compare with the truth of the simulation.
Then the lines of ``_coverage_lines``: what a session does not show of itself. Prints both tables
and writes docs/reference/coverage.md. The suite runs a seeded subset with the bounds of the
binomial distribution.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
from numpy.typing import NDArray
from scipy.stats import beta

from bench._coverage_lines import LINES as FURTHER
from bench._coverage_lines import Line, Quantity
from bench._coverage_sides import Drawn
from surveyapp import api
from surveyapp.core.simulate.project import (
    ProjectSession,
    SimulatedProject,
    card_text,
    project_files,
    project_truth,
)
from surveyapp.core.simulate.session import simulate_sessions
from surveyapp.core.simulate.specification import SessionSpec, SwingMethod
from surveyapp_models.angles import ARCSEC, RHO_ARCSEC, wrap_pi

LATITUDES_DEG = (-33.0, -10.0, 23.0, 47.0, 62.0)
METHODS: tuple[SwingMethod, ...] = ("tracking", "amplitude", "transit", "full_fit")
POINTS = {"tracking": 8, "amplitude": 8, "transit": 5, "full_fit": 5}
LINES_DIV = {"full_fit": (-3.0, 0.0, 3.0)}
"""The full fit times three lines of the scale, the transit method its middle alone."""
ENSEMBLE = 8
"""Runs that share damping, clamp and tape zero; everything random is drawn anew for each."""
FURTHER_RUNS = 1000
"""Of each further line, in parts of so many that each is done within seconds."""
PART = 500
PAGE = Path(__file__).resolve().parent.parent / "docs/reference/coverage.md"
HEAD = """# Does the 95 % interval hold the truth?

*Written by `python -m bench coverage`; do not edit it.*

Declared simulation. The two-axis equation of motion of a suspended gyro is integrated (the last two
lines: rounds of automatic gyros are drawn), field books and project are written as text, read and
oriented through the public interface, and the azimuth is compared with the truth. What a line is
about is put into the readings by its exact forward model. `holds truth` is the share of intervals
that hold the true value, with its own 95 % limits (Clopper and Pearson); `sd/sigma` the standard
deviation of the errors over the mean sigma. *Before*: what an independent examination found.

"""


@dataclass(frozen=True, slots=True)
class Coverage:
    """Errors, sigmas and interval half-widths of many runs [arcsec], for one quantity."""

    errors: NDArray[np.float64]
    sigmas: NDArray[np.float64]
    intervals: NDArray[np.float64]

    @property
    def share(self) -> float:
        """Share of the intervals that hold the truth."""
        return float(np.mean(np.abs(self.errors) <= self.intervals))

    @property
    def bias_in_sigma(self) -> float:
        """Mean error divided by the mean sigma."""
        return float(np.mean(self.errors) / np.mean(self.sigmas))


def specification(
    method: SwingMethod, latitude_deg: float, rng: np.random.Generator
) -> SessionSpec:
    """A session as it happens: damping, drifting tape zero, clamp off north, sights."""
    first_zero = float(rng.uniform(-0.3, 0.3))
    return SessionSpec(
        method=method,
        latitude=math.radians(latitude_deg),
        points=POINTS[method],
        ratio=float(rng.uniform(0.985, 0.998)),
        clamp_offset=float(rng.uniform(-600.0, 600.0)) * ARCSEC,
        circle_of_north=float(rng.uniform(0.0, 2.0 * math.pi)),
        line_azimuth=float(rng.uniform(0.0, 2.0 * math.pi)),
        tape_zero_div=(first_zero, first_zero + float(rng.uniform(-0.15, 0.15))),
        lines_div=LINES_DIV.get(method, (0.0,)),
    )


def runs(method: SwingMethod, count: int, seed: int) -> Iterator[tuple[dict[str, float], ...]]:
    """Yield (error, sigma, interval) of gyro north and of the gyro azimuth for each run."""
    rng = np.random.default_rng(seed)
    with tempfile.TemporaryDirectory() as folder:
        for number in range(math.ceil(count / ENSEMBLE)):
            spec = specification(method, LATITUDES_DEG[number % len(LATITUDES_DEG)], rng)
            size = min(ENSEMBLE, count - number * ENSEMBLE)
            for simulated in simulate_sessions(spec, size, rng):
                session = ProjectSession("run-1", "survey", "U1", "U2", simulated)
                project = SimulatedProject("Coverage", (session,), card_text(spec, rng))
                yield one_run(Path(folder), project)


def one_run(folder: Path, project: SimulatedProject) -> tuple[dict[str, float], ...]:
    """Write, orient, compare: error, sigma and interval of gyro north and of the gyro azimuth."""
    for name, text in project_files(project).items():
        path = folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")
    with without_tests():
        result = api.orient(folder).to_dict()["sessions"][0]
    truth = project_truth(project)["sessions"]["run-1"]
    return tuple(
        {
            "error": wrap_pi(math.radians(result[name]["deg"] - truth[f"{name}_deg"])) * RHO_ARCSEC,
            "sigma": result[name]["sigma_arcsec"],
            "interval": result[name]["interval95_arcsec"],
        }
        for name in ("gyro_north", "gyro_azimuth")
    )


def campaign(method: SwingMethod, count: int, seed: int) -> tuple[Coverage, Coverage]:
    """Coverage of gyro north and of the gyro azimuth over ``count`` runs."""
    table = list(runs(method, count, seed))
    north, azimuth = (
        Coverage(
            *(np.array([row[i][key] for row in table]) for key in ("error", "sigma", "interval"))
        )
        for i in range(2)
    )
    return north, azimuth


def azimuth_of(result: dict[str, Any], quantity: Quantity) -> dict[str, float] | None:
    """The azimuth that a line judges; None where lines of a side disagree and are not combined."""
    if quantity == "gyro":
        found = result["sessions"][0]["gyro_azimuth"]
    else:
        found = result["lines" if quantity == "grid" else "combined"][0]["grid_azimuth"]
    return None if found is None else dict(found)


@contextmanager
def without_tests() -> Iterator[None]:
    """Leave out the tests of fit: they draw many numbers and change no azimuth."""
    places = ("surveyapp.core.swing.tracking", "surveyapp.core.swing.clamped_north")
    with ExitStack() as stack:
        for place in places:
            stack.enter_context(patch(f"{place}.goodness_of_fit", lambda *_, **__: ()))
        yield


def judged(folder: Path, drawn: Drawn, quantity: Quantity) -> tuple[float, float, float] | None:
    """Error, sigma and half-width of the interval [arcsec] of one drawn project."""
    write_files(folder, drawn.files)
    with without_tests():
        found = azimuth_of(api.orient(folder).to_dict(), quantity)
    if found is None:
        return None
    error = wrap_pi(math.radians(found["deg"]) - drawn.azimuth) * RHO_ARCSEC
    return error, found["sigma_arcsec"], found["interval95_arcsec"]


def write_files(folder: Path, files: dict[str, str]) -> None:
    """Write the files of a project."""
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


def part_of(line: Line, count: int, seed: tuple[int, int]) -> tuple[Coverage, int]:
    """Coverage of some runs of a further line, and how many of them gave no value."""
    rng = np.random.default_rng(seed)
    with tempfile.TemporaryDirectory() as name:
        table = [judged(Path(name), item, line.quantity) for item in line.draw(count, rng)]
    told = np.array([row for row in table if row is not None])
    return Coverage(told[:, 0], told[:, 1], told[:, 2]), len(table) - len(told)


def joined(parts: Sequence[tuple[Coverage, int]]) -> tuple[Coverage, int]:
    """Several parts as one."""
    names = ("errors", "sigmas", "intervals")
    whole = (np.concatenate([getattr(item, name) for item, _ in parts]) for name in names)
    return Coverage(*whole), sum(silent for _, silent in parts)


def further(line: Line, count: int, seed: int) -> tuple[Coverage, int]:
    """Coverage of a further line, and how many of its runs gave no value."""
    starts = range(0, count, PART)
    return joined([part_of(line, min(PART, count - at), (seed, at)) for at in starts])


def row_of(name: str, quantity: str, item: Coverage, before: str = "", *, silent: int = 0) -> str:
    """One row of the table."""
    held = round(item.share * item.errors.size)
    size = item.errors.size
    low = float(beta.ppf(0.025, held, size - held + 1))
    high = float(beta.ppf(0.975, held + 1, size - held)) if held < size else 1.0
    ratio = float(np.std(item.errors) / np.mean(item.sigmas))
    note = ""
    if silent:
        tried = size + silent
        few = float(beta.ppf(0.025, silent, tried - silent + 1))
        many = float(beta.ppf(0.975, silent + 1, tried - silent))
        note = f"; {silent / tried:.1%} ({few:.1%} to {many:.1%}) disagree"
    return (
        f"| {name} | {quantity} | {size} | {item.share:.3f} ({low:.3f} to {high:.3f}){note} | "
        f"{item.bias_in_sigma:+.2f} | {ratio:.2f} | {np.mean(item.sigmas):.2f} | "
        f"{np.mean(item.intervals):.2f} | {before} |"
    )


NAMES = {"gyro": "gyro azimuth", "grid": "grid azimuth", "combined": "side, combined"}


def method_rows(place: int) -> list[str]:
    """Rows of the method at a place of ``METHODS``: 1000 runs."""
    method = METHODS[place]
    both = zip(
        ("gyro north", "gyro azimuth"), campaign(method, 1000, 20261122 + place), strict=True
    )
    return [row_of(method.replace("_", " "), name, item) for name, item in both]


def further_rows(place: int) -> list[str]:
    """Row of the further line at a place of ``FURTHER``: 1000 runs."""
    line = FURTHER[place]
    found, silent = further(line, FURTHER_RUNS, 20261128 + place)
    return [row_of(line.name, NAMES[line.quantity], found, line.before, silent=silent)]


def page(rows: list[str]) -> list[str]:
    """Write the page; its table."""
    lines = [
        "| line | quantity | runs | holds truth | bias/sigma | sd/sigma "
        '| sigma " | 95 % " | before |',
        "|---|---|---|---|---|---|---|---|---|",
        *rows,
    ]
    PAGE.write_text(HEAD + "\n".join(lines) + "\n", encoding="utf-8")
    return lines


def run() -> list[str]:
    """The whole campaign: 1000 runs a line; writes the page."""
    rows = [row for place in range(len(METHODS)) for row in method_rows(place)]
    return page(rows + [row for place in range(len(FURTHER)) for row in further_rows(place)])
