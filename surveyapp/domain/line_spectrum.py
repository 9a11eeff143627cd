"""Interference lines of a record, schema ``surveyapp.spectrum/1``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

from surveyapp.domain.warning import ResultWarning

SPECTRUM_SCHEMA: Final = "surveyapp.spectrum/1"


@dataclass(frozen=True, slots=True)
class InterferenceLine:
    """One line.

    Parameters
    ----------
    frequency_hz, sigma_hz : float
    amplitude, sigma_amplitude : float
        In the unit of the column.
    false_alarm_probability : float
        Of noise having such a peak anywhere; of a line that only its family shows, the family's.
    family : int or None
        Number of its family, from 0.
    """

    frequency_hz: float
    sigma_hz: float
    amplitude: float
    sigma_amplitude: float
    false_alarm_probability: float
    family: int | None = None

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "frequency_hz": self.frequency_hz,
            "sigma_hz": self.sigma_hz,
            "amplitude": self.amplitude,
            "sigma_amplitude": self.sigma_amplitude,
            "false_alarm_probability": self.false_alarm_probability,
            "family": self.family,
        }


@dataclass(frozen=True, slots=True)
class HarmonicFamily:
    """A fundamental and which of its multiples stand out."""

    fundamental_hz: float
    sigma_hz: float
    harmonics: tuple[int, ...]
    p_family: float

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "fundamental_hz": self.fundamental_hz,
            "sigma_hz": self.sigma_hz,
            "harmonics": list(self.harmonics),
            "frequencies_hz": [self.fundamental_hz * h for h in self.harmonics],
            "p_family": self.p_family,
        }


@dataclass(frozen=True, slots=True)
class Scatter:
    """Standard deviation with and without the lines, of samples and of 10 s means."""

    before: float
    after: float
    before_10s: float | None
    after_10s: float | None
    unit: str

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "before": self.before,
            "after": self.after,
            "before_10s": self.before_10s,
            "after_10s": self.after_10s,
            "unit": self.unit,
        }


@dataclass(frozen=True, slots=True)
class MagneticBudget:
    """Bias of a fibre-optic gyro in a magnetic field.

    Parameters
    ----------
    field_uT : float
    sensitivity_deg_h_t : float
        [deg/h per T]
    shielding : float
        Factor by which the field is weakened.
    bias_deg_h : float
    """

    field_uT: float  # noqa: N815  the unit of the contract
    sensitivity_deg_h_t: float
    shielding: float
    bias_deg_h: float

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "field_uT": self.field_uT,
            "sensitivity_deg_h_t": self.sensitivity_deg_h_t,
            "shielding": self.shielding,
            "bias_deg_h": self.bias_deg_h,
        }


@dataclass(frozen=True, slots=True)
class LineSpectrum:
    """Lines of one column of a record, and what they do to it.

    Parameters
    ----------
    source, column, unit : str
    n : int
    rate_hz : float
    lines : tuple of InterferenceLine
    families : tuple of HarmonicFamily
    scatter : Scatter
    magnetic : MagneticBudget or None
    against : mapping or None
        Comparison with a second record; ready for JSON.
    warnings : tuple of ResultWarning
    sha256 : str
    frequency_hz, density : tuple of float
        Of the plot: power spectral density [unit^2/Hz].
    """

    source: str
    column: str
    unit: str
    n: int
    rate_hz: float
    lines: tuple[InterferenceLine, ...]
    families: tuple[HarmonicFamily, ...]
    scatter: Scatter
    magnetic: MagneticBudget | None = None
    against: Mapping[str, Any] | None = None
    warnings: tuple[ResultWarning, ...] = ()
    sha256: str = ""
    frequency_hz: tuple[float, ...] = ()
    density: tuple[float, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON, schema ``surveyapp.spectrum/1``."""
        return {
            "schema": SPECTRUM_SCHEMA,
            "source": self.source,
            "sha256": self.sha256,
            "column": self.column,
            "unit": self.unit,
            "n": self.n,
            "rate_hz": self.rate_hz,
            "lines": [line.to_dict() for line in self.lines],
            "families": [family.to_dict() for family in self.families],
            "sd": self.scatter.to_dict(),
            "magnetic": None if self.magnetic is None else self.magnetic.to_dict(),
            "against": None if self.against is None else dict(self.against),
            "density": {
                "frequency_hz": list(self.frequency_hz),
                "density": list(self.density),
                "unit": f"({self.unit})^2/Hz",
            },
            "warnings": [item.to_dict() for item in self.warnings],
        }
