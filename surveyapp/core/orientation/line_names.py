"""Which line a text means: a station's name may hold hyphens itself, so the stations decide."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from surveyapp.domain.results import LineResult
from surveyapp.domain.station_line import StationLine, meanings
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.languages import either, joined


def resolve_line(
    line: str | tuple[str, str],
    stations: Collection[str],
    lines: Sequence[LineResult],
    *,
    more: str = "",
) -> StationLine:
    """The line that a text means.

    Parameters
    ----------
    line : str or (str, str)
    stations : collection of str
        Those that exist.
    lines : sequence of LineResult
        The oriented lines.
    more : str
        Added to the hint where there is no such line.

    Raises
    ------
    SurveyError
        If no oriented line is meant, or several are.
    """
    asked = (StationLine(*line),) if isinstance(line, tuple) else meanings(line, stations)
    oriented = dict.fromkeys(StationLine(item.station, item.target) for item in lines)
    found = [item for item in asked if item in oriented]
    if len(found) == 1:
        return found[0]
    shown = "-".join(line) if isinstance(line, tuple) else line
    if found:
        raise SurveyError(
            Problem(
                what="this name means several lines",
                where="line",
                found=shown,
                expected=either(item.unmistakable for item in found),
                hint="Write the station and the target with a comma between them.",
            )
        )
    names = [str(item) for item in oriented]
    raise SurveyError(
        Problem(
            what="there is no oriented line of this name",
            where="line",
            found=shown,
            expected="station-target of a survey session",
            hint=joined(". ", filter(None, [nearest_names(shown, names), more])),
        )
    )
