"""North found by a rate sensor, schema ``surveyapp.north/1``; one form for each method."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final, Literal

from surveyapp.domain.calibration import SensorParameter
from surveyapp.domain.warning import ResultWarning

NORTH_SCHEMA: Final = "surveyapp.north/1"
Reference = Literal["ASTRONOMIC", "MAGNETIC", "GRID"]


@dataclass(frozen=True, slots=True)
class NorthDirection:
    """A direction with its reference.

    Parameters
    ----------
    deg : float or None
        None = not determined.
    sigma_arcsec, interval95_arcsec : float or None
    reference : str
        ASTRONOMIC | MAGNETIC | GRID
    """

    deg: float | None
    sigma_arcsec: float | None
    interval95_arcsec: float | None
    reference: Reference = "ASTRONOMIC"

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "deg": self.deg,
            "sigma_arcsec": self.sigma_arcsec,
            "interval95_arcsec": self.interval95_arcsec,
            "reference": self.reference,
        }


@dataclass(frozen=True, slots=True)
class NorthResult:
    """North of one record.

    Parameters
    ----------
    method : str
        fog-station | indexing | rotation
    source : str
    key : str
        Key of the direction in the JSON: ``gyro_north`` (a circle reading) or ``heading``.
    direction : NorthDirection
    parameters : tuple of SensorParameter
    undetermined : tuple of str
    warnings : tuple of ResultWarning
    met : bool
        False ends with exit 1.
    n : int
        Rows used.
    sha256 : str
    extra : mapping
        Further keys of this method; ready for JSON.
    direction_extra : mapping
        Further keys of the direction.
    """

    method: str
    source: str
    key: Literal["gyro_north", "heading"]
    direction: NorthDirection
    parameters: tuple[SensorParameter, ...]
    undetermined: tuple[str, ...] = ()
    warnings: tuple[ResultWarning, ...] = ()
    met: bool = True
    n: int = 0
    sha256: str = ""
    extra: Mapping[str, Any] = field(default_factory=dict)
    direction_extra: Mapping[str, Any] = field(default_factory=dict)

    def value(self, name: str) -> float | None:
        """Value of a parameter; None if it is not determined.

        Raises
        ------
        KeyError
            If there is no parameter of this name.
        """
        for item in self.parameters:
            if item.name == name:
                return item.value
        raise KeyError(name)

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON, schema ``surveyapp.north/1``."""
        return {
            "schema": NORTH_SCHEMA,
            "method": self.method,
            "source": self.source,
            "sha256": self.sha256,
            "n": self.n,
            self.key: {**self.direction.to_dict(), **self.direction_extra},
            "parameters": [item.to_dict() for item in self.parameters],
            "undetermined": list(self.undetermined),
            "warnings": [item.to_dict() for item in self.warnings],
            **self.extra,
        }
