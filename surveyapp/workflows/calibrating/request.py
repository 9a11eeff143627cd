"""What is calibrated: a log that was opened, its entry in the project, and the options."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import date
from pathlib import Path
from typing import Final

from surveyapp.core.sensors.adopted_effects import without_events
from surveyapp.core.sensors.clipping import without_clipped
from surveyapp.domain.advance import PartDone
from surveyapp.domain.sensor_entry import SensorLogEntry
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.sensor_logs.blocks import room_for
from surveyapp.io.sensor_logs.reading import LogFile, Need

MOST_ROWS: Final = 100_000
"""Rows of a compass or tilt log that are fitted: a longer one is thinned. Its parameters are known
to a hundredth of its noise then, and models of 1e7 rows would take gigabytes."""


@dataclass(frozen=True, slots=True)
class CalibrationRequest:
    """What a calibration starts from.

    Parameters
    ----------
    kind : str
    file : LogFile
    entry : SensorLogEntry or None
        Where the log is one of a project.
    options : mapping
        Of the command line, under the names that it gives them; absent = not given.
    folder : Path or None
        Of the project, or where the log lies.
    today : datetime.date or None
        The day on which this runs.
    progress : callable or None
    """

    kind: str
    file: LogFile
    entry: SensorLogEntry | None = None
    options: Mapping[str, object] = field(default_factory=dict)
    folder: Path | None = None
    today: date | None = None
    progress: PartDone | None = None

    @property
    def source(self) -> str:
        """Name of the log in results."""
        return self.entry.id if self.entry is not None else self.file.request.where

    def read(self, need: Need) -> SensorLog:
        """Read the columns that are needed."""
        return self.file.read(need, progress=self.progress)

    def read_adopted(self, need: Need, *, fitted: Sequence[str] = ()) -> SensorLog:
        """The same without adopted events of the log; what was done is in its warnings.

        Rows in which one of the ``fitted`` columns stands at an end of its range are left out.
        """
        log = self.read(need)
        if self.entry is not None and self.entry.effects:
            log, told = without_events(log, self.entry.effects, room=room_for)
            log = replace(log, warnings=(*log.warnings, *told))
        return without_clipped(log, fitted, most=MOST_ROWS)

    def option(self, name: str) -> object:
        """An option of the command line, else of the project's entry; None if neither has it."""
        value = self.options.get(name)
        if value is None and self.entry is not None:
            return self.entry.options.get(name)
        return value

    def number(self, name: str, default: float | None = None) -> float | None:
        """An option as a number.

        Raises
        ------
        SurveyError
            If it is none.
        """
        value = self.option(name)
        if value is None:
            return default
        if isinstance(value, bool) or not isinstance(value, int | float):
            where = name.replace("_", "-")
            raise SurveyError(Problem("this is no number", where, str(value), "a number"))
        return float(value)
