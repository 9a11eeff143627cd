"""What is to be simulated: the instrument, the session, the disturbing effects and their sizes.

An effect here is a physical cause with a size; how it acts on the motion stands in ``disturbing``.
Nothing of this module is read by estimation or diagnosis: a truth that the analyst shares with the
simulator would prove nothing.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Final, Literal

from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.languages import said
from surveyapp_models.angles import ARCSEC
from surveyapp_models.gyro.suspended import SuspendedGyro, gyro_from_periods

SwingMethod = Literal["tracking", "amplitude", "transit", "full_fit"]


@dataclass(frozen=True, slots=True)
class EffectKind:
    """A kind of disturbing effect that can be simulated.

    Parameters
    ----------
    id : str
        As in the catalogue of effects where it has a namesake there.
    unit : str
        Unit of the size on the command line.
    to_internal : float
        Factor from that unit to the internal one.
    meaning : str
        What the size is.
    options : tuple of (str, float or None)
        Further parameters with their defaults; None is drawn at random for each run.
    """

    id: str
    unit: str
    to_internal: float
    meaning: str
    options: tuple[tuple[str, float | None], ...] = ()


RUN_EFFECTS: Final = (
    EffectKind(
        "damping_break",
        "1/half swing",
        1.0,
        "loss of the amplitude ratio per half swing, from the break on",
        (("at", None),),
    ),
    EffectKind(
        "quadratic_drag",
        "1/half swing",
        1.0,
        "share of the first amplitude lost in the first half swing, proportional to its square",
    ),
    EffectKind(
        "dry_friction",
        "arcsec/half swing",
        ARCSEC,
        "amplitude lost per half swing at any amplitude",
    ),
    EffectKind("midpoint_drift", "arcsec/half swing", ARCSEC, "shift of north per half swing"),
    EffectKind("midpoint_step", "arcsec", ARCSEC, "sudden shift of north", (("at", None),)),
    EffectKind("warm_up", "arcsec", ARCSEC, "shift at the first point, dying out", (("tau", 5.0),)),
    EffectKind(
        "secondary_oscillation",
        "arcsec",
        ARCSEC,
        "amplitude of a slow oscillation of north; period in half swings",
        (("period", None), ("phase", None)),
    ),
    EffectKind("temperature", "arcsec/K", ARCSEC, "shift of north per kelvin"),
    EffectKind(
        "amplitude_asymmetry",
        "arcsec",
        ARCSEC,
        "shift of the midpoint at the first amplitude, proportional to its square",
    ),
    EffectKind("gross_error", "arcsec", ARCSEC, "one reading wrong", (("count", 1.0),)),
    EffectKind(
        "random_walk", "arcsec/sqrt(half swing)", ARCSEC, "sigma of north's walk per half swing"
    ),
    EffectKind(
        "autoregressive",
        "arcsec",
        ARCSEC,
        "sigma of a red noise of north; rho from one half swing to the next",
        (("rho", 0.7),),
    ),
    EffectKind(
        "one_sided_lag",
        "arcsec/half swing",
        ARCSEC,
        "amplitude lost per half swing by a follow-up that trails eastward only",
    ),
    EffectKind(
        "tracking_jitter",
        "arcsec",
        ARCSEC,
        "sigma of the amplitude that an uneven follow-up takes or gives in a half swing",
    ),
    EffectKind(
        "tripod_twist", "arcsec", ARCSEC, "clockwise turn of the tripod from first to last point"
    ),
)
"""Effects of a reversal run."""


@dataclass(frozen=True, slots=True)
class Effect:
    """A disturbing effect and its size.

    Parameters
    ----------
    id : str
        Of ``RUN_EFFECTS`` or ``campaign.CAMPAIGN_EFFECTS``.
    size : float
        In the internal unit of its kind: radians where the command line has arc-seconds.
    options : tuple of (str, float)
        Those that are not left to their default.
    """

    id: str
    size: float
    options: tuple[tuple[str, float], ...] = ()

    def option(self, name: str) -> float | None:
        """Return the value of an option if it was given."""
        return dict(self.options).get(name)


def parse_effect(text: str, kinds: Iterable[EffectKind] = RUN_EFFECTS) -> Effect:
    """Read ``ID=VALUE`` or ``ID=VALUE,option=value`` as typed on the command line.

    Parameters
    ----------
    text : str
        The value in the unit of the kind; options as plain numbers.
    kinds : iterable of EffectKind
        What the subject knows.

    Returns
    -------
    Effect

    Raises
    ------
    SurveyError
        Unknown id or option, or no number.
    """
    known = {kind.id: kind for kind in kinds}
    identity, _, rest = text.partition("=")
    kind = known.get(identity.strip())
    where = said("effect {text}", text=text)
    if kind is None:
        hint = nearest_names(identity.strip(), known)
        raise SurveyError(Problem("unknown effect", where, identity, "the id of an effect", hint))
    size, *pairs = rest.split(",")
    names = [name for name, _ in kind.options]
    options = []
    for pair in pairs:
        name, _, value = pair.partition("=")
        if name.strip() not in names:
            hint = nearest_names(name.strip(), names)
            raise SurveyError(Problem("unknown option", where, name, "an option", hint))
        options.append((name.strip(), _number(value, where, "a number")))
    expected = said("a number in {unit}, as in {id}=2", unit=kind.unit, id=kind.id)
    return Effect(kind.id, _number(size, where, expected) * kind.to_internal, tuple(options))


def _number(text: str, where: str, expected: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise SurveyError(Problem("not a number", where, text, expected))
    return value


def default_gyro() -> SuspendedGyro:
    """Return an attachment with T1 = 425.4 s, T2 = 388.3 s and T0 = 146 s at 47 degrees."""
    return gyro_from_periods(
        tracking_s=425.4, clamped_s=388.3, unspun_s=146.0, latitude=math.radians(47.0)
    )


@dataclass(frozen=True, slots=True)
class Noise:
    """Standard deviations and resolutions of what is read.

    Parameters
    ----------
    reading, reading_resolution : float
        A turning point on the circle [rad].
    sight : float
        One pointing to the target [rad].
    scale_div, scale_resolution_div : float
        A turning point on the scale [div].
    time_s, time_resolution_s : float
        A timed passage or turning point [s].
    temperature_c, temperature_resolution_c : float
        A temperature [degree Celsius].
    """

    reading: float = 4.0 * ARCSEC
    reading_resolution: float = 0.1 * ARCSEC
    sight: float = 1.5 * ARCSEC
    scale_div: float = 0.02
    scale_resolution_div: float = 0.001
    time_s: float = 0.1
    time_resolution_s: float = 0.01
    temperature_c: float = 0.05
    temperature_resolution_c: float = 0.01


@dataclass(frozen=True, slots=True)
class SessionSpec:
    """One session to simulate.

    Parameters
    ----------
    method : {"tracking", "amplitude", "transit", "full_fit"}
    latitude : float
        [rad].
    points : int
        Turning points (tracking, amplitude) or passages through zero (transit, full fit).
    gyro : SuspendedGyro
        Its damping is replaced by ``ratio``.
    scale_value : float
        mu [rad/div], signed.
    constant : float
        Rest position of the gyro east of the meridian: the instrument constant [rad].
    amplitude : float or None
        At the first turning point [rad]; 2 degrees tracked, 70 minutes clamped if None.
    first_east : bool
        Whether the first turning point is the eastern one.
    ratio : float
        Viscous amplitude ratio per half swing at the tracking period [-].
    clamp_offset : float
        Azimuth of the clamp from the gyro's own north [rad].
    circle_of_north : float
        Circle reading of true north [rad].
    line_azimuth : float
        Astronomic azimuth of the target [rad].
    collimation : float
        c, added in face left, subtracted in face right [rad].
    tape_zero_div : tuple of float
        d at the middle of the tape zeros before and after [div]; linear in time between.
    tape_zero_points : int
        Turning points of each unspun swing; 0 leaves them out.
    lines_div : tuple of float
        Scale lines that are timed [div]; the full fit may use several.
    noise : Noise
    effects : tuple of Effect
    missed : tuple of int
        Turning points (from 0) that are not read.
    temperature_c : float
        Reference temperature, and that of the first point [degree Celsius].
    temperature_span_c : float
        Standard deviation of the temperature over the run [K]; 0 keeps it constant.
    start : datetime
        First row of the book, with offset.
    times : bool
        False leaves time and elapsed_s of a tracking book empty.
    """

    method: SwingMethod = "tracking"
    latitude: float = math.radians(47.0)
    points: int = 12
    gyro: SuspendedGyro = field(default_factory=default_gyro)
    scale_value: float = 600.0 * ARCSEC
    constant: float = 0.0
    amplitude: float | None = None
    first_east: bool = True
    ratio: float = 0.995
    clamp_offset: float = 480.0 * ARCSEC
    circle_of_north: float = math.radians(100.0)
    line_azimuth: float = math.radians(75.0)
    collimation: float = 8.0 * ARCSEC
    tape_zero_div: tuple[float, float] = (0.0, 0.0)
    tape_zero_points: int = 5
    lines_div: tuple[float, ...] = (0.0,)
    noise: Noise = field(default_factory=Noise)
    effects: tuple[Effect, ...] = ()
    missed: tuple[int, ...] = ()
    temperature_c: float = 15.0
    temperature_span_c: float = 0.0
    start: datetime = datetime(2026, 3, 2, 8, 0, tzinfo=UTC)
    times: bool = True

    def __post_init__(self) -> None:
        problems = []
        if self.points < 3:
            problems.append(Problem("too few points", "points", str(self.points), "3 or more"))
        if not 0.0 < self.ratio <= 1.0:
            problems.append(Problem("no amplitude ratio", "ratio", f"{self.ratio}", "0 < q <= 1"))
        if abs(self.latitude) > math.radians(89.0):
            found = said("{value:.3f} degrees", value=math.degrees(self.latitude))
            problems.append(Problem("no north to seek", "latitude", found, "below 89 degrees"))
        if self.start.tzinfo is None:
            problems.append(Problem("time without UTC offset", "start", str(self.start)))
        known = {kind.id for kind in RUN_EFFECTS}
        problems += [
            Problem("unknown effect", "effects", effect.id, hint=nearest_names(effect.id, known))
            for effect in self.effects
            if effect.id not in known
        ]
        if self.clamped and self.first_amplitude * self.ratio**self.turns <= self._farthest_line:
            found = said("{value:.2f} div", value=self.first_amplitude / abs(self.scale_value))
            problems.append(Problem("the swing does not reach every line", "amplitude", found))
        if problems:
            raise SurveyError(problems)

    @property
    def clamped(self) -> bool:
        """Whether the tape top is held."""
        return self.method != "tracking"

    @property
    def timed(self) -> bool:
        """Whether passages are timed."""
        return self.method in ("transit", "full_fit")

    @property
    def turns(self) -> int:
        """Number of turning points in the book, missed ones included."""
        return self.points + 1 if self.timed else self.points

    @property
    def first_amplitude(self) -> float:
        """Amplitude at the first turning point [rad]."""
        if self.amplitude is not None:
            return self.amplitude
        return math.radians(70.0 / 60.0 if self.clamped else 2.0)

    @property
    def _farthest_line(self) -> float:
        """Largest distance of a timed line from the centre of swing [rad]; 0 where none is."""
        if not self.timed:
            return 0.0
        return abs(self.clamp_offset) + max(abs(x * self.scale_value) for x in self.lines_div)
