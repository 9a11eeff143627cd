"""A diagnosis as text for the screen: words first, then models, candidates and both channels."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rich.text import Text

from surveyapp.languages import shown, translated
from surveyapp.report.sections import diagnosis as section
from surveyapp.report.text import blocks_text
from surveyapp.tui import texts
from surveyapp.tui.cells import padded
from surveyapp.workflows.diagnosing import Diagnosed
from surveyapp_models.angles import AngleUnit

SUBJECT_COLUMNS = (texts.COL_SUBJECT, texts.COL_ID, texts.COL_VERDICT)
COLUMNS = 76
"""Columns of a terminal of 80 within the borders of the page."""
BARS = "▁▂▃▄▅▆▇█"

__all__ = ["SUBJECT_COLUMNS", "Diagnosed", "diagnosis_view", "subject_rows"]


def subject_rows(
    subjects: Sequence[tuple[str, str]], found: Mapping[int, Diagnosed]
) -> list[tuple[str, str, str]]:
    """One row a subject, with its verdict as a word."""
    rows = []
    for place, (option, identity) in enumerate(subjects):
        made = found.get(place)
        verdict = ""
        if made is not None and made.diagnosis is not None:
            verdict = translated(made.diagnosis.verdict.replace("_", " "))
        name = {
            "session": texts.SUBJECT_RUN,
            "campaign": texts.SUBJECT_CAMPAIGN,
            "traverse": texts.SUBJECT_TRAVERSE,
        }.get(option, option)
        rows.append((name, identity, verdict))
    return rows


def diagnosis_view(found: Diagnosed, unit: AngleUnit = AngleUnit.DMS) -> Text:
    """The whole diagnosis of one subject: the blocks of the record, residuals as bars."""
    diagnosis = found.diagnosis
    if diagnosis is None:
        return Text(texts.NO_SUBJECTS)
    text = Text()
    for sentence in found.words:
        text.append(texts.D_SENTENCE.format(sentence=shown(sentence)))
    text.append(f"\n{blocks_text([section.models(diagnosis, unit)], COLUMNS)}\n")
    for name, before, after in found.channels:
        text.append(f"\n{texts.CHANNEL_NAMES.get(name, name)}\n", style="bold")
        for state, series in ((texts.D_BEFORE, before), (texts.D_AFTER, after)):
            largest = max((abs(value) for value in series), default=0.0) / diagnosis.scale
            bars = sparkline(series)
            text.append(f"{padded(state, 8)}{bars}  ±{largest:.1f} {diagnosis.unit}\n")
    return text.append(f"\n{blocks_text(section.candidates(diagnosis), COLUMNS)}\n")


def sparkline(values: Sequence[float]) -> str:
    """Residuals as bars about a middle: low bars negative, high bars positive."""
    largest = max((abs(value) for value in values), default=0.0)
    if largest == 0.0:
        return BARS[3] * len(values)
    top = len(BARS) - 1
    return "".join(BARS[round(0.5 * top * (1.0 + value / largest))] for value in values)
