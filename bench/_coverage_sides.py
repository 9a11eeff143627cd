"""Coverage of combined sides: lines of one side by several automatic gyros, forward and back.

Exact forward models: rounds are drawn, plumb lines bent by one field, a known azimuth is wrong for
both instruments alike.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from surveyapp_models.angles import ARCSEC, RHO_ARCSEC, AngleUnit, format_angle, wrap_two_pi
from surveyapp_models.arrays import Floats

Files = dict[str, str]
EARTH_RADIUS_M = 6371000.0


@dataclass(frozen=True, slots=True)
class Drawn:
    """One project and the true azimuth [rad] of the line that it seeks."""

    files: Files
    azimuth: float


AUTOMATIC = """format = 1
name = "Two instruments on one side"
crs = "+proj=tmerc +lat_0=0 +lon_0=20 +k=1 +x_0=500000 +y_0=0 +ellps=GRS80 +units=m +type=crs"
"""
SIDE_M = 500.0


def one_side(
    count: int, rng: np.random.Generator, ends: tuple[tuple[str, str], ...]
) -> Iterator[Drawn]:
    """Lines of one side by automatic gyros: rounds of 4 and 8 arc-seconds, six or three of them.

    Both instruments were calibrated on one known line, whose error they share; the plumb lines of
    the three occupied stations are bent by one field.
    """
    latitude, known_sigma = math.radians(55.0), 3.0 * ARCSEC
    north = {"K1": 0.0, "K2": SIDE_M, "U1": 5000.0, "U2": 5000.0 + SIDE_M}
    occupied = ("K1", "U1", "U2")
    at = np.array([north[name] for name in occupied])
    field = (5.0 * ARCSEC) ** 2 * np.exp(-np.abs(at[:, None] - at[None, :]) / 20000.0)
    for run in range(count):
        rounds = 6 if run % 2 else 3
        eta = dict(zip(occupied, rng.multivariate_normal(np.zeros(3), field), strict=True))
        error = float(rng.normal(scale=known_sigma))
        files: Files = {}
        toml = AUTOMATIC + _stations(north, latitude)
        for number, (start, end) in enumerate(ends):
            name, sigma = ("G", 4.0) if number == 0 else ("H", 8.0)
            toml += f'[[instrument]]\nid = "{name}"\ncard = "gyromat-3000"\n'
            toml += f"sigma = {{ azimuth_arcsec = {sigma} }}\n"
            constant = float(rng.uniform(-60.0, 60.0)) * ARCSEC
            for own, to, purpose in (("K1", "K2", "calibration"), (start, end, "survey")):
                azimuth = eta[own] * math.tan(latitude) - constant
                azimuth += 0.0 if north[to] > north[own] else math.pi
                spread = rng.normal(scale=sigma * ARCSEC, size=rounds)
                book = f"observations/{name}-{purpose}.csv"
                files[book] = _rounds(azimuth + spread)
                toml += _automatic(name, (own, to), purpose, book)
                if purpose == "calibration":
                    text = format_angle(wrap_two_pi(error), AngleUnit.DMS, 3)
                    toml += f'azimuth_known = "{text}"\n'
                    toml += f"azimuth_known_sigma_arcsec = {known_sigma * RHO_ARCSEC:.3f}\n"
        start, end = ends[0]
        true = 0.0 if north[end] > north[start] else math.pi
        yield Drawn(files | {"project.toml": toml}, true)


def _stations(north: dict[str, float], latitude: float) -> str:
    """Stations on the central meridian, with deflections of the default sigma."""
    text = ""
    for name, distance in north.items():
        n = latitude * EARTH_RADIUS_M + distance
        text += f'[[station]]\nname = "{name}"\ne = 500000.0\nn = {n:.4f}\n'
    return text


def _rounds(azimuths: Floats) -> str:
    rows = [
        f"{i},azimuth,{format_angle(wrap_two_pi(value), AngleUnit.DMS, 2)}"
        for i, value in enumerate(azimuths.tolist(), start=1)
    ]
    return "\n".join(["seq,kind,value", *rows]) + "\n"


def _automatic(instrument: str, line: tuple[str, str], purpose: str, book: str) -> str:
    return (
        f'[[orientation]]\nid = "{instrument}-{purpose}"\nstation = "{line[0]}"\n'
        f'target = "{line[1]}"\ninstrument = "{instrument}"\nmethod = "automatic"\n'
        f'purpose = "{purpose}"\nbook = "{book}"\n'
        "centring_mm = { instrument = 0.0, target = 0.0 }\n"
    )


def two_instruments(count: int, rng: np.random.Generator) -> Iterator[Drawn]:
    """The same line by two instruments."""
    return one_side(count, rng, (("U1", "U2"), ("U1", "U2")))


def forward_and_back(count: int, rng: np.random.Generator) -> Iterator[Drawn]:
    """One instrument forward, the other back."""
    return one_side(count, rng, (("U1", "U2"), ("U2", "U1")))
