"""What a tilt log and a compass log say of one session, each calibrated by its card."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class BlockTilt:
    """Mean tilt during a block [rad], its sigma [rad] and the samples of the log in it."""

    along: float
    across: float
    sigma: float
    samples: int


@dataclass(frozen=True, slots=True)
class LogLevelling:
    """A tilt log of a session.

    Parameters
    ----------
    log, card : str
        Id of the ``[[sensor_log]]`` and the card as written.
    run, tape_zero : BlockTilt or None
        None where the log has no sample in the block, and where the card does not hold.
    refusals : tuple of str
        Why the card does not hold; then nothing is applied.
    """

    log: str
    card: str
    run: BlockTilt | None = None
    tape_zero: BlockTilt | None = None
    refusals: tuple[str, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        run, unit = self.run, math.pi / 648000.0
        return {
            "log": self.log,
            "card": self.card,
            "along_arcsec": None if run is None else run.along / unit,
            "across_arcsec": None if run is None else run.across / unit,
            "sigma_arcsec": None if run is None else run.sigma / unit,
            "samples": 0 if run is None else run.samples,
            "refusals": list(self.refusals),
        }


@dataclass(frozen=True, slots=True)
class PreOrientation:
    """Where the alidade pointed by the compass before the run.

    Parameters
    ----------
    log, card : str
    heading : float or None
        MAGNETIC, clockwise [rad]; None where the card does not hold.
    sigma : float or None
        Of the offset: calibration, readings and declination [rad].
    declination, declination_sigma : float or None
        East positive [rad]; without it a magnetic heading says nothing of north.
    circle : float or None
        Circle reading while the compass was read [rad].
    refusals : tuple of str
        Why the card does not hold.
    modelled : bool
        Whether the declination is that of the World Magnetic Model and not a stated one.
    """

    log: str
    card: str
    heading: float | None = None
    sigma: float | None = None
    declination: float | None = None
    declination_sigma: float | None = None
    circle: float | None = None
    refusals: tuple[str, ...] = ()
    modelled: bool = False

    @property
    def offset(self) -> float | None:
        """Azimuth of the alidade from astronomic north, in -pi to pi [rad]."""
        if self.heading is None or self.declination is None:
            return None
        return math.remainder(self.heading + self.declination, 2.0 * math.pi)

    @property
    def interval95(self) -> float | None:
        """Half of the 95 % interval of the offset [rad]."""
        return None if self.sigma is None else 1.959964 * self.sigma

    @property
    def turn_to(self) -> float | None:
        """Circle reading at which the alidade points north [rad]."""
        if self.offset is None or self.circle is None:
            return None
        return (self.circle - self.offset) % (2.0 * math.pi)

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""

        def degrees(value: float | None) -> float | None:
            return None if value is None else math.degrees(value)

        offset = self.offset
        return {
            "log": self.log,
            "card": self.card,
            "magnetic_heading_deg": degrees(self.heading),
            "declination_deg": degrees(self.declination),
            "declination_sigma_deg": degrees(self.declination_sigma),
            "declination_source": None
            if self.declination is None
            else ("model" if self.modelled else "stated"),
            "offset_deg": degrees(offset),
            "sigma_deg": degrees(self.sigma),
            "interval95_deg": degrees(self.interval95),
            "turn_by_deg": None if offset is None else -math.degrees(offset),
            "turn_to_deg": degrees(self.turn_to),
            "refusals": list(self.refusals),
        }
