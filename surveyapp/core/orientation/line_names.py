"""Which line a text means: a station's name may hold hyphens itself, so the stations decide."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from surveyapp.domain.results import LineResult
from surveyapp.errors import Problem, SurveyError, nearest_names

SEPARATORS = ("-", ",")
"""``A-B`` as people write it; ``A,B`` where hyphens in the names leave two meanings."""


def meanings(text: str, stations: Collection[str]) -> tuple[tuple[str, str], ...]:
    """Every pair of existing stations that a text may mean, in order."""
    known = set(stations)
    pairs = [
        (text[:place].strip(), text[place + 1 :].strip())
        for place, letter in enumerate(text)
        if letter in SEPARATORS
    ]
    return tuple(dict.fromkeys(p for p in pairs if p[0] in known and p[1] in known))


def resolve_line(
    line: str | tuple[str, str],
    stations: Collection[str],
    lines: Sequence[LineResult],
    *,
    more: str = "",
) -> tuple[str, str]:
    """Station and target that a text means.

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
    pairs = (line,) if isinstance(line, tuple) else meanings(line, stations)
    oriented = {(item.station, item.target): None for item in lines}
    found = [pair for pair in pairs if pair in oriented]
    if len(found) == 1:
        return found[0]
    shown = "-".join(line) if isinstance(line, tuple) else line
    if found:
        raise SurveyError(
            Problem(
                what="this name means several lines",
                where="line",
                found=shown,
                expected=" or ".join(f"{a},{b}" for a, b in found),
                hint="Write the station and the target with a comma between them.",
            )
        )
    names = [f"{a}-{b}" for a, b in oriented]
    raise SurveyError(
        Problem(
            what="there is no oriented line of this name",
            where="line",
            found=shown,
            expected="station-target of a survey session",
            hint=". ".join(filter(None, [nearest_names(shown, names), more])),
        )
    )
