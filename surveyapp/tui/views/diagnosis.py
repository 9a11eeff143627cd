"""A diagnosis as text for the screen: words first, then models, candidates and both channels."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rich.text import Text

from surveyapp.tui import texts
from surveyapp.tui.widgets.records import table_text
from surveyapp.workflows.diagnosing import Diagnosed
from surveyapp_models.angles import AngleUnit, format_angle, wrap_two_pi

SUBJECT_COLUMNS = (texts.COL_SUBJECT, texts.COL_ID, texts.COL_VERDICT)
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
            verdict = made.diagnosis.verdict.replace("_", " ")
        name = {
            "session": texts.SUBJECT_RUN,
            "campaign": texts.SUBJECT_CAMPAIGN,
            "traverse": texts.SUBJECT_TRAVERSE,
        }.get(option, option)
        rows.append((name, identity, verdict))
    return rows


def _number(value: float | None, decimals: int = 1) -> str:
    return "-" if value is None else f"{value:.{decimals}f}"


def diagnosis_view(found: Diagnosed) -> Text:
    """The whole diagnosis of one subject."""
    diagnosis = found.diagnosis
    if diagnosis is None:
        return Text(texts.NO_SUBJECTS)
    text = Text()
    for sentence in found.words:
        text.append(texts.D_SENTENCE.format(sentence=sentence))
    text.append("\n")
    text.append_text(_models(found))
    for name, before, after in found.channels:
        text.append(f"\n{texts.CHANNEL_NAMES.get(name, name)}\n", style="bold")
        for state, series in ((texts.D_BEFORE, before), (texts.D_AFTER, after)):
            largest = max((abs(value) for value in series), default=0.0) / diagnosis.scale
            bars = sparkline(series)
            text.append(f"{state:<8}{bars}  ±{largest:.1f} {diagnosis.unit}\n")
    text.append("\n")
    head = (texts.COL_CANDIDATE, texts.COL_VERDICT, "p", texts.COL_FAMILY, texts.COL_BIC)
    rows = [
        (
            item.effect,
            item.verdict.replace("_", " "),
            _number(item.p, 4),
            _number(item.p_family, 4),
            _number(item.delta_bic),
        )
        for item in diagnosis.candidates
    ]
    text.append_text(table_text([head, *rows]))
    for item in diagnosis.candidates:
        if item.reason:
            text.append(f"{item.effect}: {item.verdict.replace('_', ' ')}: {item.reason}\n")
    return text


def _models(found: Diagnosed) -> Text:
    diagnosis = found.diagnosis
    if diagnosis is None:
        return Text()
    scale = diagnosis.scale
    models = [(texts.D_BEFORE, diagnosis.before), (texts.D_AFTER, diagnosis.after)]
    if diagnosis.ambiguous:
        models.append((texts.D_BEST, diagnosis.after_best))
    rows = [("", f"rms {diagnosis.unit}", texts.D_LEFT_OUT, texts.D_VALUE, texts.COL_SIGMA)]
    for name, model in models:
        rms, left_out = (None if v is None else v / scale for v in (model.rms, model.loo_rms))
        value = _value(diagnosis.direction, model.value.value, scale)
        sigma = None if model.value.sigma is None else model.value.sigma / scale
        rows.append((name, _number(rms), _number(left_out), value, _number(sigma)))
    averaged = diagnosis.averaged
    sigma = None if averaged.sigma is None else averaged.sigma / scale
    value = _value(diagnosis.direction, averaged.value, scale)
    rows.append((texts.D_AVERAGED, "", "", value, _number(sigma)))
    return table_text(rows)


def _value(direction: bool, value: float, scale: float) -> str:
    if direction:
        return format_angle(wrap_two_pi(value), AngleUnit.DMS)
    return f"{value / scale:+.2f}"


def sparkline(values: Sequence[float]) -> str:
    """Residuals as bars about a middle: low bars negative, high bars positive."""
    largest = max((abs(value) for value in values), default=0.0)
    if largest == 0.0:
        return BARS[3] * len(values)
    top = len(BARS) - 1
    return "".join(BARS[round(0.5 * top * (1.0 + value / largest))] for value in values)
