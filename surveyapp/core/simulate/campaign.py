"""A campaign: one instrument's constant determined again and again over months.

Each determination is what an automatic gyro delivers on a known line: circle readings of north,
sights before and after, a temperature, a date. Effects act on what physically carries them: the
circle's eccentricity on both circle readings, a line's offset on its known azimuth, everything
else on the rest position of the gyro.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Final

import numpy as np
from numpy.typing import NDArray

from surveyapp.core.simulate.specification import Effect, EffectKind
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp_models.angles import ARCSEC, TWO_PI
from surveyapp_models.arrays import Floats

IntArray = NDArray[np.int64]

CAMPAIGN_EFFECTS: Final = (
    EffectKind("temperature", "arcsec/K", ARCSEC, "change of the constant per kelvin"),
    EffectKind(
        "latitude", "arcsec", ARCSEC, "deflection by a constant torque at the equator: k sec(phi)"
    ),
    EffectKind("time_drift", "arcsec/d", ARCSEC, "change of the constant per day"),
    EffectKind("transport_step", "arcsec", ARCSEC, "jump of the constant", (("at", None),)),
    EffectKind(
        "circle_eccentricity",
        "arcsec",
        ARCSEC,
        "amplitude of the first harmonic on each circle reading; phase in degrees",
        (("phase", None),),
    ),
    EffectKind(
        "line_offset", "arcsec", ARCSEC, "one line's known azimuth too large", (("line", None),)
    ),
    EffectKind(
        "gyro_block", "arcsec", ARCSEC, "one day's determinations stand off", (("block", None),)
    ),
    EffectKind(
        "warm_up", "arcsec", ARCSEC, "constant at spin-up minus settled", (("tau_s", 900.0),)
    ),
    EffectKind(
        "autoregressive",
        "arcsec",
        ARCSEC,
        "sigma of a red noise of the constant; rho from one determination to the next",
        (("rho", 0.5),),
    ),
    EffectKind(
        "random_walk", "arcsec", ARCSEC, "sigma of the constant's walk from one to the next"
    ),
    EffectKind("gross_error", "arcsec", ARCSEC, "one determination wrong", (("count", 1.0),)),
)
"""Effects of a campaign."""

RESOLUTION: Final = 0.1 * ARCSEC
"""Of the circle readings [rad]."""


@dataclass(frozen=True, slots=True)
class CampaignSpec:
    """A campaign to simulate.

    Parameters
    ----------
    determinations : int
        On known lines.
    surveys : int
        Later determinations of a line whose azimuth is not given, after the campaign.
    days : float
        Length of the campaign [d].
    per_day : int
        Largest number of determinations of one day (one spin-up, one line); at least 2 each.
    latitudes : tuple of float
        One known line at each [rad].
    constant : float
        At the reference temperature, without effects [rad].
    sigma_round : float
        One round of the gyro [rad]; a determination has one to three.
    sigma_sight : float
        One pointing [rad].
    temperature_c : float
        Yearly mean [degree Celsius].
    temperature_season_c, temperature_daily_c : float
        Amplitude of the season and standard deviation from day to day [K].
    reference_temperature_c : float
        [degree Celsius].
    effects : tuple of Effect
    start : datetime
    """

    determinations: int = 40
    surveys: int = 4
    days: float = 240.0
    per_day: int = 4
    latitudes: tuple[float, ...] = (math.radians(40.0), math.radians(47.0), math.radians(55.0))
    constant: float = 40.0 * ARCSEC
    sigma_round: float = 4.0 * ARCSEC
    sigma_sight: float = 1.0 * ARCSEC
    temperature_c: float = 12.0
    temperature_season_c: float = 10.0
    temperature_daily_c: float = 3.0
    reference_temperature_c: float = 12.0
    effects: tuple[Effect, ...] = ()
    start: datetime = datetime(2025, 9, 1, 7, 0, tzinfo=UTC)

    def __post_init__(self) -> None:
        problems = []
        if self.determinations < 2:
            found = str(self.determinations)
            problems.append(Problem("too few determinations", "determinations", found, "2 or more"))
        if self.per_day < 2:
            problems.append(Problem("too few per day", "per_day", str(self.per_day), "2 or more"))
        if not self.latitudes:
            problems.append(Problem("no line", "latitudes", "none", "at least one latitude"))
        known = {kind.id for kind in CAMPAIGN_EFFECTS}
        problems += [
            Problem("unknown effect", "effects", effect.id, hint=nearest_names(effect.id, known))
            for effect in self.effects
            if effect.id not in known
        ]
        if problems:
            raise SurveyError(problems)


@dataclass(frozen=True, slots=True)
class SimulatedCampaign:
    """A campaign as observed, with its truth; n determinations, the surveys last.

    Parameters
    ----------
    spec : CampaignSpec
    elapsed_days : ndarray, shape (n,)
        Since the first determination [d].
    temperature_c : ndarray, shape (n,)
    latitude : ndarray, shape (n,)
        [rad].
    line, block : ndarray of int, shape (n,)
        Index of the line (the surveyed line is the last) and of the day.
    running_s : ndarray, shape (n,)
        Since the spin-up of that day [s].
    azimuth : ndarray, shape (n,)
        True astronomic azimuth of the line [rad].
    azimuth_known : ndarray, shape (n,)
        As the project states it: wrong where a line offset acts [rad].
    rounds : ndarray of int, shape (n,)
        Rounds of the gyro.
    line_reading : ndarray, shape (n, 2, 2)
        Circle readings of the target, before and after, face left and right [rad].
    north_reading : ndarray, shape (n, 3)
        Circle readings of gyro north by rounds [rad]; those beyond ``rounds`` are not read.
    constant : ndarray, shape (n,)
        Azimuth known minus gyro azimuth as observed [rad].
    sigma : ndarray, shape (n,)
        Its standard deviation, sights included [rad].
    true_constant : ndarray, shape (n,)
        Of the instrument alone: without noise, circle error and line offset [rad].
    drawn : dict
        What was drawn for the effects.
    """

    spec: CampaignSpec
    elapsed_days: Floats
    temperature_c: Floats
    latitude: Floats
    line: IntArray
    block: IntArray
    running_s: Floats
    azimuth: Floats
    azimuth_known: Floats
    rounds: IntArray
    line_reading: Floats
    north_reading: Floats
    constant: Floats
    sigma: Floats
    true_constant: Floats
    drawn: dict[str, float]


@dataclass(frozen=True, slots=True)
class _Layout:
    """When and where: one entry per determination."""

    days: Floats
    temperature: Floats
    line: IntArray
    block: IntArray
    running: Floats
    latitude: Floats
    azimuth: Floats
    observed: int


def _plan(spec: CampaignSpec, rng: np.random.Generator) -> tuple[IntArray, IntArray]:
    """Block and line of each determination: two to ``per_day`` a day, one line a day."""
    block: list[int] = []
    line: list[int] = []
    day = 0
    while len(block) < spec.determinations:
        count = min(int(rng.integers(2, spec.per_day + 1)), spec.determinations - len(block))
        block += [day] * count
        line += [int(rng.integers(len(spec.latitudes)))] * count
        day += 1
    block += [day + survey // 2 for survey in range(spec.surveys)]
    line += [len(spec.latitudes)] * spec.surveys
    return np.array(block, dtype=np.int64), np.array(line, dtype=np.int64)


def _layout(spec: CampaignSpec, rng: np.random.Generator) -> _Layout:
    """Days of work in season and weather, each with one spin-up."""
    block, line = _plan(spec, rng)
    days = int(block[-1]) + 1
    worked = int(block[spec.determinations - 1]) + 1
    later = spec.days * (1.0 + 0.5 / worked) + 7.0 * np.arange(days - worked)
    dates = np.round(np.concatenate([np.sort(rng.uniform(0.0, spec.days, worked)), later]))
    dates += np.arange(days)  # no two spin-ups on one day
    first = np.searchsorted(block, block)
    place = np.arange(block.size) - first
    running = 300.0 + 1500.0 * place + rng.uniform(0.0, 600.0, block.size)
    season = spec.temperature_season_c * np.cos(TWO_PI * dates / 365.25)
    daily = spec.temperature_c + season + spec.temperature_daily_c * rng.normal(size=days)
    temperature = daily[block] + 0.5 * rng.normal(size=block.size)
    places = (*spec.latitudes, spec.latitudes[0])
    azimuths = rng.uniform(0.0, TWO_PI, len(places))
    moments = dates[block] + running / 86400.0
    return _Layout(
        days=moments - moments[0],
        temperature=np.round(temperature, 1),
        line=line,
        block=block,
        running=running,
        latitude=np.array(places)[line],
        azimuth=azimuths[line],
        observed=spec.determinations,
    )


@dataclass(frozen=True, slots=True)
class _Acting:
    """What the effects add, and where."""

    constant: Floats
    line_offset: Floats
    gross: Floats
    sine: float
    cosine: float
    drawn: dict[str, float]

    def read(self, true_reading: Floats) -> Floats:
        """A reading of the eccentric circle [rad]."""
        error = self.sine * np.sin(true_reading) + self.cosine * np.cos(true_reading)
        return np.asarray(true_reading + error)


def _act(spec: CampaignSpec, layout: _Layout, rng: np.random.Generator) -> _Acting:
    """Realise the effects of a campaign."""
    count = layout.days.size
    drawn: dict[str, float] = {}
    constant, offset, gross = np.full(count, spec.constant), np.zeros(count), np.zeros(count)
    sine = cosine = 0.0
    for effect in spec.effects:
        if effect.id == "circle_eccentricity":
            phase = math.radians(_drawn(effect, "phase", drawn, rng.uniform(0.0, 360.0)))
            sine += effect.size * math.cos(phase)
            cosine += effect.size * math.sin(phase)
        elif effect.id == "line_offset":
            number = _drawn(effect, "line", drawn, float(rng.integers(len(spec.latitudes))))
            offset += effect.size * (layout.line == int(number))
        elif effect.id == "gross_error":
            chosen = rng.permutation(layout.observed)[: int(effect.option("count") or 1)]
            gross[chosen] += effect.size * rng.choice([-1.0, 1.0], size=len(chosen))
        else:
            constant += _instrument_shift(effect, spec, layout, (rng, drawn))
    return _Acting(constant, offset, gross, sine, cosine, drawn)


def simulate_campaign(spec: CampaignSpec, rng: np.random.Generator) -> SimulatedCampaign:
    """Simulate a campaign.

    Parameters
    ----------
    spec : CampaignSpec
    rng : numpy.random.Generator

    Returns
    -------
    SimulatedCampaign
    """
    layout = _layout(spec, rng)
    acting = _act(spec, layout, rng)
    count = layout.days.size
    circle = rng.uniform(0.0, TWO_PI, count)  # circle reading of true north
    rounds = rng.integers(1, 4, count)
    faces = np.array([0.0, math.pi])
    sights = acting.read(circle + layout.azimuth)[:, None, None] + faces
    sights = _rounded(sights + spec.sigma_sight * rng.normal(size=(count, 2, 2)))
    north = (acting.read(circle + acting.constant) + acting.gross)[:, None]
    north = _rounded(north + spec.sigma_round * rng.normal(size=(count, 3)))
    mean_north = np.sum(north * (np.arange(3) < rounds[:, None]), axis=1) / rounds
    mean_line = np.mean(sights - faces, axis=(1, 2))
    known = layout.azimuth + acting.line_offset
    return SimulatedCampaign(
        spec=spec,
        elapsed_days=layout.days,
        temperature_c=layout.temperature,
        latitude=layout.latitude,
        line=layout.line,
        block=layout.block,
        running_s=layout.running,
        azimuth=layout.azimuth,
        azimuth_known=known,
        rounds=np.asarray(rounds, dtype=np.int64),
        line_reading=sights,
        north_reading=north,
        constant=known - (mean_line - mean_north),
        sigma=np.sqrt(spec.sigma_round**2 / rounds + spec.sigma_sight**2 / 4.0),
        true_constant=acting.constant,
        drawn=acting.drawn,
    )


def _rounded(reading: Floats) -> Floats:
    return np.asarray(np.round(reading / RESOLUTION) * RESOLUTION)


def _drawn(effect: Effect, name: str, drawn: dict[str, float], value: float) -> float:
    """The option as given, else as drawn; kept for the truth."""
    given = effect.option(name)
    result = float(value) if given is None else given
    drawn[f"{effect.id}.{name}"] = result
    return result


def _instrument_shift(
    effect: Effect,
    spec: CampaignSpec,
    layout: _Layout,
    draw: tuple[np.random.Generator, dict[str, float]],
) -> Floats:
    """What an effect adds to the instrument's own constant, (n,) [rad]."""
    rng, drawn = draw
    size, count = effect.size, layout.days.size
    if effect.id == "temperature":
        return np.asarray(size * (layout.temperature - spec.reference_temperature_c))
    if effect.id == "latitude":
        return np.asarray(size / np.cos(layout.latitude))
    if effect.id == "time_drift":
        return size * layout.days
    if effect.id == "transport_step":
        share = _drawn(effect, "at", drawn, rng.uniform(0.25, 0.75))
        first = layout.block[int(share * layout.observed)]
        return np.asarray(size * (layout.block >= first), dtype=np.float64)
    if effect.id == "gyro_block":
        numbers, counts = np.unique(layout.block[: layout.observed], return_counts=True)
        inner = numbers[1:-1][counts[1:-1] >= 2]
        if inner.size == 0:
            raise SurveyError(Problem("the campaign is too short for a block", "gyro_block"))
        chosen = _drawn(effect, "block", drawn, float(rng.choice(inner)))
        return np.asarray(size * (layout.block == int(chosen)), dtype=np.float64)
    if effect.id == "warm_up":
        tau = _drawn(effect, "tau_s", drawn, 900.0)
        return np.asarray(size * np.exp(-layout.running / tau))
    noise = rng.normal(size=count)
    if effect.id == "random_walk":
        return size * np.cumsum(noise)
    rho = _drawn(effect, "rho", drawn, 0.5)
    path = np.empty(count)
    path[0] = noise[0]
    for index in range(1, count):
        path[index] = rho * path[index - 1] + math.sqrt(1.0 - rho**2) * noise[index]
    return size * path
