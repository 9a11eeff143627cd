"""The simulated instrument of the practice mode: what the eye sees at any moment of a session.

Turning points come from the integrated equation of motion with noise and, at choice, one
disturbance; between them the mark moves as a cosine, so that it stands still where it is read. An
automatic gyro delivers one azimuth a round. Times are handed in: nothing here knows a clock.
"""

from __future__ import annotations

import bisect
import math
from dataclasses import dataclass
from typing import Final, Protocol

import numpy as np

from surveyapp.core.observing.steps import Step
from surveyapp.core.simulate.session import UNSPUN_AMPLITUDE_DIV, UNSPUN_RATIO
from surveyapp.core.simulate.specification import SessionSpec
from surveyapp.core.simulate.turning_points import (
    tape_zero_div,
    timetable,
)
from surveyapp.domain.readings import Face, ReadingKind
from surveyapp_models.angles import wrap_pi, wrap_two_pi

LEAD_S: Final = 45.0
"""From lowering the gyro to the first turning point [s]."""
ZERO_BEFORE_S: Final = -300.0
"""When the tape zero before is read, from the first turning point [s]."""
ROUND_S: Final = 180.0
"""One round of an automatic gyro [s]."""


@dataclass(frozen=True, slots=True)
class View:
    """What the eye sees.

    Parameters
    ----------
    circle : float or None
        Circle reading, or the azimuth on the display [rad].
    scale_div : float or None
        Place of the mark on the scale [div].
    swing : float or None
        Place of the mark between the ends of its swing, -1 left, +1 right; 0 is the zero of the
        scale where it is the scale that is seen.
    """

    circle: float | None = None
    scale_div: float | None = None
    swing: float | None = None


@dataclass(frozen=True, slots=True)
class Sights:
    """The circle at the pointings to the target.

    Parameters
    ----------
    line : float
        Circle reading of the line [rad].
    collimation : float
        [rad], added in face left, subtracted in face right.
    errors : tuple of float
        Of single pointings [rad], used one after the other.
    """

    line: float
    collimation: float
    errors: tuple[float, ...]

    def at(self, face: Face, number: int) -> View:
        """One pointing."""
        sign = 1.0 if face is Face.LEFT else -1.0
        turned = 0.0 if face is Face.LEFT else math.pi
        error = self.errors[number % len(self.errors)]
        return View(circle=wrap_two_pi(self.line + turned + sign * self.collimation + error))


class Instrument(Protocol):
    """What a practice session needs of an instrument."""

    @property
    def effect(self) -> str:
        """Id of what is hidden, empty for a clean run."""
        ...

    @property
    def latitude(self) -> float:
        """Where it stands [rad]."""
        ...

    def at(self, step: Step, elapsed_s: float, what: Looked) -> View:
        """What is seen in a step, some time after it was begun."""
        ...

    def truth(self, points: int) -> float:
        """What the result should be: the truth averaged over the first readings [rad]."""
        ...


@dataclass(frozen=True, slots=True)
class Looked:
    """What the trainee looks at.

    Parameters
    ----------
    kind : ReadingKind
    face : Face or None
    number : int
        The how manieth reading of its kind.
    lowered_s : float or None
        Since the gyro was lowered [s], None before.
    """

    kind: ReadingKind
    face: Face | None = None
    number: int = 1
    lowered_s: float | None = None


