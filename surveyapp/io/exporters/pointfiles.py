"""Points for total stations: Leica GSI-16 (11 81 82 83) and Sokkia SDR33 (00 10 08).

Source: formats as in ``surveyapp.io.importers.fieldfiles``; coordinates to 0.1 mm.
"""

from __future__ import annotations

from collections.abc import Sequence

from surveyapp.domain.exported import ExportedPoint, ExportedSurvey, Written
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said

_WIDTH = 16


def _names(points: Sequence[ExportedPoint]) -> list[ResultWarning]:
    """Names that 16 bytes of ASCII cannot hold are refused: a cut name is another point."""
    bad = [p.name for p in points if len(p.name) > _WIDTH or not p.name.isascii()]
    if bad:
        raise SurveyError(
            [
                Problem(
                    "the name does not fit the format",
                    "stations",
                    name,
                    said("at most {width} characters of ASCII", width=_WIDTH),
                    "rename the station for this export",
                )
                for name in bad
            ]
        )
    zeros = [p.name for p in points if p.name[:1] == "0" and p.name != "0"]
    if not zeros:
        return []
    text = said(
        "GSI pads names with zeros, those in front of a name are lost: {names}",
        names=", ".join(zeros),
    )
    return [ResultWarning("leading_zeros", text)]


def _apart(points: Sequence[ExportedPoint]) -> None:
    """Refuse names that GSI cannot tell apart: padding with zeros makes 7 and 007 one point."""
    found: dict[str, list[str]] = {}
    for point in points:
        found.setdefault(point.name.lstrip("0") or "0", []).append(point.name)
    problems = [
        Problem(
            "names become one, for GSI pads them with zeros",
            "stations",
            ", ".join(names),
            "names that differ otherwise than by zeros in front",
            "rename one of the stations for this export",
        )
        for names in found.values()
        if len(names) > 1
    ]
    if problems:
        raise SurveyError(problems)


def _word(index: str, value: float) -> str:
    digits = round(abs(value) * 10_000)
    sign = "-" if value < 0.0 and digits else "+"
    return f"{index}..46{sign}{digits:016d} "


def gsi_text(survey: ExportedSurvey) -> Written:
    """Points as GSI-16: name, east, north and height in 0.1 mm, marked as computed.

    Raises
    ------
    SurveyError
        For names that 16 characters of ASCII cannot hold.
    """
    told = _names(survey.points)
    _apart(survey.points)
    lines = []
    for number, point in enumerate(survey.points, start=1):
        text = f"*11{number % 10000:04d}+{point.name:0>16} " + _word("81", point.e)
        text += _word("82", point.n) + ("" if point.h is None else _word("83", point.h))
        lines.append(text)
    return Written("".join(f"{line}\r\n" for line in lines), len(lines), tuple(told))


def sdr_text(survey: ExportedSurvey) -> Written:
    """Points as SDR33: header, job and known points in the order north, east, height.

    Raises
    ------
    SurveyError
        For names that 16 characters of ASCII cannot hold.
    """
    _names(survey.points)
    job = "".join(c for c in survey.name if c.isascii() and c.isprintable())[:_WIDTH] or "JOB"
    lines = [f"00NM{'SDR33 V04-04.02':<16}{'':<20}111111", f"10NM{job:<16}121111"]
    for point in survey.points:
        values = [f"{point.n:.4f}", f"{point.e:.4f}", "" if point.h is None else f"{point.h:.4f}"]
        if any(len(value) > _WIDTH for value in values):
            raise SurveyError(Problem("the coordinates are too large", "stations", point.name))
        fields = "".join(f"{value:<16}" for value in values)
        lines.append(f"08KI{point.name:>16}{fields}{'':<16}")
    return Written("".join(f"{line}\r\n" for line in lines), len(survey.points))
