"""Practice: a project to observe in, a clock that may run faster, and an instrument that hides.

The truth stays in memory until the result is shown; it is in no file.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime, timedelta
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from surveyapp import api
from surveyapp.core.observing.steps import STEP_NOTE, Expected, Step
from surveyapp.domain.project import Method
from surveyapp.domain.results import OrientationResult
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.fieldbook import COLUMNS
from surveyapp.io.fieldbook.clock import local_now, steady_seconds
from surveyapp.io.tomltext import atomic_write
from surveyapp.languages import said
from surveyapp.observation.session import SessionDesk

if TYPE_CHECKING:  # the simulator is loaded when somebody practises
    from surveyapp.core.practice.simulated_instrument import Instrument, PracticeOutcome, View

SESSION: Final = "practice"
SLOWEST: Final = 0.1
FASTEST: Final = 200.0
_PROJECT: Final = """\
# A practice session on a simulated instrument. Its north is invented.
format = 1
name = "Practice"
angle_unit = "dms"

[[instrument]]
id = "SIM"
{card}

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
method = "{method}"
wanted_interval_arcsec = {wanted}
book = "observations/{session}.csv"
"""

_SUSPENDED: Final = """\
card = "wild-gak1"
scale_value_arcsec = 600.0
period = { latitude_deg = 47.0, tracking_s = 425.4, clamped_s = 388.3, unspun_s = 146.0 }
sigma = { reversal_arcsec = 6.0, scale_div = 0.05, azimuth_arcsec = 15.0, time_s = 0.3 }"""
_AUTOMATIC: Final = """\
card = "gyromat-2000"
sigma = { azimuth_arcsec = 8.0 }"""
_WANTED: Final = {"tracking": 10.0, "amplitude": 40.0, "transit": 40.0, "automatic": 10.0}
"""95 % interval that a dozen readings reach [arcsec]."""


@dataclass(frozen=True, slots=True)
class PracticeWish:
    """What a trainee chooses.

    Parameters
    ----------
    method : Method
    speed : float
        How many times faster than life.
    disturbed : bool or None
        Whether something is hidden; None lets the lot decide.
    """

    method: Method
    speed: float
    disturbed: bool | None


@dataclass(frozen=True, slots=True)
class Practice:
    """One practice session.

    Parameters
    ----------
    folder : str
    speed : float
        How many times faster than life.
    instrument : Instrument
    now, steady : callable
        The clocks of the practice, as fast as it runs.
    """

    folder: str
    speed: float
    instrument: Instrument
    now: Callable[[], datetime]
    steady: Callable[[], float]

    def view(self, observation: SessionDesk, what: Expected) -> View:
        """What the eye sees in the step that the book stands at."""
        from surveyapp.core.practice.simulated_instrument import Looked

        now = observation.clock.stamp().elapsed_s
        begun = _begun(observation, what.step)
        lowered = _begun(observation, Step.SWING)
        looked = Looked(
            what.kind, what.face, what.number, None if lowered is None else now - lowered
        )
        return self.instrument.at(what.step, now - (begun or 0.0), looked)

    def outcome(self, result: OrientationResult) -> PracticeOutcome | None:
        """Truth against result; None where there is no result with an interval."""
        from surveyapp.core.practice.simulated_instrument import judge

        session = result.sessions[0] if result.sessions else None
        if session is None:
            return None
        main = session.main
        azimuth = main.gyro_azimuth if main is not None else None
        found = azimuth if session.method == "automatic" else session.gyro_north
        if found is None or not math.isfinite(found.interval95):
            return None
        passed = max((point.index for point in session.points), default=0) + 1
        return judge(self.instrument, value=found.value, interval95=found.interval95, points=passed)


def _begun(observation: SessionDesk, step: Step) -> float | None:
    """When a step was begun last [s], None where it was not."""
    note = f"{STEP_NOTE}{step}"
    return next((r.elapsed_s for r in reversed(observation.book.rows) if r.note == note), None)


def begin(
    folder: api.Folder,
    *,
    method: Method = "tracking",
    seed: int | None = None,
    speed: float = 1.0,
    disturbed: bool | None = False,
) -> Practice:
    """Make a practice project and set up the instrument.

    Parameters
    ----------
    folder : path
        A folder that does not exist or is empty.
    method : Method
    seed : int or None
        The same seed, the same instrument; None for a new one.
    speed : float
        How many times faster than life, 0.1 to 200.
    disturbed : bool or None
        Whether something is hidden; None lets the lot decide.

    Raises
    ------
    SurveyError
        If the folder holds anything, or the speed is impossible.
    """
    from surveyapp.core.practice.setup import simulate_instrument

    if not SLOWEST <= speed <= FASTEST:
        raise SurveyError(
            Problem(
                said("this speed is not possible"),
                "speed",
                f"{speed:g}",
                said("{slowest:g} to {fastest:g}", slowest=SLOWEST, fastest=FASTEST),
            )
        )
    if seed is not None and seed < 0:
        raise SurveyError(Problem(said("the seed is negative"), "seed", str(seed), "0 or more"))
    path = Path(folder)
    if path.exists() and (not path.is_dir() or any(path.iterdir())):
        raise SurveyError(Problem(said("practice needs a folder of its own"), str(path)))
    rng = np.random.default_rng(seed)
    instrument = simulate_instrument(rng, method=method, disturbed=disturbed)
    (path / "observations").mkdir(parents=True, exist_ok=True)
    text = _PROJECT.format(
        latitude=math.degrees(instrument.latitude),
        session=SESSION,
        method=method,
        card=_AUTOMATIC if method == "automatic" else _SUSPENDED,
        wanted=_WANTED[method],
    )
    header = ",".join(COLUMNS) + "\n"
    atomic_write(path / "observations" / f"{SESSION}.csv", header.encode("utf-8"))
    atomic_write(path / "project.toml", text.encode("utf-8"))  # last: before, it is no project
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
