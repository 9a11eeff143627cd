"""What a diagnosis found: in words, the residuals in their channels, the candidates, the proof."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from surveyapp.diagnosis.result import Diagnosis, Estimate, ModelResult
from surveyapp.languages import joined, said, said_each, term
from surveyapp.languages.names import by_id, ids
from surveyapp.report.blocks import Block, Figure, Heading, Paragraph, Table
from surveyapp.report.numbers import plain
from surveyapp.report.plots import Frame, axis
from surveyapp_models.angles import AngleUnit, format_angle, wrap_two_pi

CHANNEL_NAMES = {
    "amplitude": said("amplitude channel (side times residual)"),
    "midpoint": said("midpoint channel (Schuler mean of the residuals)"),
    "residual": said("residuals"),
}


def blocks(
    diagnosis: Diagnosis,
    words: Sequence[str],
    channels: Mapping[str, tuple[Sequence[float], Sequence[float]]],
    *,
    unit: AngleUnit,
) -> tuple[Block, ...]:
    """Blocks of one diagnosis.

    Parameters
    ----------
    diagnosis : Diagnosis
    words : sequence of str
        The diagnosis in plain sentences.
    channels : mapping
        Channel to its residuals before and after, in SI units.
    unit : AngleUnit
        Of the project, for directions.
    """
    found: list[Block] = [*told(diagnosis, words), models(diagnosis, unit)]
    for name, (before, after) in channels.items():
        found += _figures(diagnosis, name, before, after)
    return (*found, *candidates(diagnosis))


def told(diagnosis: Diagnosis, words: Sequence[str]) -> tuple[Block, ...]:
    """Verdict and words of a diagnosis."""
    verdict = term(diagnosis.verdict.replace("_", " "))
    heading = Heading(
        said("Diagnosis of {heading}: {verdict}", heading=diagnosis.heading, verdict=verdict)
    )
    return (heading, *(Paragraph(text) for text in words))


def candidates(diagnosis: Diagnosis) -> tuple[Block, ...]:
    """What was tried and why it was not taken, spectral lines, what cannot be told apart."""
    found: list[Block] = []
    if diagnosis.candidates:
        found.append(_candidates(diagnosis))
    reasons: dict[tuple[str, str], list[str]] = {}
    for item in diagnosis.candidates:
        if item.reason:
            key = (item.verdict.replace("_", " "), item.reason)
            reasons.setdefault(key, []).append(item.effect)
    found += [
        Paragraph(joined(": ", (term(verdict), ids(names), reason)), "small")
        for (verdict, reason), names in reasons.items()
    ]
    if diagnosis.lines:
        found += [Heading(said("Spectral lines"), 2), _lines(diagnosis)]
    if diagnosis.ambiguous:
        found += [Heading(said("Not separable"), 2), _ambiguous(diagnosis)]
    return tuple(found)


def value_text(diagnosis: Diagnosis, quantity: Estimate, unit: AngleUnit) -> str:
    """A value with its sigma, a direction in the project's unit."""
    sigma = None if quantity.sigma is None else quantity.sigma / diagnosis.scale
    if diagnosis.direction:
        return (
            f"{format_angle(wrap_two_pi(quantity.value), unit)} \N{PLUS-MINUS SIGN}{plain(sigma)}"
        )
    value = quantity.value / diagnosis.scale
    if diagnosis.unit != "arcsec":
        return f"{value:+.4g} \N{PLUS-MINUS SIGN}{_figure(diagnosis, sigma)}"
    return f"{plain(value, 2, sign=True)} \N{PLUS-MINUS SIGN}{plain(sigma)}"


def _figure(diagnosis: Diagnosis, value: float | None) -> str:
    """To a tenth of an arc-second; in another unit, whose size nobody knows, three figures."""
    if value is None or diagnosis.unit == "arcsec":
        return plain(value)
    return f"{value:.3g}"


