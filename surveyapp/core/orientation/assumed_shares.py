"""How much of an azimuth's variance rests on a sigma that nobody states.

A default is asked about where it matters: the warning says which share of the variance it makes, so
that a surveyor knows whether it is worth finding the true value.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from surveyapp.core.orientation.deflection_field import NAME as DEFLECTION
from surveyapp.core.orientation.known_azimuth import NAME as KNOWN
from surveyapp.core.orientation.lines import OrientedLine
from surveyapp.domain.project import Deflection, Project
from surveyapp.domain.subject import Subject
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import said
from surveyapp_models.angles import RHO_ARCSEC

ASKED = "known_azimuth_sigma_assumed"
WORTH_ASKING: Final = 0.25
"""Share of a variance from which an unknown deflection is asked about: without it the sigma would
be an eighth smaller."""


def with_shares(
    project: Project, warnings: Sequence[ResultWarning], lines: Sequence[OrientedLine]
) -> tuple[ResultWarning, ...]:
    """Warnings of assumed sigmas with their share of the variance, and one for the deflection.

    Parameters
    ----------
    project : Project
    warnings : sequence of ResultWarning
    lines : sequence of OrientedLine
        Of all survey sessions.
    """
    found = list(warnings)
    share, name = _largest(lines, KNOWN)
    if share > 0.0:
        found = [_told(item, share, name) if item.code == ASKED else item for item in found]
    assumed = {s.name for s in project.stations if s.deflection == Deflection()}
    exposed = [line for line in lines if line.result.station in assumed]
    share, name = _largest(exposed, DEFLECTION)
    if share >= WORTH_ASKING:
        text = said(
            'the deflections of the vertical are not known: the assumed +-{sigma:.0f}" makes '
            "{share:.0%} of the variance of {line}; state deflection of the stations or of the "
            "region",
            sigma=Deflection().sigma * RHO_ARCSEC,
            share=share,
            line=name,
        )
        found.append(ResultWarning("deflection_assumed", text, Subject.project()))
    return tuple(found)


def _told(warning: ResultWarning, share: float, line: str) -> ResultWarning:
    text = said(
        "{warning}; known azimuths make up to {share:.0%} of a variance ({line})",
        warning=warning.text,
        share=share,
        line=line,
    )
    return replace(warning, text=text)


def _largest(lines: Sequence[OrientedLine], source: str) -> tuple[float, str]:
    """Largest share of a source over the lines, and the line that has it."""
    shares = [
        (row.share, f"{line.result.station}-{line.result.target}")
        for line in lines
        for row in line.result.budget
        if row.source == source
    ]
    return max(shares, default=(0.0, ""))
