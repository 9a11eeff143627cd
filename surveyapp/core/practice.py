"""A simulated instrument that swings while a trainee reads it; what it hides is told afterwards.

The turning points come from the integrated equation of motion with noise and, at choice, one
disturbance; between them the mark moves as a cosine, so that it stands still where it is read.
Times are handed in: nothing here knows a clock.
"""

from __future__ import annotations

import bisect
import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from surveyapp.core.simulate.session import UNSPUN_AMPLITUDE_DIV, UNSPUN_RATIO
from surveyapp.core.simulate.specification import Effect, SessionSpec, parse_effect
from surveyapp.core.simulate.turning_points import simulate_turning_points, timetable
from surveyapp.core.steps import Step
from surveyapp.domain.readings import Face
from surveyapp_models.angles import wrap_pi, wrap_two_pi

POINTS: Final = 24
LEAD_S: Final = 45.0
"""From lowering the gyro to the first turning point [s]."""
DISTURBANCES: Final = (
    "midpoint_step=90,at=5",
    "midpoint_step=-120,at=7",
    "damping_break=0.02,at=6",
    "midpoint_drift=6",
    "secondary_oscillation=40,period=10",
    "warm_up=120",
)
"""One of these is hidden, large enough to be found with a dozen turning points."""


@dataclass(frozen=True, slots=True)
class View:
    """What the eye sees.

    Parameters
    ----------
    circle : float or None
        Circle reading [rad].
    scale_div : float or None
        Place of the mark on the scale [div].
    swing : float or None
        Place of the mark between the ends of its swing, -1 left, +1 right.
    """

    circle: float | None = None
    scale_div: float | None = None
    swing: float | None = None


@dataclass(frozen=True, slots=True)
class PracticeInstrument:
    """One simulated set-up.

    Parameters
    ----------
    spec : SessionSpec
    readings : tuple of float
        Turning points as read, unwrapped [rad].
    moments_s : tuple of float
        From lowering the gyro [s].
    sights : tuple of float
        Errors of single pointings [rad], used one after the other.
    norths : tuple of float
        Truth: gyro north at each turning point [rad].
    effect : str
        Id of what is hidden, empty for a clean run.
    """

    spec: SessionSpec
    readings: tuple[float, ...]
    moments_s: tuple[float, ...]
    sights: tuple[float, ...]
    norths: tuple[float, ...]
    effect: str

    def swing(self, elapsed_s: float) -> View:
        """The tracked swing, some time after the gyro was lowered."""
        moments, readings = self.moments_s, self.readings
        k = bisect.bisect_right(moments, elapsed_s) - 1
        if k < 0:
            start, end = readings[1], readings[0]
            begin = 2.0 * moments[0] - moments[1]
            span = moments[1] - moments[0]
        elif k + 1 < len(moments):
            start, end, begin = readings[k], readings[k + 1], moments[k]
            span = moments[k + 1] - moments[k]
        else:
            return View(circle=wrap_two_pi(readings[-1]))
        phase = math.cos(math.pi * min(max((elapsed_s - begin) / span, 0.0), 1.0))
        middle, half = 0.5 * (start + end), 0.5 * (start - end)
        share = phase if half > 0.0 else -phase
        return View(circle=wrap_two_pi(middle + half * phase), swing=share)

    def tape_zero(self, elapsed_s: float, *, after: bool) -> View:
        """The unspun swing on the scale, some time after it was freed."""
        half = timetable(self.spec).unspun_half_swing_s
        decay = UNSPUN_RATIO ** (elapsed_s / half)
        swing = math.cos(math.pi * elapsed_s / half)
        rest = self.spec.tape_zero_div[1 if after else 0]
        return View(scale_div=rest + UNSPUN_AMPLITUDE_DIV * decay * swing, swing=swing)

    def sight(self, face: Face, number: int) -> View:
        """The circle at a pointing to the target."""
        sign = 1.0 if face is Face.LEFT else -1.0
        line = self.spec.circle_of_north + self.spec.line_azimuth
        turned = 0.0 if face is Face.LEFT else math.pi
        error = self.sights[number % len(self.sights)]
        return View(circle=wrap_two_pi(line + turned + sign * self.spec.collimation + error))

    def at(self, step: Step, elapsed_s: float, *, face: Face | None, number: int) -> View:
        """What is seen in a step, some time after it was begun."""
        if step in (Step.SIGHTS_BEFORE, Step.SIGHTS_AFTER):
            return self.sight(face or Face.LEFT, number + (50 if step is Step.SIGHTS_AFTER else 0))
        if step in (Step.ZERO_BEFORE, Step.ZERO_AFTER):
            return self.tape_zero(elapsed_s, after=step is Step.ZERO_AFTER)
        return self.swing(elapsed_s) if step is Step.SWING else View()

    def north(self, points: int) -> float:
        """Truth: gyro north averaged over the first turning points [rad]."""
        observed = self.norths[: max(points, 1)]
        return math.fsum(observed) / len(observed)


@dataclass(frozen=True, slots=True)
class PracticeOutcome:
    """Truth against result.

    Parameters
    ----------
    north : float
        True gyro north [rad].
    error : float
        Result minus truth [rad].
    interval95 : float
        Half-width of the result's 95 % interval [rad].
    inside : bool
        Whether the interval holds the truth.
    effect : str
        What was hidden, empty for nothing.
    """

    north: float
    error: float
    interval95: float
    inside: bool
    effect: str


def judge(
    instrument: PracticeInstrument, *, north: float, interval95: float, points: int
) -> PracticeOutcome:
    """Compare a result with the truth.

    Parameters
    ----------
    instrument : PracticeInstrument
    north, interval95 : float
        Of the result [rad].
    points : int
        Turning points that passed while it was observed, missed ones counted.
    """
    truth = instrument.north(points)
    error = wrap_pi(north - truth)
    return PracticeOutcome(
        north=wrap_two_pi(truth),
        error=error,
        interval95=interval95,
        inside=abs(error) <= interval95,
        effect=instrument.effect,
    )


def simulate_instrument(rng: np.random.Generator, *, disturbed: bool) -> PracticeInstrument:
    """Set up an instrument with a hidden north and, if asked for, one hidden disturbance.

    Parameters
    ----------
    rng : numpy.random.Generator
    disturbed : bool
    """
    effects: tuple[Effect, ...] = ()
    if disturbed:
        effects = (parse_effect(DISTURBANCES[int(rng.integers(len(DISTURBANCES)))]),)
    spec = SessionSpec(
        points=POINTS,
        circle_of_north=float(rng.uniform(0.0, 2.0 * math.pi)),
        line_azimuth=float(rng.uniform(0.0, 2.0 * math.pi)),
        tape_zero_div=tuple(rng.uniform(-0.4, 0.4, size=2).tolist()),
        effects=effects,
    )
    points = simulate_turning_points(spec, 1, rng)
    moments = points.time_s[0] - points.time_s[0, 0] + LEAD_S
    return PracticeInstrument(
        spec=spec,
        readings=tuple(points.readings[0].tolist()),
        moments_s=tuple(moments.tolist()),
        sights=tuple(rng.normal(scale=spec.noise.sight, size=100).tolist()),
        norths=tuple(points.run_north[0].tolist()),
        effect=effects[0].id if effects else "",
    )
