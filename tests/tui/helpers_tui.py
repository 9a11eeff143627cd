"""A project to observe in, a clock that a test turns, and typing with the pilot."""

from __future__ import annotations

import csv
from collections.abc import Iterable
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
from textual.pilot import Pilot

from surveyapp.core.simulate.session import SimulatedSession, simulate_session
from surveyapp.core.simulate.specification import SessionSpec
from surveyapp.tui.screens.session import SessionScreen

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

NETWORK = """\
format = 1
name = "T"
angle_unit = "dms"

[[station]]
name = "A"
e = 1000.0
n = 2000.0
fixed = true

[[station]]
name = "B"
e = 1000.0
n = 2100.0
fixed = true

[[station]]
name = "C"

[[station]]
name = "D"

[[traverse]]
name = "main"
book = "observations/main.csv"
sigma_angle_arcsec = 7.0
sigma_distance = { mm = 2.0, ppm = 2.0 }
"""
NETWORK_BOOK = """\
kind,at,from,to,value,unit,sigma,sigma_unit,set,hi,ht,note
angle,B,A,C,270-00-00,dms,,,,,,
distance,B,,C,50.000,m,,,,,,
angle,C,B,D,120-00-00,dms,,,,,,
distance,C,,D,80.000,m,,,,,,
distance,D,,C,80.003,m,,,,,,
distance,D,,A,84.3,m,,,,,,
"""
CALIBRATION = """
[[orientation]]
id = "k{number}"
station = "3083"
target = "{target}"
instrument = "G1"
method = "automatic"
purpose = "calibration"
azimuth_known = "{known}-00-00"
book = "observations/k{number}.csv"
"""
CALIBRATION_DAYS = ((2, 12.0), (3, 4.0), (5, 9.0), (9, 1.0), (12, 6.0), (16, -8.0), (20, -16.0))
"""Day of March and gyro azimuth beyond 45 or 75 degrees [arcsec]."""


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


def make_network(folder: Path) -> Path:
    """A project with one small traverse."""
    (folder / "observations").mkdir(parents=True)
    (folder / "project.toml").write_text(NETWORK, encoding="utf-8")
    (folder / "observations" / "main.csv").write_text(NETWORK_BOOK, encoding="utf-8")
    return folder


def make_calibrations(folder: Path) -> Path:
    """A project whose instrument was calibrated on two lines through three weeks."""
    (folder / "observations").mkdir(parents=True)
    text = PROJECT.replace('angle_unit = "dms"', 'angle_unit = "dms"\ncrs = "EPSG:25832"')
    for number, (day, beyond) in enumerate(CALIBRATION_DAYS):
        known = 45 + 30 * (number % 2)
        target = ("3082", "3090")[number % 2]
        text += CALIBRATION.format(number=number, target=target, known=known)
        rows = []
        for seq, wobble in enumerate((-6.0, 2.0, 4.0), start=1):
            seconds = 3600.0 * known + beyond + wobble + 60.0
            minutes, rest = divmod(seconds - 3600.0 * known, 60.0)
            rows.append(
                f"{seq},2026-03-{day:02d}T08:{10 * seq:02d}:00+00:00,{600 * seq},azimuth,"
                f"{known}-{int(minutes):02d}-{rest:04.1f},dms,,,,,"
            )
        book = HEADER + "\n".join(rows) + "\n"
        (folder / "observations" / f"k{number}.csv").write_text(book, encoding="utf-8")
    (folder / "project.toml").write_text(text, encoding="utf-8")
    return folder


async def settle(pilot: Pilot[int]) -> None:
    """Wait until no worker is at work and the screen shows what they found."""
    for _ in range(6):
        await pilot.app.workers.wait_for_complete()
        await pilot.pause()
        if not any(not worker.is_finished for worker in pilot.app.workers):
            return


async def open_session(pilot: Pilot[int]) -> SessionScreen:
    """Open the session under the cursor, unless its screen is shown already."""
    await settle(pilot)
    if not isinstance(pilot.app.screen, SessionScreen):
        await pilot.press("enter")
        await settle(pilot)
    screen = pilot.app.screen
    assert isinstance(screen, SessionScreen)
    return screen
