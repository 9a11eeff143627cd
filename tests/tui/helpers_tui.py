"""A project to observe in, a clock that a test turns, and typing with the pilot."""

from __future__ import annotations

import csv
from collections.abc import Iterable
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np

from surveyapp.core.simulate.session import SimulatedSession, simulate_session
from surveyapp.core.simulate.specification import SessionSpec

SMALL, LARGE = (80, 24), (120, 40)
HEADER = "seq,time,elapsed_s,kind,value,unit,face,side,target,temperature_c,note\n"
PROJECT = """\
format = 1
name = "Ramp 3"
angle_unit = "dms"

[[instrument]]
id = "G1"
card = "wild-gak1"
scale_value_arcsec = 600.0
constant = { arcsec = -9.7, sigma_arcsec = 3.0 }
period = { latitude_deg = 47.0, tracking_s = 425.4, clamped_s = 388.3, unspun_s = 146.0 }
sigma = { reversal_arcsec = 6.0, azimuth_arcsec = 15.0, scale_div = 0.05, time_s = 0.2 }
transit = { c_arcsec_per_div_s = 2.91 }

[[station]]
name = "3083"
lat = 47.0
lon = 8.0

[[station]]
name = "3082"
lat = 47.001
lon = 8.01

[[station]]
name = "3090"
lat = 47.0
lon = 8.02
"""
SESSION = """
[[orientation]]
id = "{id}"
station = "3083"
target = "3082"
instrument = "G1"
method = "{method}"
wanted_interval_arcsec = 8.0
book = "observations/{id}.csv"
"""


class Clock:
    """A wall clock and steady seconds that stand still until they are turned."""

    def __init__(self, begin: datetime = datetime(2026, 3, 2, 8, 0, tzinfo=UTC)) -> None:
        self.wall = begin
        self.seconds = 1000.0

    def now(self) -> datetime:
        return self.wall

    def steady(self) -> float:
        return self.seconds

    def pass_by(self, seconds: float) -> None:
        self.wall += timedelta(seconds=seconds)
        self.seconds += seconds


def make_project(folder: Path, method: str = "tracking", name: str = "r1") -> Path:
    """A project with one empty session."""
    (folder / "observations").mkdir(parents=True)
    text = PROJECT + SESSION.format(id=name, method=method)
    (folder / "project.toml").write_text(text, encoding="utf-8")
    (folder / "observations" / f"{name}.csv").write_text(HEADER, encoding="utf-8")
    return folder


def simulated(points: int = 12, seed: int = 3) -> SimulatedSession:
    """A tracking session from the integrated equation of motion."""
    spec = SessionSpec(points=points, times=True, tape_zero_div=(0.2, 0.25))
    return simulate_session(spec, np.random.default_rng(seed))


def rows_on_disk(folder: Path, name: str = "r1") -> list[dict[str, str]]:
    """Rows of the book as they stand in the file."""
    text = (folder / "observations" / f"{name}.csv").read_text(encoding="utf-8")
    return list(csv.DictReader(text.splitlines()))


def readings(rows: Iterable[dict[str, str]]) -> list[tuple[str, str]]:
    """Kind and value of everything but notes."""
    return [(row["kind"], row["value"]) for row in rows if row["kind"] != "note"]
