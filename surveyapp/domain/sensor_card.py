"""A sensor card: the calibration of one sensor with where it is from and where it holds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import date

import numpy as np
from numpy.typing import NDArray

from surveyapp.domain.calibration import SensorParameter
from surveyapp.domain.sensor_entry import SensorKind
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem
from surveyapp.languages import said


@dataclass(frozen=True, slots=True)
class SensorCard:
    """Parameters of one sensor.

    Parameters
    ----------
    id, title : str
    kind : SensorKind
    source : str
        From which record, by which software.
    parameters : tuple of SensorParameter
        The determined ones; what was not determined is absent.
    calibrated_on, valid_from, valid_to : datetime.date or None
    temperature_c : tuple of float, or None
        Lowest and highest temperature of the record; None where it held none.
    sha256 : str
        Of the log.
    covariance : ndarray, shape (k, k), or None
        Of the parameters that have a sigma, in their order.
    constants : mapping of str to float
        Further numbers that belong to the parameters, such as reference_temperature_c.
    notes : mapping of str to str
        What a reader must know, such as that the card holds only near level.
    extra : mapping
        Tables of the subject's own, as they stand in the file.
    warnings : tuple of ResultWarning
        What its file holds that nobody knows.
    """

    id: str
    title: str
    kind: SensorKind
    source: str
    parameters: tuple[SensorParameter, ...]
    calibrated_on: date | None = None
    valid_from: date | None = None
    valid_to: date | None = None
    temperature_c: tuple[float, float] | None = None
    sha256: str = ""
    covariance: NDArray[np.float64] | None = None
    constants: Mapping[str, float] = field(default_factory=dict)
    notes: Mapping[str, str] = field(default_factory=dict)
    extra: Mapping[str, object] = field(default_factory=dict)
    warnings: tuple[ResultWarning, ...] = ()

    def get(self, name: str) -> float | None:
        """Value of a parameter, None where the card does not have it."""
        return next((item.value for item in self.parameters if item.name == name), None)

    def sigma(self, name: str) -> float | None:
        """Standard deviation of a parameter, None where the card does not have it."""
        return next((item.sigma for item in self.parameters if item.name == name), None)

    def refusals(
        self, *, on: date | None, temperature_c: tuple[float, float] | None, where: str
    ) -> list[Problem]:
        """Why the card does not hold for a record of this day and these temperatures.

        Parameters
        ----------
        on : datetime.date or None
            Day of the record; None is not judged.
        temperature_c : tuple of float, or None
            Lowest and highest temperature of the record; None is not judged.
        where : str
            The card, for messages.

        Returns
        -------
        list of Problem
            Empty where the card holds.
        """
        problems = []
        low, high = self.valid_from, self.valid_to
        if on is not None and ((low and on < low) or (high and on > high)):
            problems.append(
                Problem(
                    "the card does not hold on this day",
                    where,
                    on.isoformat(),
                    said(
                        "{value} to {value2}",
                        value=low.isoformat() if low else "...",
                        value2=high.isoformat() if high else "...",
                    ),
                    "calibrate the sensor again",
                )
            )
        if temperature_c is not None and self.temperature_c is not None:
            lowest, highest = self.temperature_c
            if temperature_c[0] < lowest or temperature_c[1] > highest:
                problems.append(
                    Problem(
                        "the card does not hold at these temperatures",
                        where,
                        f"{temperature_c[0]:g} to {temperature_c[1]:g} C",
                        said("{lowest:g} to {highest:g} C", lowest=lowest, highest=highest),
                        "a sensor is not extrapolated: calibrate it over the range that it meets",
                    )
                )
        return problems
