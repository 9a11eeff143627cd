"""Practice: a project to observe in, a clock that may run faster, and an instrument that hides.

The truth stays in memory until the result is shown; it is in no file.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime, timedelta
from pathlib import Path
from typing import Final

import numpy as np

from surveyapp import api
from surveyapp.api_entry import Expected
from surveyapp.api_session import Observation
from surveyapp.core.practice import (
    PracticeInstrument,
    PracticeOutcome,
    View,
    judge,
    simulate_instrument,
)
from surveyapp.core.steps import STEP_NOTE
from surveyapp.domain.results import OrientationResult
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.clock import local_now, steady_seconds
from surveyapp.io.fieldbook import COLUMNS
from surveyapp.io.tomltext import atomic_write

SESSION: Final = "practice"
SLOWEST: Final = 0.1
FASTEST: Final = 200.0
USUAL_SPEED: Final = 10.0
"""A half swing in 20 s: fast enough not to bore, slow enough to read and type."""
_PROJECT: Final = """\
# A practice session on a simulated instrument. Its north is invented.
format = 1
name = "Practice"
angle_unit = "dms"

[[instrument]]
id = "SIM"
card = "wild-gak1"
scale_value_arcsec = 600.0
period = {{ latitude_deg = 47.0, tracking_s = 425.4, clamped_s = 388.3, unspun_s = 146.0 }}
sigma = {{ reversal_arcsec = 6.0, scale_div = 0.05, azimuth_arcsec = 15.0 }}

[[station]]
name = "P"
lat = {latitude:.6f}
lon = 8.0

[[station]]
name = "T"

[[orientation]]
id = "{session}"
station = "P"
target = "T"
instrument = "SIM"
method = "tracking"
wanted_interval_arcsec = 10.0
book = "observations/{session}.csv"
"""


@dataclass(frozen=True, slots=True)
class Practice:
    """One practice session.

    Parameters
    ----------
    folder : str
    speed : float
        How many times faster than life.
    instrument : PracticeInstrument
    now, steady : callable
        The clocks of the practice, as fast as it runs.
    """

    folder: str
    speed: float
    instrument: PracticeInstrument
    now: Callable[[], datetime]
    steady: Callable[[], float]

    def view(self, observation: Observation, what: Expected) -> View:
        """What the eye sees in the step that the book stands at."""
        rows = observation.book.rows
        note = f"{STEP_NOTE}{what.step}"
        begun = next((r.elapsed_s for r in reversed(rows) if r.note == note), None)
        elapsed = observation.clock.stamp().elapsed_s - (begun or 0.0)
        return self.instrument.at(what.step, elapsed, face=what.face, number=what.number)

    def outcome(self, result: OrientationResult) -> PracticeOutcome | None:
        """Truth against result; None where there is no gyro north with an interval."""
        session = result.sessions[0] if result.sessions else None
        north = session.gyro_north if session is not None else None
        if session is None or north is None or not math.isfinite(north.interval95):
            return None
        passed = max((point.index for point in session.points), default=0) + 1
        return judge(self.instrument, north=north.value, interval95=north.interval95, points=passed)


def begin(
    folder: api.Folder,
    *,
    seed: int | None = None,
    speed: float = 1.0,
    disturbed: bool = False,
) -> Practice:
    """Make a practice project and set up the instrument.

    Parameters
    ----------
    folder : path
        A folder that does not exist or is empty.
    seed : int or None
        The same seed, the same instrument; None for a new one.
    speed : float
        How many times faster than life, 0.1 to 200.
    disturbed : bool
        Whether something is hidden.

    Raises
    ------
    SurveyError
        If the folder holds anything, or the speed is impossible.
    """
    if not SLOWEST <= speed <= FASTEST:
        raise SurveyError(
            Problem(
                "this speed is not possible", "--speed", f"{speed:g}", f"{SLOWEST:g} to {FASTEST:g}"
            )
        )
    path = Path(folder)
    if path.exists() and (not path.is_dir() or any(path.iterdir())):
        raise SurveyError(Problem("practice needs a folder of its own", str(path)))
    instrument = simulate_instrument(np.random.default_rng(seed), disturbed=disturbed)
    (path / "observations").mkdir(parents=True, exist_ok=True)
    latitude = math.degrees(instrument.spec.latitude)
    text = _PROJECT.format(latitude=latitude, session=SESSION)
    atomic_write(path / "project.toml", text.encode("utf-8"))
    header = ",".join(COLUMNS) + "\n"
    atomic_write(path / "observations" / f"{SESSION}.csv", header.encode("utf-8"))
    start, begun = local_now(), steady_seconds()

    def passed() -> float:
        return speed * (steady_seconds() - begun)

    return Practice(
        folder=str(path),
        speed=speed,
        instrument=instrument,
        now=lambda: start + timedelta(seconds=passed()),
        steady=passed,
    )


def practice_folder() -> str:
    """A new folder for a practice session among the user's documents."""
    from surveyapp.io.locations import user_documents_folder

    base = user_documents_folder()
    number = 1
    while (base / f"practice-{number}").exists():
        number += 1
    return str(base / f"practice-{number}")
