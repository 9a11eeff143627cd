"""What a record does not determine, and why, as blocks."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from surveyapp.domain.calibration import SensorParameter, names_by_reason
from surveyapp.languages import said
from surveyapp.languages.names import ids
from surveyapp.report.blocks import Paragraph


def undetermined_blocks(
    parameters: Iterable[SensorParameter], names: Sequence[str]
) -> list[Paragraph]:
    """One paragraph a reason, then the names that have none of their own."""
    found, told = [], set()
    for reason, own in names_by_reason(parameters).items():
        told |= set(own)
        text = said("No value, {why}: {names}.", why=reason, names=ids(own))
        found.append(Paragraph(text, "warning"))
    others = [name for name in names if name not in told]
    if others:
        text = said("Not determined: {names}.", names=ids(others))
        found.append(Paragraph(text, "warning"))
    return found
