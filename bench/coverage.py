"""Does ``interval95_arcsec`` hold the truth? Every method, five latitudes, both hemispheres.

The route of every run: integrate the two-axis equation of motion, write a project with its field
book, read and orient it through the public interface, compare with the truth of the simulation.
The suite runs a seeded subset with the bounds of the binomial distribution.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

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


def run() -> list[str]:
    """The whole campaign: 2000 runs a method."""
    lines = ["method      quantity      runs  holds truth  bias/sigma  mean sigma"]
    for seed, method in enumerate(METHODS):
        for name, item in zip(
            ("gyro north", "gyro azimuth"), campaign(method, 2000, 20261122 + seed), strict=True
        ):
            lines.append(
                f"{method:<11} {name:<13} {item.errors.size:>4}  {item.share:>10.1%}  "
                f'{item.bias_in_sigma:>+9.3f}  {np.mean(item.sigmas):>8.2f}"'
            )
    return lines
