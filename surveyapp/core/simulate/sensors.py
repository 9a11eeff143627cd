"""Simulated logs of a compass, of a tilt sensor, and of pure sensor noise, with their truth.

Written from the physics and not from the estimators: what a record holds is drawn here, and no
command but this one knows it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from surveyapp.core.simulate.specification import Effect, EffectKind
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp_models.arrays import Floats
from surveyapp_models.compass.heading import level_field

Simulated = tuple[dict[str, str], dict[str, Any]]

COMPASS_EFFECTS: Final = (
    EffectKind("hard_iron", "uT", 1.0, "size of a constant field that turns with the carrier"),
    EffectKind("soft_iron", "%", 0.01, "largest relative change of an axis by induced magnetism"),
    EffectKind("misalignment", "deg", math.pi / 180.0, "sensor axes turned against the body's z"),
    EffectKind(
        "interference_step",
        "uT",
        1.0,
        "field of something that is switched on and off; times in seconds",
        (("on", None), ("off", None)),
    ),
    EffectKind("field_gradient", "uT/m", 1.0, "change of the field with the place"),
    EffectKind("temperature", "uT/K", 1.0, "drift of the x axis per kelvin"),
    EffectKind("gross_error", "uT", 1.0, "single readings that far off", (("count", 8.0),)),
)
TILT_EFFECTS: Final = (
    EffectKind("cross_axis", "%", 0.01, "share of the other axis in each reading"),
    EffectKind("scale_nonlinearity", "arcsec", 1.0, "cubic deviation at the end of the range"),
    EffectKind("temperature", "arcsec/K", 1.0, "change of the zero of the axis along per kelvin"),
    EffectKind("warm_up", "arcsec", 1.0, "zero at the start, dying out", (("tau", 600.0),)),
    EffectKind("gross_error", "arcsec", 1.0, "single readings that far off", (("count", 3.0),)),
)
NOISE_SYMBOLS: Final = ("Q", "N", "B", "K", "R")

FIELD_UT: Final = 50.0
DIP: Final = math.radians(65.0)
MAG_SIGMA_UT: Final = 0.3
ACC_SIGMA_M_S2: Final = 0.02
GRAVITY: Final = 9.81
COMPASS_HZ: Final = 20.0
COMPASS_ROWS: Final = 2400
TILT_ROWS: Final = 168
TILT_RANGE_ARCSEC: Final = 600.0
TILT_SIGMA_ARCSEC: Final = 1.0
NOISE_HZ: Final = 100.0
NOISE_ROWS: Final = 100_000


@dataclass(frozen=True, slots=True)
class _Attitudes:
    """Rotation matrices body to level frame, quaternions (w first), and places."""

    matrices: Floats
    quaternions: Floats
    places: Floats


def _attitudes(time: Floats, rng: np.random.Generator) -> _Attitudes:
    """A carrier turned by hand through every attitude, shape (n, 3, 3)."""
    rates = np.zeros((time.size, 3))
    for axis in range(3):
        for _ in range(3):
            size, period = rng.uniform(0.3, 0.9), rng.uniform(4.0, 25.0)
            rates[:, axis] += size * np.sin(2.0 * np.pi * time / period + rng.uniform(0.0, 6.3))
    step = float(time[1] - time[0])
    q = np.array([1.0, 0.0, 0.0, 0.0])
    quaternions = np.empty((time.size, 4))
    for k, w in enumerate(rates):
        quaternions[k] = q
        half = 0.5 * step * float(np.linalg.norm(w))
        vector = 0.5 * step * w * (math.sin(half) / half if half > 0.0 else 1.0)
        d = np.array([math.cos(half), *vector])
        q = np.array(
            [
                q[0] * d[0] - q[1:] @ d[1:],
                *(q[0] * d[1:] + d[0] * q[1:] + np.cross(q[1:], d[1:])),
            ]
        )
        q /= np.linalg.norm(q)
    places = np.cumsum(rng.normal(0.0, 0.02, (time.size, 3)), axis=0)
    return _Attitudes(_matrices(quaternions), quaternions, places - places.mean(axis=0))


def _matrices(q: Floats) -> Floats:
    w, x, y, z = q.T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def _direction(rng: np.random.Generator) -> Floats:
    vector = rng.normal(size=3)
    return np.asarray(vector / np.linalg.norm(vector))


def simulate_compass(effects: Sequence[Effect], rng: np.random.Generator) -> Simulated:
    """A hand-turned record with reference attitude, place and temperature."""
    time = np.arange(COMPASS_ROWS) / COMPASS_HZ
    path = _attitudes(time, rng)
    level = level_field(np.zeros(1), size=FIELD_UT, dip=DIP)[0]
    inside = np.einsum("nij,i->nj", path.matrices, level)
    temperature = 15.0 + 8.0 * np.sin(2.0 * np.pi * time / 90.0) + 0.05 * rng.normal(size=time.size)
    truth: dict[str, Any] = {"field_uT": FIELD_UT, "dip_deg": math.degrees(DIP)}
    told = []
    extra = np.zeros_like(inside)
    distort = np.eye(3)
    for effect in effects:
        entry: dict[str, Any] = {"effect": effect.id}
        if effect.id == "soft_iron":
            shape = rng.normal(size=(3, 3))
            shape = 0.5 * (shape + shape.T)
            shape -= np.trace(shape) / 3.0 * np.eye(3)
            values, vectors = np.linalg.eigh(effect.size * shape / np.abs(shape).max())
            distort = (vectors * np.exp(values)) @ vectors.T @ distort
            entry["matrix"] = distort.tolist()
        elif effect.id == "misalignment":
            c, s = math.cos(effect.size), math.sin(effect.size)
            distort = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) @ distort
            entry["deg"] = math.degrees(effect.size)
        else:
            more, told_more = _added_field(effect, (time, temperature), path, rng)
            extra += more
            entry |= told_more
        told.append(entry)
    readings = inside @ distort.T + extra + rng.normal(0.0, MAG_SIGMA_UT, inside.shape)
    up = path.matrices[:, 2, :] * GRAVITY + rng.normal(0.0, ACC_SIGMA_M_S2, inside.shape)
    columns = {"time_s": time}
    columns |= {f"mag_{a}_uT": readings[:, i] for i, a in enumerate("xyz")}
    columns |= {f"acc_{a}_m_s2": up[:, i] for i, a in enumerate("xyz")}
    columns["temperature_c"] = temperature
    columns |= {f"ref_q{a}": path.quaternions[:, i] for i, a in enumerate("wxyz")}
    columns |= {f"ref_p{a}_m": path.places[:, i] for i, a in enumerate("xyz")}
    truth["effects"] = told
    return _project("compass", columns), truth


def _added_field(
    effect: Effect,
    when: tuple[Floats, Floats],
    path: _Attitudes,
    rng: np.random.Generator,
) -> tuple[Floats, dict[str, Any]]:
    """What an effect adds to each reading, shape (n, 3) [uT], and its truth."""
    time, temperature = when
    direction = _direction(rng)
    field = effect.size * direction
    told: dict[str, Any] = {"uT": field.tolist()}
    if effect.id == "hard_iron":
        return np.tile(field, (time.size, 1)), told
    if effect.id == "interference_step":
        span = float(time[-1])
        on = effect.option("on")
        off = effect.option("off")
        on = float(rng.uniform(0.2, 0.4) * span) if on is None else on
        off = float(rng.uniform(0.6, 0.8) * span) if off is None else off
        inside = (time >= on) & (time < off)
        told |= {"on_s": on, "off_s": off if off <= span else None}
        return inside[:, None] * field, told
    if effect.id == "temperature":
        added = np.zeros((time.size, 3))
        added[:, 0] = effect.size * (temperature - temperature.mean())
        return added, {"uT_per_K": effect.size}
    if effect.id == "field_gradient":
        shape = rng.normal(size=(3, 3))
        shape = 0.5 * (shape + shape.T)
        shape -= np.trace(shape) / 3.0 * np.eye(3)  # a field without sources or currents
        shape *= effect.size / np.abs(np.linalg.eigvalsh(shape)).max()
        turned = np.einsum("nij,ni->nj", path.matrices, path.places @ shape)
        return turned, {"uT_per_m": shape.tolist()}
    count = int(effect.option("count") or 8.0)
    rows = np.sort(rng.choice(time.size, size=count, replace=False))
    added = np.zeros((time.size, 3))
    added[rows] = effect.size * np.array([_direction(rng) for _ in rows])
    return added, {"rows": rows.tolist(), "uT_each": effect.size}


def simulate_tilt(effects: Sequence[Effect], rng: np.random.Generator) -> Simulated:
    """A two-axis sensor against a reference, over a range of temperatures."""
    time = 20.0 * np.arange(TILT_ROWS)
    own = rng.uniform(-TILT_RANGE_ARCSEC, TILT_RANGE_ARCSEC, (TILT_ROWS, 2))
    temperature = (
        20.0 + 12.0 * np.sin(2.0 * np.pi * time / 2200.0) + rng.normal(0.0, 0.2, TILT_ROWS)
    )
    zero, scale = np.array([15.0, -8.0]), np.array([1.002, 0.997])
    reading = zero + scale * own + rng.normal(0.0, TILT_SIGMA_ARCSEC, own.shape)
    told = []
    for effect in effects:
        entry: dict[str, Any] = {"effect": effect.id, "size": effect.size}
        if effect.id == "cross_axis":
            reading += effect.size * own[:, ::-1] * np.array([1.0, -1.0])
        elif effect.id == "scale_nonlinearity":
            share = own / TILT_RANGE_ARCSEC
            reading += effect.size * share**3
        elif effect.id == "temperature":
            reading[:, 0] += effect.size * (temperature - 20.0)
        elif effect.id == "warm_up":
            tau = effect.option("tau") or 600.0
            reading[:, 0] += effect.size * np.exp(-time / tau)
            entry["tau_s"] = tau
        else:
            count = int(effect.option("count") or 3.0)
            rows = np.sort(rng.choice(TILT_ROWS, size=count, replace=False))
            reading[rows, 0] += effect.size * np.where(rng.random(count) < 0.5, -1.0, 1.0)
            entry["rows"] = rows.tolist()
        told.append(entry)
    columns = {
        "time_s": time,
        "tilt_along_arcsec": reading[:, 0],
        "tilt_across_arcsec": reading[:, 1],
        "ref_along_arcsec": own[:, 0],
        "ref_across_arcsec": own[:, 1],
        "temperature_c": temperature,
    }
    truth = {
        "zero_arcsec": zero.tolist(),
        "scale": scale.tolist(),
        "sigma_arcsec": TILT_SIGMA_ARCSEC,
        "effects": told,
    }
    return _project("tilt", columns), truth


def simulate_noise(coefficients: Mapping[str, float], rng: np.random.Generator) -> Simulated:
    """A gyro at rest with noise of stated coefficients.

    Parameters
    ----------
    coefficients : mapping
        Q [arcsec], N [deg/sqrt(h)], B [deg/h], K [deg/h/sqrt(h)], R [deg/h^2].
    rng : numpy.random.Generator
    """
    arcsec, hour = math.pi / 648000.0, 3600.0
    dt, n = 1.0 / NOISE_HZ, NOISE_ROWS
    q = coefficients.get("Q", 0.0) * arcsec
    white = math.radians(coefficients.get("N", 0.0)) / 60.0
    flicker = coefficients.get("B", 0.0) * arcsec
    walk = coefficients.get("K", 0.0) * arcsec / 60.0
    ramp = coefficients.get("R", 0.0) * arcsec / hour
    series = q / dt * np.diff(rng.normal(size=n + 1)) + white / math.sqrt(dt) * rng.normal(size=n)
    series += flicker * flicker_noise(n, rng)
    series += walk * math.sqrt(dt) * np.cumsum(rng.normal(size=n)) + ramp * dt * np.arange(n)
    time: Floats = np.arange(n, dtype=np.float64) * dt
    columns = {"time_s": time, "gyr_x_rad_s": series}
    return _project("rate", columns, name="noise"), {"coefficients": dict(coefficients)}


def flicker_noise(n: int, rng: np.random.Generator) -> Floats:
    """Flicker noise of B = 1: white noise differenced half a time, shape (n,).

    Source: Kasdin 1995, equation 116 with alpha = 1; two-sided density 1 / (2 pi f).
    """
    k = np.arange(1, n)
    response = np.concatenate([[1.0], np.cumprod((k - 0.5) / k)])
    white = np.fft.rfft(rng.normal(size=n), 2 * n)
    return np.asarray(np.fft.irfft(np.fft.rfft(response, 2 * n) * white, 2 * n)[:n])


def parse_coefficients(texts: Sequence[str]) -> dict[str, float]:
    """``SYMBOL=VALUE`` each, in the units of IEEE 952 as ``allan`` prints them.

    Raises
    ------
    SurveyError
        With everything that is wrong.
    """
    found: dict[str, float] = {}
    problems = []
    for text in texts:
        symbol, _, value = text.partition("=")
        try:
            number = float(value)
        except ValueError:
            number = math.nan
        if symbol not in NOISE_SYMBOLS:
            hint = nearest_names(symbol, NOISE_SYMBOLS)
            problems.append(Problem("there is no such coefficient", "coefficient", text, hint=hint))
        elif not math.isfinite(number) or number < 0.0:
            problems.append(Problem("this is no coefficient", "coefficient", text, "0 or more"))
        else:
            found[symbol] = number
    if problems:
        raise SurveyError(problems)
    return found or {"N": 0.3}


def _project(
    kind: str, columns: Mapping[str, Floats], *, name: str | None = None
) -> dict[str, str]:
    """A project with one sensor log."""
    title = name or kind
    rows = [",".join(f"{v:.9g}" for v in row) for row in zip(*columns.values(), strict=True)]
    text = "\n".join([",".join(columns), *rows]) + "\n"
    project = (
        f'format = 1\nname = "Simulated {title} (not observed)"\n\n'
        f'[[sensor_log]]\nid = "{title}"\nkind = "{kind}"\nfile = "sensors/{title}.csv"\n'
    )
    return {"project.toml": project, f"sensors/{title}.csv": text}
