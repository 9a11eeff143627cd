"""What north is found from: a log that was opened, its entry in the project, and the options."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import date
from pathlib import Path

from surveyapp.domain.advance import PartDone
from surveyapp.domain.sensor_entry import SensorLogEntry
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.errors import Problem
from surveyapp.io.sensor_logs.reading import LogFile, Need
from surveyapp.languages import said
from surveyapp.workflows.adopted_effects import need_with_adopted, without_adopted

_LATITUDE_HINT = "the level part of the earth rate, from which north is found, depends on it"


@dataclass(frozen=True, slots=True)
class NorthRequest:
    """What a north finding starts from.

    Parameters
    ----------
    method : str
        Of the command line; empty = not stated.
    file : LogFile
    entry : SensorLogEntry or None
    options : mapping
        Under the names of the command line; absent = not given.
    folder : Path or None
    today : datetime.date or None
    progress : callable or None
    """

    method: str
    file: LogFile
    entry: SensorLogEntry | None = None
    options: Mapping[str, object] = field(default_factory=dict)
    folder: Path | None = None
    today: date | None = None
    progress: PartDone | None = None

    def read(self, need: Need) -> SensorLog:
        """Read the columns that are needed, without adopted effects of the log."""
        log = self.file.read(need_with_adopted(need, self.entry), progress=self.progress)
        return without_adopted(log, self.entry)

    def option(self, name: str) -> object:
        """An option of the command line, else of the project's entry; None if neither has it."""
        value = self.options.get(name)
        if value is None and self.entry is not None:
            return self.entry.options.get(name)
        return value

    def number(self, name: str, problems: list[Problem]) -> float | None:
        """An option as a finite number; what is none goes to ``problems``."""
        value = self.option(name)
        if value is None:
            return None
        if isinstance(value, bool) or not isinstance(value, int | float):
            problems.append(Problem("this is no number", name, str(value), "a number"))
            return None
        if not math.isfinite(value):
            problems.append(Problem("this is no number", name, f"{value}", "a number"))
            return None
        return float(value)

    def sigma(self, name: str, problems: list[Problem]) -> float | None:
        """A standard deviation in degrees as radians; None where it is not stated."""
        value = self.number(name, problems)
        if value is not None and value < 0.0:
            problems.append(Problem("a sigma is negative", name, f"{value:g}", "0 or more"))
            return None
        return None if value is None else math.radians(value)

    def needed(self, name: str, problems: list[Problem], hint: str) -> float:
        """The same where it must be there; 0 beside a problem."""
        count = len(problems)
        value = self.number(name, problems)
        if value is None:
            if len(problems) == count:
                text = name.removesuffix("_deg").replace("_", " ")
                problems.append(
                    Problem(
                        said("the {text} is not stated", text=text),
                        name,
                        "",
                        "degrees",
                        hint,
                    )
                )
            return 0.0
        return value

    def latitude(self, problems: list[Problem], *, required: bool = True) -> float | None:
        """Latitude [rad], of the command line or of the log's entry."""
        before = len(problems)
        if self.options.get("latitude") is None and self.entry is not None:
            degrees = self.entry.latitude_deg
        else:
            degrees = self.number("latitude", problems)
        if degrees is None:
            if required and len(problems) == before:
                what = "the latitude is not stated"
                problems.append(Problem(what, "latitude", "", "degrees", _LATITUDE_HINT))
            return None
        if not -90.0 <= degrees <= 90.0:
            found = f"{degrees:g}"
            problems.append(Problem("this is no latitude", "latitude", found, "-90 to 90"))
            return None
        return math.radians(degrees)

    def declination(self) -> object:
        """D or D,SIGMA in degrees of the options, else of the log's entry; None without."""
        given = self.options.get("declination")
        if given is not None or self.entry is None:
            return given
        stated = [self.entry.options.get(f"declination{part}_deg") for part in ("", "_sigma")]
        if stated[0] is None:
            return None
        return ",".join(str(part) for part in stated if part is not None)


def declination_problems(request: NorthRequest) -> list[Problem]:
    """A declination beside a heading that is not magnetic, whatever the method."""
    value = request.declination()
    magnetic = request.option("initial_reference") == "MAGNETIC"
    if value is None or (magnetic and request.method == "rotation"):
        return []
    if request.method == "rotation" and request.option("initial_reference") is None:
        found = "a heading without a reference"
    elif request.method == "rotation":
        found = said("a heading of reference {value}", value=request.option("initial_reference"))
    else:
        found = "a heading from the earth's rotation: ASTRONOMIC"
    return [
        Problem(
            "a declination belongs to a magnetic heading only",
            "declination",
            found,
            "`initial_reference` MAGNETIC" if request.method == "rotation" else "no declination",
            "a gyro finds true north: with a declination the heading would be wrong by it",
        )
    ]
