"""Instrument cards and instruments: what is known of a gyro before it is set up.

A value that its maker or a source does not state is None: it is absent, never guessed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal

from surveyapp.domain.constant_choice import ConstantChoice
from surveyapp.domain.priors import Priors
from surveyapp_models.angles import RHO_ARCSEC

InstrumentKind = Literal["suspended", "automatic"]


@dataclass(frozen=True, slots=True)
class Periods:
    """Swing periods as measured at one latitude.

    Parameters
    ----------
    latitude : float
        Latitude of the measurement [rad].
    tracking_s, clamped_s, unspun_s : float or None
        T1, T2 and T0 [s], full periods.
    sigma_s : float or None
        Standard deviation of each [s].
    """

    latitude: float
    tracking_s: float | None = None
    clamped_s: float | None = None
    unspun_s: float | None = None
    sigma_s: float | None = None


@dataclass(frozen=True, slots=True)
class ReadingSigmas:
    """A-priori standard deviations; None where the card does not know.

    Parameters
    ----------
    reversal : float or None
        One turning point [rad].
    azimuth : float or None
        One whole determination (one round of an automatic gyro) [rad].
    scale_div : float or None
        One scale reading [div].
    time_s : float or None
        One timed passage [s].
    level : float or None
        Tilt of the standing axis of one set-up, each direction [rad].
    graduation : float or None
        Graduation of the circle: one direction on it [rad].
    twist : float or None
        Turning of tripod or pillar where no second sights tell it [rad].
    refraction : float or None
        Lateral refraction of one sight [rad].
    observer : float or None
        What one observer reads east and west alike wrong [rad].
    temperature : float or None
        Change of the constant with temperature [rad/degree Celsius].
    latitude : float or None
        k of the change k sec(latitude) of the constant [rad].
    """

    reversal: float | None = None
    azimuth: float | None = None
    scale_div: float | None = None
    time_s: float | None = None
    level: float | None = None
    graduation: float | None = None
    twist: float | None = None
    refraction: float | None = None
    observer: float | None = None
    temperature: float | None = None
    latitude: float | None = None


@dataclass(frozen=True, slots=True)
class TapeZeroCard:
    """What the card says of the tape zero.

    Parameters
    ----------
    limit_div : float or None
        Largest tolerable zero [div].
    div_per_tilt : float or None
        Change of the zero with tilt [div/rad].
    correction_per_div : float or None
        What is ADDED to gyro north per division [rad/div] (= -lambda mu) at ``latitude``.
    latitude : float or None
        [rad].
    correction_sigma : float or None
        Standard deviation of ``correction_per_div`` [rad/div].
    """

    limit_div: float | None = None
    div_per_tilt: float | None = None
    correction_per_div: float | None = None
    latitude: float | None = None
    correction_sigma: float | None = None


@dataclass(frozen=True, slots=True)
class ValidRange:
    """Where the instrument may be used.

    Parameters
    ----------
    latitude_max : float or None
        Largest latitude, absolute [rad].
    temperature_c : tuple of float or None
        Lowest and highest temperature [degree Celsius].
    supply : tuple of (unit, low, high)
        Lowest and highest supply of the spin motor by its unit (V, Hz, mA).
    level : float or None
        Largest level reading at which the instrument works, absolute [rad].
    zenith : tuple of float or None
        Smallest and largest zenith angle in face left that its telescope reaches [rad].
    """

    latitude_max: float | None = None
    temperature_c: tuple[float, float] | None = None
    supply: tuple[tuple[str, float, float], ...] = ()
    level: float | None = None
    zenith: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True)
class InstrumentCard:
    """One instrument card.

    Parameters
    ----------
    id, title, kind, source : str
        Identity and where the values come from.
    scale_value : float or None
        mu, one division of the gyro scale [rad/div]; negative where the scale reads the other way.
    periods : Periods or None
    torsion_lambda : float or None
        lambda = D/M at ``periods.latitude`` [-].
    torsion_sigma : float or None
        Standard deviation of a stated lambda [-].
    transit_c, transit_c_sigma : float or None
        C at ``periods.latitude`` and its standard deviation [rad/(div s)].
    sigma : ReadingSigmas
    tape_zero : TapeZeroCard
    valid : ValidRange
    resolution : float or None
        Resolution of the circle reading [rad].
    calibration_due : str or None
        ISO date after which the instrument is to be calibrated again.
    notes : tuple of (str, str)
        Further facts of the card by key, for the generated page.
    """

    id: str
    title: str
    kind: InstrumentKind
    source: str
    scale_value: float | None = None
    periods: Periods | None = None
    torsion_lambda: float | None = None
    torsion_sigma: float | None = None
    transit_c: float | None = None
    transit_c_sigma: float | None = None
    sigma: ReadingSigmas = field(default_factory=ReadingSigmas)
    tape_zero: TapeZeroCard = field(default_factory=TapeZeroCard)
    valid: ValidRange = field(default_factory=ValidRange)
    resolution: float | None = None
    calibration_due: str | None = None
    notes: tuple[tuple[str, str], ...] = ()

    def known(self) -> dict[str, float | None]:
        """Every quantity of the card in the units of its file, None where it is absent."""
        periods, zero, valid = self.periods, self.tape_zero, self.valid

        def seconds(value: float | None) -> float | None:
            return None if value is None else value * RHO_ARCSEC

        def degrees(value: float | None) -> float | None:
            return None if value is None else math.degrees(value)

        cold, hot = valid.temperature_c or (None, None)
        return {
            "scale_value_arcsec": seconds(self.scale_value),
            "period.latitude_deg": degrees(periods.latitude) if periods else None,
            "period.tracking_s": periods.tracking_s if periods else None,
            "period.clamped_s": periods.clamped_s if periods else None,
            "period.unspun_s": periods.unspun_s if periods else None,
            "period.sigma_s": periods.sigma_s if periods else None,
            "torsion.lambda": self.torsion_lambda,
            "transit.c_arcsec_per_div_s": seconds(self.transit_c),
            "sigma.reversal_arcsec": seconds(self.sigma.reversal),
            "sigma.azimuth_arcsec": seconds(self.sigma.azimuth),
            "sigma.scale_div": self.sigma.scale_div,
            "sigma.time_s": self.sigma.time_s,
            "tape_zero.limit_div": zero.limit_div,
            "tape_zero.div_per_arcsec_tilt": None
            if zero.div_per_tilt is None
            else zero.div_per_tilt / RHO_ARCSEC,
            "tape_zero.correction_arcsec_per_div": seconds(zero.correction_per_div),
            "tape_zero.latitude_deg": degrees(zero.latitude),
            "range.latitude_max_deg": degrees(valid.latitude_max),
            "range.temperature_min_c": cold,
            "range.temperature_max_c": hot,
        }

    def to_dict(self) -> dict[str, object]:
        """Keys of the JSON."""
        return {"id": self.id, "title": self.title, "kind": self.kind, "known": self.known()}


@dataclass(frozen=True, slots=True)
class AdoptedEffect:
    """An effect that a diagnosis found and a person adopted.

    Parameters
    ----------
    id : str
        Id in the catalogue of its subject.
    coefficients : tuple of (name, value, sigma, unit)
    grid : tuple of (name, value)
        Non-linear parameters; a line or block by its name.
    covariance : tuple of tuple of float
        Covariance of the coefficients, in their units, shape (p, p).
    valid : tuple of (column, low, high)
        Range of the data that chose it.
    reference : tuple of (column, value)
        State at which it corrects nothing and to which every azimuth is reduced.
    time : str
        What a column of time counts: days | order; empty where none is used, or nobody wrote it.
    sessions : tuple of str
        Those whose data chose it; empty where nobody wrote it.
    data_sha256 : str
        Of the data of these sessions.
    before, after, confirm : float or None
        rms before and after on the data that chose it, and on the data that did not.
    adopted_at : str
        ISO 8601.
    software : str
    unit : str
        Unit of before, after and confirm.
    course : tuple of tuple of float
        Of a course of north that recurs and is not explained: rows of half swings, the shift
        of north there (1 at its largest) and its errors; empty = an effect of the catalogue.
    run : str
        The run that the course was saved from.
    """

    id: str
    coefficients: tuple[tuple[str, float, float, str], ...] = ()
    grid: tuple[tuple[str, float | str], ...] = ()
    covariance: tuple[tuple[float, ...], ...] = ()
    valid: tuple[tuple[str, float, float], ...] = ()
    reference: tuple[tuple[str, float], ...] = ()
    time: Literal["days", "order", ""] = ""
    sessions: tuple[str, ...] = ()
    data_sha256: str = ""
    before: float | None = None
    after: float | None = None
    confirm: float | None = None
    adopted_at: str = ""
    software: str = ""
    unit: str = "arcsec"
    course: tuple[tuple[float, ...], ...] = ()
    run: str = ""


@dataclass(frozen=True, slots=True)
class Instrument:
    """An instrument of a project: a card with what the project overrides, and its history.

    Parameters
    ----------
    id : str
    card : InstrumentCard
        Overrides of the project already in it.
    serial : str
    known_constant : tuple of (float, float) or None
        Instrument constant known beforehand and its sigma [rad].
    constant_choice : ConstantChoice or None
        None = nobody chose: predicted where there are determinations enough, else pooled.
    effects : tuple of AdoptedEffect
    priors : Priors or None
        How often each cause is at work in this instrument, learned from its archive.
    """

    id: str
    card: InstrumentCard
    serial: str = ""
    known_constant: tuple[float, float] | None = None
    constant_choice: ConstantChoice | None = None
    effects: tuple[AdoptedEffect, ...] = ()
    priors: Priors | None = None
