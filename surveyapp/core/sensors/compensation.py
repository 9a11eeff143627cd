"""A calibration applied to a log: corrected columns with their sigma.

A card says what the sensor does; here it is undone. Nothing is extrapolated: whether the card holds
is asked before. Headings stay MAGNETIC until a declination is added, and it is added to nothing
else.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from surveyapp.core.sensors.compass_attitude import NAMES as MISALIGNMENT
from surveyapp.core.sensors.compass_attitude import turned_back
from surveyapp.domain.sensor_card import SensorCard
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.errors import Problem, SurveyError
from surveyapp_models.arrays import Floats
from surveyapp_models.compass.deviation import COEFFICIENTS, deviation_basis, undeviated
from surveyapp_models.compass.heading import heading_of

Mask = NDArray[np.bool_]
Columns = dict[str, Sequence[float] | Sequence[str] | Floats]

AXES: Final = ("along", "across")
BODY: Final = ("x", "y", "z")
_ARCSEC: Final = math.pi / 648000.0
_DEG_H: Final = math.pi / 180.0 / 3600.0


@dataclass(frozen=True, slots=True)
class Declination:
    """Magnetic declination, east positive [rad]; ``sigma`` None = not stated, to be filled in."""

    value: float
    sigma: float | None


@dataclass(frozen=True, slots=True)
class Compensated:
    """Corrected columns.

    Parameters
    ----------
    columns : dict
        As they are written; ``reference`` is a column of words.
    reference : str or None
        MAGNETIC or ASTRONOMIC of headings, else None.
    heading_sigma_deg : float or None
        Largest of the record.
    """

    columns: Columns
    reference: str | None = None
    heading_sigma_deg: float | None = None


def need(card: SensorCard, names: Sequence[str], where: str) -> dict[str, float]:
    """Parameters of a card that a correction cannot do without.

    Raises
    ------
    SurveyError
        Naming all that are absent.
    """
    absent = [name for name in names if card.get(name) is None and name not in card.constants]
    if absent:
        raise SurveyError(
            Problem(
                "the card lacks what this correction needs",
                where,
                ", ".join(item.name for item in card.parameters),
                ", ".join(absent),
                "was it written for another kind of sensor?",
            )
        )
    found = {}
    for name in names:
        value = card.get(name)
        found[name] = value if value is not None else card.constants[name]
    return found


def compensate_compass(
    log: SensorLog,
    card: SensorCard,
    *,
    declination: Declination | None,
    where: str,
    one_reading: bool = True,
    force_noise: float | None = None,
) -> Compensated:
    """Corrected field, tilt-compensated heading and its sigma.

    Parameters
    ----------
    log : SensorLog
        ``mag_*``, and ``acc_*`` where recorded.
    card : SensorCard
        Of an ellipsoid, or of a swing.
    declination : Declination or None
        Turns MAGNETIC headings into ASTRONOMIC ones.
    where : str
        The card, for messages.
    one_reading : bool
        Whether the sigma is that of each heading; without, of the calibration alone, as a mean
        over many readings takes it.
    force_noise : float, optional
        Noise of the specific force as a share of it [-]; by default what the rows of ``log`` tell.
    """
    points = np.column_stack([log.columns[f"mag_{axis}_uT"] for axis in BODY])
    up = log.vector("acc")
    if card.get("deviation_A") is not None:
        names = [f"deviation_{letter}" for letter in COEFFICIENTS]
        values = np.radians(np.array(list(need(card, names, where).values())))
        heading = undeviated(heading_of(points, up), values)
        sigma = _swing_sigma(card, heading)
        noise = np.full(log.size, math.radians(card.constants.get("reading_sigma_deg", 0.0)))
        field = points
    else:
        field = corrected_field(points, card, where)
        heading = np.where(beyond_tilt(log, card), np.nan, heading_of(field, up))
        sigma = np.full(log.size, math.radians(card.constants.get("heading_sigma_deg", 0.0)))
        if up is None:
            sigma = np.hypot(sigma, _unlevelled(card, field))
        shaken = force_sigma(up) if force_noise is None else force_noise
        noise = _reading_sigma(card, field, up, force_noise=shaken)
    if one_reading:
        sigma = np.hypot(sigma, noise)
    sigma = np.where(np.isnan(heading), np.nan, sigma)
    reference = "MAGNETIC"
    if declination is not None:
        heading = (heading + declination.value) % (2.0 * math.pi)
        sigma = np.hypot(sigma, declination.sigma or 0.0)
        reference = "ASTRONOMIC"
    columns: Columns = {"time_s": log.columns["time_s"]}
    columns |= {f"mag_{axis}_uT": field[:, i] for i, axis in enumerate(BODY)}
    columns["heading_deg"] = np.degrees(heading)
    columns["heading_sigma_deg"] = np.degrees(sigma)
    columns["reference"] = [reference] * log.size
    finite = sigma[np.isfinite(sigma)]
    largest = float(np.degrees(finite.max())) if finite.size else None
    return Compensated(columns, reference, largest)


def beyond_tilt(log: SensorLog, card: SensorCard) -> Mask:
    """Rows tilted by more than the record of a restricted card, where its headings do not hold."""
    largest, up = card.constants.get("largest_tilt_deg"), log.vector("acc")
    if largest is None or up is None:
        return np.zeros(log.size, dtype=bool)
    share = up[:, 2] / np.maximum(np.linalg.norm(up, axis=1), 1e-300)
    return np.asarray(share < math.cos(math.radians(largest)) - 1e-12)


def corrected_field(points: Floats, card: SensorCard, where: str) -> Floats:
    """W (m - b) in the body, with the numbers that the fit used, determined or not [uT]."""
    places = ("xx", "yy", "zz", "xy", "xz", "yz")
    hard = [f"hard_iron_{axis}" for axis in BODY]
    soft = [f"soft_iron_{place}" for place in places]
    used = {}
    for name in (*hard, *soft):
        used[name] = card.constants.get(f"used_{name}", card.get(name))
    absent = [name for name, value in used.items() if value is None]
    if absent:
        need(card, absent, where)
    numbers = {name: float(value) for name, value in used.items() if value is not None}
    xx, yy, zz, xy, xz, yz = (numbers[name] for name in soft)
    matrix = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    field = (points - np.array([numbers[name] for name in hard])) @ matrix
    turn = [card.constants.get(f"used_{name}", 0.0) for name in MISALIGNMENT]
    return turned_back(field, np.radians(turn)) if any(turn) else np.asarray(field)


def _reading_sigma(
    card: SensorCard, field: Floats, up: Floats | None, *, force_noise: float
) -> Floats:
    """Sigma of one heading by the noise of its field and of its specific force [rad].

    A field error across the heading turns it by e / H; a wrong up by d turns it by d Z / H, H and
    Z the parts of the field across and along up.
    """
    unit = np.tile([0.0, 0.0, 1.0], (len(field), 1))
    if up is not None:
        unit = up / np.linalg.norm(up, axis=1)[:, None]
    along = np.sum(field * unit, axis=1)
    size = np.linalg.norm(field - along[:, None] * unit, axis=1)
    reading = card.constants.get("reading_sigma_uT", 0.0)
    error = np.hypot(reading, force_noise * along)
    with np.errstate(divide="ignore"):
        return np.asarray(np.where(size > 0.0, error / size, np.inf))


FEWEST_FORCES: Final = 10
"""Readings from which their size tells the noise of the specific force."""


def force_sigma(up: Floats | None) -> float:
    """Noise of the specific force on one axis as a share of it: the scatter of its size, robust.

    Its size is g in every attitude at rest; what shakes it, shakes its direction as much.
    """
    if up is None or len(up) < FEWEST_FORCES:
        return 0.0
    size = np.linalg.norm(up, axis=1)
    middle = float(np.median(size))
    return 1.4826 * float(np.median(np.abs(size - middle))) / middle


def _swing_sigma(card: SensorCard, heading: Floats) -> Floats:
    """Sigma of each heading from the covariance of A to E [rad]."""
    if card.covariance is None:
        largest = card.constants.get("heading_sigma_deg", 0.0)
        return np.full(heading.size, math.radians(largest))
    basis = deviation_basis(heading)
    variance = np.sum((basis @ card.covariance) * basis, axis=1)
    return np.asarray(np.radians(np.sqrt(np.maximum(variance, 0.0))))


def _unlevelled(card: SensorCard, field: Floats) -> float:
    """Sigma of a heading because no specific force tells the tilt [rad].

    The dip of the readings departs from that of the calibration by the tilt along the meridian;
    the tilt across it, taken for as large, turns the heading by its tangent of the dip.
    """
    dip = card.constants.get("dip_deg")
    if dip is None:
        return 0.0
    found = np.arctan2(-field[:, 2], np.linalg.norm(field[:, :2], axis=1))
    tilt = float(np.sqrt(np.mean((found - math.radians(dip)) ** 2)))
    return abs(math.tan(math.radians(dip))) * tilt


def compensate_tilt(log: SensorLog, card: SensorCard, *, where: str) -> Compensated:
    """True tilts of both axes with their sigma.

    Parameters
    ----------
    log : SensorLog
        ``tilt_along_arcsec``, ``tilt_across_arcsec``, and ``temperature_c`` where recorded.
    card : SensorCard
    where : str
        The card, for messages.
    """
    terms = ("zero", "scale", "cross")
    values = need(card, [f"{t}_{a}" for t in terms for a in AXES], where)
    reading = np.column_stack([log.columns[f"tilt_{a}_arcsec"] for a in AXES])
    slopes = [card.get(f"temperature_{a}") for a in AXES]
    theta, doubt = _warmth(log, card) if None not in slopes else (np.zeros(log.size),) * 2
    drift = np.column_stack([theta * (slope or 0.0) for slope in slopes])
    matrix = np.array(
        [
            [values["scale_along"], values["cross_along"]],
            [values["cross_across"], values["scale_across"]],
        ]
    )
    zero = np.array([values["zero_along"], values["zero_across"]])
    true = np.linalg.solve(matrix, (reading - zero - drift).T).T
    sigma = _tilt_sigma(card, true, theta)
    sigma = np.hypot(sigma, np.column_stack([doubt * (slope or 0.0) for slope in slopes]))
    columns: Columns = {"time_s": log.columns["time_s"]} if log.has("time_s") else {}
    columns |= {f"tilt_{a}_arcsec": true[:, i] for i, a in enumerate(AXES)}
    columns |= {f"sigma_{a}_arcsec": sigma[:, i] for i, a in enumerate(AXES)}
    return Compensated(columns)


def _warmth(log: SensorLog, card: SensorCard) -> tuple[Floats, Floats]:
    """Temperature above that of the zeros, and its sigma [K], shape (n,) each.

    Where it was not recorded it is anywhere between those of the calibration.
    """
    reference = card.constants.get("reference_temperature_c", 20.0)
    low, high = card.temperature_c or (reference, reference)
    temperature = log.columns.get("temperature_c", np.full(log.size, np.nan))
    known = np.isfinite(temperature)
    return (
        np.where(known, temperature, 0.5 * (low + high)) - reference,
        np.where(known, 0.0, (high - low) / math.sqrt(12.0)),
    )


def _tilt_sigma(card: SensorCard, true: Floats, theta: Floats) -> Floats:
    """Sigma of the true tilts from the card, shape (n, 2) [arcsec].

    The design of one axis at the reading, with the covariance of its own four parameters.
    """
    found = np.zeros_like(true)
    names = [item.name for item in card.parameters if item.sigma is not None]
    for index, axis in enumerate(AXES):
        design = np.column_stack([np.ones(len(true)), true[:, index], true[:, 1 - index], theta])
        own = [f"{t}_{axis}" for t in ("zero", "scale", "cross", "temperature")]
        present = [i for i, name in enumerate(own) if name in names]
        if card.covariance is None or not present:
            spread = np.array([card.sigma(own[i]) or 0.0 for i in present])
            found[:, index] = np.sqrt(np.sum((design[:, present] * spread) ** 2, axis=1))
            continue
        places = [names.index(own[i]) for i in present]
        covariance = card.covariance[np.ix_(places, places)]
        part = design[:, present]
        found[:, index] = np.sqrt(np.maximum(np.sum((part @ covariance) * part, axis=1), 0.0))
    reading = card.constants.get("reading_sigma_arcsec", 0.0)
    return np.hypot(found, reading)


def compensate_head(log: SensorLog, card: SensorCard, *, where: str) -> Compensated:
    """Tilt of a sensor calibrated on a dividing head: asin((E - K0) / K1)."""
    values = need(card, ["zero", "sensitivity"], where)
    sine = (log.columns["output"] - values["zero"]) / values["sensitivity"]
    with np.errstate(invalid="ignore"):
        tilt = np.degrees(np.arcsin(np.where(np.abs(sine) <= 1.0, sine, np.nan)))
    columns: Columns = {"time_s": log.columns["time_s"]} if log.has("time_s") else {}
    columns["tilt_deg"] = tilt
    return Compensated(columns)


def compensate_rate(log: SensorLog, card: SensorCard, *, where: str) -> Compensated:
    """Rates of a three-axis gyro: K (I + E) w + D undone.

    Parameters
    ----------
    log : SensorLog
        ``gyr_*``.
    card : SensorCard
        ``scale_factor_*`` [ppm from 1], ``misalignment_*`` [arcsec], ``bias_*`` [deg/h].
    where : str
        The card, for messages.
    """
    pairs = [(i, j) for i in range(3) for j in range(3) if i != j]
    names = [f"scale_factor_{a}" for a in BODY] + [f"bias_{a}" for a in BODY]
    crosses = [f"misalignment_{BODY[i]}{BODY[j]}" for i, j in pairs]
    values = need(card, [*names, *crosses], where)
    gain = np.array([1.0 + 1e-6 * values[f"scale_factor_{a}"] for a in BODY])
    bias = np.array([values[f"bias_{a}"] * _DEG_H for a in BODY])
    mixed = np.eye(3)
    for (i, j), name in zip(pairs, crosses, strict=True):
        mixed[i, j] = values[name] * _ARCSEC
    rates = np.column_stack([log.columns[f"gyr_{a}_rad_s"] for a in BODY])
    true = np.linalg.solve(mixed, ((rates - bias) / gain).T).T
    columns: Columns = {"time_s": log.columns["time_s"]}
    columns |= {f"gyr_{a}_rad_s": true[:, i] for i, a in enumerate(BODY)}
    return Compensated(columns)