@dataclass(frozen=True, slots=True)
class SuspendedInstrument:
    """One set-up of a suspended gyro.

    Parameters
    ----------
    spec : SessionSpec
    readings : tuple of float
        Turning points as read: unwrapped [rad] where the alidade follows, else [div].
    middles, offsets : tuple of float
        About what each of them turns, and how far from it, without errors of reading.
    moments_s : tuple of float
        From lowering the gyro [s].
    sights : Sights
    norths : tuple of float
        Truth: gyro north at each turning point [rad].
    effect : str
        Id of what is hidden, empty for a clean run.
    """

    spec: SessionSpec
    readings: tuple[float, ...]
    middles: tuple[float, ...]
    offsets: tuple[float, ...]
    moments_s: tuple[float, ...]
    sights: Sights
    norths: tuple[float, ...]
    effect: str

    @property
    def latitude(self) -> float:
        """Where it stands [rad]."""
        return self.spec.latitude

    def swing(self, elapsed_s: float) -> View:
        """The swing, some time after the gyro was lowered."""
        moments = self.moments_s
        k = bisect.bisect_right(moments, elapsed_s) - 1
        if k + 1 >= len(moments):
            return self._seen(self.readings[-1], None)
        if k < 0:  # the half swing before the first is the one after it, backwards
            share = (moments[0] - elapsed_s) / (moments[1] - moments[0])
            return self._between(0, 1, min(share, 1.0))
        return self._between(k, k + 1, (elapsed_s - moments[k]) / (moments[k + 1] - moments[k]))

    def _between(self, first: int, second: int, share: float) -> View:
        """Between two turning points: a damped cosine about the midpoint.

        Errors of reading die out towards the passage, which is seen where it happens.
        """
        offsets = self.offsets[first], self.offsets[second]
        ratio = abs(offsets[1] / offsets[0])
        middle = self.middles[first] + (self.middles[second] - self.middles[first]) * share
        cosine = math.cos(math.pi * share)
        nearest = first if share < 0.5 else second
        error = self.readings[nearest] - self.middles[nearest] - self.offsets[nearest]
        reading = middle + offsets[0] * ratio**share * cosine + error * cosine**2
        return self._seen(reading, cosine if offsets[0] > 0.0 else -cosine)

    def _seen(self, reading: float, share: float | None) -> View:
        """The reading on the circle, or on the scale beside the clamped circle."""
        if not self.spec.clamped:
            return View(circle=wrap_two_pi(reading), swing=share)
        largest = max(abs(value) for value in self.readings)
        clamp = self.spec.circle_of_north + self.spec.constant + self.spec.clamp_offset
        swing = None if share is None else reading / largest
        return View(circle=wrap_two_pi(clamp), scale_div=reading, swing=swing)

    def tape_zero(self, elapsed_s: float, *, lowered_s: float | None) -> View:
        """The unspun swing on the scale, some time after it was freed.

        The tape drifts on: behind a short run its zero has not come as far as behind a long one.
        """
        half = timetable(self.spec).unspun_half_swing_s
        decay = UNSPUN_RATIO ** (elapsed_s / half)
        swing = math.cos(math.pi * elapsed_s / half)
        moment = ZERO_BEFORE_S if lowered_s is None else lowered_s - LEAD_S
        rest = float(tape_zero_div(self.spec, np.asarray(moment)))
        return View(scale_div=rest + UNSPUN_AMPLITUDE_DIV * decay * swing, swing=swing)

    def at(self, step: Step, elapsed_s: float, what: Looked) -> View:
        """What is seen in a step, some time after it was begun."""
        if step in (Step.SIGHTS_BEFORE, Step.SIGHTS_AFTER):
            return _sighted(self.sights, step, what)
        if step in (Step.ZERO_BEFORE, Step.ZERO_AFTER):
            lowered = what.lowered_s if step is Step.ZERO_AFTER else None
            return self.tape_zero(elapsed_s, lowered_s=lowered)
        return self.swing(elapsed_s) if step is Step.SWING else View()

    def truth(self, points: int) -> float:
        """Gyro north averaged over the first turning points [rad]."""
        observed = self.norths[: max(points, 1)]
        return math.fsum(observed) / len(observed)


@dataclass(frozen=True, slots=True)
class AutomaticInstrument:
    """One set-up of an automatic gyro.

    Parameters
    ----------
    azimuths : tuple of float
        As delivered, round by round [rad].
    truths : tuple of float
        What the gyro sought in each round, without reading errors [rad].
    sights : Sights
    latitude : float
        [rad].
    effect : str
    """

    azimuths: tuple[float, ...]
    truths: tuple[float, ...]
    sights: Sights
    latitude: float
    effect: str

    def at(self, step: Step, elapsed_s: float, what: Looked) -> View:
        """What is seen in a step: while a round runs the mark tells how far it is."""
        if step in (Step.SIGHTS_BEFORE, Step.SIGHTS_AFTER):
            return _sighted(self.sights, step, what)
        if step is not Step.SWING:
            return View()
        ended = min(int(elapsed_s / ROUND_S), len(self.azimuths))
        running = 2.0 * (elapsed_s / ROUND_S - ended) - 1.0
        swing = running if ended < len(self.azimuths) else None
        if ended == 0:
            return View(swing=swing)
        azimuth = self.azimuths[ended - 1]
        north = what.kind is ReadingKind.NORTH
        return View(
            circle=wrap_two_pi(self.sights.line - azimuth if north else azimuth), swing=swing
        )

    def truth(self, points: int) -> float:
        """Gyro azimuth averaged over the first rounds [rad]."""
        observed = self.truths[: max(points, 1)]
        return math.fsum(observed) / len(observed)


def _sighted(sights: Sights, step: Step, what: Looked) -> View:
    later = 50 if step is Step.SIGHTS_AFTER else 0
    return sights.at(what.face or Face.LEFT, what.number + later)


@dataclass(frozen=True, slots=True)
class PracticeOutcome:
    """Truth against result.

    Parameters
    ----------
    truth : float
        True gyro north, or true gyro azimuth of the line with an automatic gyro [rad].
    error : float
        Result minus truth [rad].
    interval95 : float
        Half-width of the result's 95 % interval [rad].
    inside : bool
        Whether the interval holds the truth.
    effect : str
        What was hidden, empty for nothing.
    """

    truth: float
    error: float
    interval95: float
    inside: bool
    effect: str


def judge(
    instrument: Instrument, *, value: float, interval95: float, points: int
) -> PracticeOutcome:
    """Compare a result with the truth.

    Parameters
    ----------
    instrument : Instrument
    value, interval95 : float
        Of the result [rad].
    points : int
        Turning points or rounds that passed while it was observed, missed ones counted.
    """
    truth = instrument.truth(points)
    error = wrap_pi(value - truth)
    return PracticeOutcome(
        truth=wrap_two_pi(truth),
        error=error,
        interval95=interval95,
        inside=abs(error) <= interval95,
        effect=instrument.effect,
    )
