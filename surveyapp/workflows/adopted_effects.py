"""Effects that were adopted for a log: told wherever they are not taken out."""

from __future__ import annotations

from surveyapp.domain.project import ResultWarning
from surveyapp.domain.sensor_entry import SensorLogEntry
from surveyapp.languages import said


def not_taken_out(entry: SensorLogEntry | None) -> tuple[ResultWarning, ...]:
    """That the result still holds the effects adopted for its log; empty where there are none."""
    if entry is None or not entry.effects:
        return ()
    names = ", ".join(dict.fromkeys(effect.id for effect in entry.effects))
    text = said(
        "adopted for this log and not taken out here: {names}; diagnose shows "
        "the record without, a sensor card holds parameters only",
        names=names,
    )
    return (ResultWarning("adopted_not_applied", text),)