def models(diagnosis: Diagnosis, unit: AngleUnit) -> Table:
    """Before, after, and averaged over the models."""

    def small(value: float | None) -> str:
        return _figure(diagnosis, None if value is None else value / diagnosis.scale)

    def row(name: str, model: ModelResult) -> tuple[str, ...]:
        return (
            name,
            joined(" + ", map(by_id, model.effects)) or said("base model"),
            plain(model.parameters, 0),
            small(model.rms),
            small(model.loo_rms),
            small(model.confirm_rms),
            value_text(diagnosis, model.value, unit),
        )

    rows = [row(said("before"), diagnosis.before), row(said("after"), diagnosis.after)]
    if diagnosis.ambiguous:
        rows.append(row(said("after, best member"), diagnosis.after_best))
    averaged = value_text(diagnosis, diagnosis.averaged, unit)
    rows.append((said("averaged over models"), "", "", "", "", "", averaged))
    head = (
        said("model"),
        said("effects"),
        said("param."),
        said("rms {unit}", unit=term(diagnosis.unit)),
        said("left out"),
        said("second set"),
        said("value and sigma"),
    )
    return Table(head, tuple(rows), align="llrrrrr", strong=frozenset({len(rows) - 1}))


def _figures(
    diagnosis: Diagnosis, name: str, before: Sequence[float], after: Sequence[float]
) -> list[Figure]:
    title = CHANNEL_NAMES.get(name, name)
    figures = []
    for state, series in ((said("before"), before), (said("after"), after)):
        points = [(float(i + 1), value / diagnosis.scale) for i, value in enumerate(series)]
        if len(points) < 2:
            continue
        frame = Frame(
            axis([x for x, _ in points], count=10, whole=True),
            axis([y for _, y in points], about_zero=True),
            height_mm=40.0,
        )
        parts = frame.axes(said("observation"), term(diagnosis.unit))
        parts.append(frame.level(0.0, "axis"))
        for x, y in points:
            parts += frame.bar(x, low=min(0.0, y), high=max(0.0, y))
        parts += frame.marks(points, "dot")
        figures.append(frame.figure(joined(", ", (title, state)), parts))
    return figures


def _candidates(diagnosis: Diagnosis) -> Table:
    rows = tuple(
        (
            by_id(item.effect),
            term(item.verdict.replace("_", " ")),
            plain(item.p, 4),
            plain(item.p_family, 4),
            plain(item.delta_bic, 1),
        )
        for item in diagnosis.candidates
    )
    return Table(
        said_each("candidate", "verdict", "p", "p of the family", "BIC behind the best"),
        rows,
        align="llrrr",
        strong=frozenset(
            i for i, item in enumerate(diagnosis.candidates) if item.verdict == "adopted"
        ),
    )


def _lines(diagnosis: Diagnosis) -> Table:
    rows = tuple(
        (
            f"{line.frequency:.6g}",
            f"{line.sigma_frequency:.1g}",
            f"{line.amplitude / diagnosis.scale:.3g}",
            f"{line.sigma_amplitude / diagnosis.scale:.1g}",
            f"{line.false_alarm:.1g}",
            by_id(line.effect)
            or (
                said("left to {shared_with}", shared_with=by_id(line.shared_with))
                if line.shared_with
                else said("unattributed")
            ),
        )
        for line in diagnosis.lines
    )
    head = (
        said("frequency {frequency_unit}", frequency_unit=diagnosis.frequency_unit),
        said("sigma"),
        said("amplitude {unit}", unit=term(diagnosis.unit)),
        said("sigma"),
        said("false alarm"),
        said("cause"),
    )
    return Table(head, rows, align="rrrrrl")


def _ambiguous(diagnosis: Diagnosis) -> Table:
    rows = tuple(
        (
            ids(item.any_of),
            ", ".join(plain(value, 1) for value in item.delta_bic),
            term(item.separate_by),
        )
        for item in diagnosis.ambiguous
    )
    return Table(said_each("any of", "BIC apart", "what would separate them"), rows)
