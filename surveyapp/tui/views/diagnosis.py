"""A diagnosis on the screen: the blocks of the record, its figures drawn as bars."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from surveyapp.languages import term
from surveyapp.report.blocks import Block, Heading, Paragraph, Table
from surveyapp.report.numbers import plain
from surveyapp.report.sections import diagnosis as section
from surveyapp.tui import texts
from surveyapp.workflows.diagnosing import Diagnosed
from surveyapp_models.angles import AngleUnit

BARS = "▁▂▃▄▅▆▇█"

__all__ = ["Diagnosed", "diagnosis_blocks", "sparkline", "subject_table"]


def subject_table(subjects: Sequence[tuple[str, str]], found: Mapping[int, Diagnosed]) -> Table:
    """One row a subject, with its verdict as a word."""
    names = {
        "session": texts.SUBJECT_RUN,
        "campaign": texts.SUBJECT_CAMPAIGN,
        "traverse": texts.SUBJECT_TRAVERSE,
    }
    rows = []
    for place, (option, identity) in enumerate(subjects):
        made = found.get(place)
        verdict = ""
        if made is not None and made.diagnosis is not None:
            verdict = term(made.diagnosis.verdict.replace("_", " "))
        rows.append((names.get(option, option), identity, verdict))
    return Table((texts.COL_SUBJECT, texts.COL_ID, texts.COL_VERDICT), tuple(rows))


def diagnosis_blocks(found: Diagnosed, unit: AngleUnit = AngleUnit.DMS) -> tuple[Block, ...]:
    """The whole diagnosis of one subject."""
    diagnosis = found.diagnosis
    if diagnosis is None:
        return tuple(Paragraph(text) for text in found.words) or (Paragraph(texts.NO_SUBJECTS),)
    made: list[Block] = [*section.told(diagnosis, found.words), section.models(diagnosis, unit)]
    for name, before, after in found.channels:
        rows = []
        for state, series in ((texts.D_BEFORE, before), (texts.D_AFTER, after)):
            largest = max((abs(value) for value in series), default=0.0) / diagnosis.scale
            rows.append((state, sparkline(series), f"±{plain(largest)} {diagnosis.unit}"))
        title = section.CHANNEL_NAMES.get(name, name)
        made += [Heading(title, 2), Table(("", "", ""), tuple(rows))]
    return (*made, *section.candidates(diagnosis))


def sparkline(values: Sequence[float]) -> str:
    """Residuals as bars about a middle: low bars negative, high bars positive."""
    largest = max((abs(value) for value in values), default=0.0)
    if largest == 0.0:
        return BARS[3] * len(values)
    top = len(BARS) - 1
    return "".join(BARS[round(0.5 * top * (1.0 + value / largest))] for value in values)
