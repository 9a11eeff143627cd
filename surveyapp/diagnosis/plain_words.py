"""The diagnosis told to a surveyor: what was seen, what it does to the result, what to observe.

Plain sentences made of the result alone; the command line, the report and the screen print them as
they are. No arithmetic beyond units.
"""

from __future__ import annotations

from collections.abc import Mapping

from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.long_records.lines import SpectralLine
from surveyapp.diagnosis.outlook import PredictionErrors
from surveyapp.diagnosis.result import Adoption, Diagnosis, Estimate, ModelResult
from surveyapp.languages import either, joined, said, sentence, term
from surveyapp.languages.names import by_id, named, spoken
from surveyapp_models.effects.effect import Effect

NOISE_AND_SHAPES = {
    "random_walk": said("a north that wanders at random"),
    "amplitude_walk": said("a following that is irregular at random"),
    "ar1": said("correlated noise"),
    "quadratic": said("a bent drift without a known cause"),
    "smooth": said("a smooth change without a known cause"),
    "long_oscillation": said("an oscillation longer than the record can judge"),
    "periodic": said("an oscillation without a known cause"),
    "pulse": said("a shift of several readings that came and went"),
    "step": said("a step without a known cause"),
    "amplitude_smooth": said("a change of the damping without a known cause"),
    "amplitude_step": said("a sudden change of the amplitude without a known cause"),
    "outlier": said("a single determination that stands off"),
}


CHANNELS = {
    "amplitude": spoken("amplitude", said("amplitude channel")),
    "midpoint": spoken("midpoint", said("midpoint channel")),
    "residual": spoken("residual", said("residuals")),
}
HALF_SWINGS = said("half swing")
"""Unit of places in a run: half swings since the first turning point."""
Labels = Mapping[str, Mapping[float, str]]


def plain_words(
    result: Diagnosis, effects: tuple[Effect, ...], labels: Labels | None = None
) -> list[str]:
    """Tell a diagnosis in plain sentences.

    Parameters
    ----------
    result : Diagnosis
    effects : tuple of Effect
        Those of the problem (``problem.effects``), for their titles and symptoms.
    labels : mapping, optional
        Names behind the numbers of scanned parameters (``problem.grid_labels``).

    Returns
    -------
    list of str
        One sentence each, small values in the unit of the subject.
    """
    known = {effect.id: effect for effect in effects}
    sentences = [_seen(result)]
    sentences += [_adopted(result, item, known, labels or {}) for item in result.adopted]
    if not result.adopted and result.verdict != "adequate":
        sentences.append(said("No cause is named."))
    sentences += _ambiguous(result, known)
    sentences += [_line(result, line, known) for line in result.lines]
    sentences += _consequence(result)
    sentences += _errors(result)
    sentences += _predicted(result)
    sentences += result.advice
    if result.verdict == "unattributed":
        sentences.append(
            said("Something is left that no known cause explains; it stays in the stated sigma.")
        )
    sentences += [sentence(text) for text in result.remedy]
    sentences += [sentence(w.text) for w in result.warnings]
    return sentences


def words_of(result: Diagnosis, problem: Case) -> list[str]:
    """Same as ``plain_words`` with the effects and labels of a problem."""
    return plain_words(result, problem.effects, problem.grid_labels)


def _unit(result: Diagnosis) -> str:
    return '"' if result.unit == "arcsec" else joined("", (" ", term(result.unit)))


def _small(result: Diagnosis, value: float | None) -> str:
    if value is None:
        return said("unknown")
    return joined("", (_figure(result, value / result.scale), _unit(result)))


def _figure(result: Diagnosis, value: float, sign: str = "") -> str:
    """A number: to a tenth of an arc-second, else to three figures."""
    return format(value, f"{sign}.1f" if result.unit == "arcsec" else f"{sign}.3g")


def _name(identity: str, known: dict[str, Effect]) -> str:
    parts = identity.split(" + ")
    shapes = NOISE_AND_SHAPES
    if any(effect.subject == "rate" for effect in known.values()):
        shapes = {**shapes, "random_walk": said("a bias that wanders at random")}
    titles = [
        shapes.get(part, term(known[part].title.lower()) if part in known else by_id(part))
        for part in parts
    ]
    whole = titles[0]
    for title in titles[1:]:
        whole = said("{whole} with {title}", whole=whole, title=title)
    return whole


def _seen(result: Diagnosis) -> str:
    error = _small(result, result.before.rms)
    if any(w.code == "block_means" for w in result.warnings):
        error = said("the block means, {error},", error=error)
    if result.verdict == "adequate" and result.subject == "traverse":
        return said(
            "The misclosures, {error} on the average, are as large as the stated "
            "sigmas say: nothing that this traverse controls is missing.",
            error=error,
        )
    if result.verdict == "adequate":
        return said(
            "The residuals of {error} look like noise: the model that stands is adequate.",
            error=error,
        )
    low = min((t.p for t in result.battery), default=1.0)
    tail = ""
    if low <= 0.01:
        test = min(result.battery, key=lambda t: t.p)
        tail = said(
            " (plainest in the {channel}: {name}, p = {p:.3f})",
            channel=CHANNELS.get(test.channel, term(test.channel)),
            name=term(test.name),
            p=test.p,
        )
    return said("The residuals of {error} are more than noise{tail}.", error=error, tail=tail)


def _adopted(result: Diagnosis, item: Adoption, known: dict[str, Effect], labels: Labels) -> str:
    usual = known[item.effect].symptom if item.effect in known else item.title
    symptom = item.symptom or usual
    parts = [
        said(
            "{name} {value:.3g} {unit} (sigma {sigma:.1g})",
            name=by_id(c.name),
            value=c.value,
            unit=term(c.unit),
            sigma=c.sigma or 0.0,
        )
        for c in item.coefficients
    ]
    turns = [_turning_point(name, value) for name, value, unit in item.grid if unit == HALF_SWINGS]
    if any(turns):
        where = joined(", ", [text for text in turns if text])
    else:
        where = joined(", ", [_place(n, v, labels) for n, v, _ in item.grid])
    place = said(" at {where}", where=where) if where else ""
    margin = ""
    if item.margin_bic is not None:
        margin = said(
            "; the next explanation is {margin_bic:.0f} BIC worse", margin_bic=item.margin_bic
        )
    return said(
        "{title}: it looks as if {symptom}{place}: {parts}{margin}.",
        title=term(item.title),
        symptom=term(symptom),
        place=place,
        parts=joined(", ", parts),
        margin=margin,
    )


def _turning_point(name: str, value: float) -> str:
    """Where in a run, counted from 1 as everywhere that a surveyor reads it; else empty."""
    base, _, number = name.rpartition("_")
    kind = base if number.isdigit() else name
    if kind == "after_point":
        return said("turning point {value:g} to {value2:g}", value=value + 1.0, value2=value + 2.0)
    return (
        said("turning point {value:g}", value=value + 1.0) if kind in ("point", "position") else ""
    )


def _place(name: str, value: float, labels: Labels) -> str:
    """A scanned parameter in words: a line and a sight by their names, not by a number."""
    base, _, number = name.rpartition("_")
    own = labels.get(name) or (labels.get(base) if number.isdigit() else None) or {}
    return own.get(value) or joined(" ", (named(name), f"{value:g}"))


def _ambiguous(result: Diagnosis, known: dict[str, Effect]) -> list[str]:
    sentences = []
    for item in result.ambiguous:
        names = [_name(i, known) for i in item.any_of]
        if len(names) == 1:
            sentences.append(
                sentence(said("{name} may be behind it, but is not proved.", name=names[0]))
            )
        else:
            listing = either(names)
            sentences.append(
                said("From this record {listing} cannot be told apart.", listing=listing)
            )
        if item.separate_by:
            sentences.append(
                said("To decide, observe: {separate_by}.", separate_by=term(item.separate_by))
            )
    return sentences


def _line(result: Diagnosis, line: SpectralLine, known: dict[str, Effect]) -> str:
    """One spectral line: where, how large, how sure, whose."""
    unit = result.frequency_unit
    what = said(
        "A line at {frequency:.6g} {unit} (sigma {sigma_frequency:.1g} {unit}) "
        "with an amplitude of {amplitude:.3g}{result} (sigma "
        "{sigma_amplitude:.1g}{result}) stands out of the noise; noise shows such "
        "a peak anywhere with a probability of {false_alarm:.1g}",
        frequency=line.frequency,
        unit=unit,
        sigma_frequency=line.sigma_frequency,
        amplitude=line.amplitude / result.scale,
        result=_unit(result),
        sigma_amplitude=line.sigma_amplitude / result.scale,
        false_alarm=line.false_alarm,
    )
    if line.effect:
        whose = said("the catalogue has it: {effect}", effect=_name(line.effect, known))
    elif line.shared_with:
        whose = said(
            "{replace} has it too, and it is left to that",
            replace=named(line.shared_with),
        )
    else:
        whose = said("no known cause is named")
    return said("{what}; {whose}.", what=what, whose=whose)


def _value(result: Diagnosis, quantity: Estimate) -> str:
    return _small(result, quantity.sigma)


def _consequence(result: Diagnosis) -> list[str]:
    shift = (result.averaged.value - result.before.value.value) / result.scale
    sigma, before = _value(result, result.averaged), _value(result, result.before.value)
    least = 0.05
    if result.unit != "arcsec":
        least *= (result.averaged.sigma or 0.0) / result.scale
    moves = abs(shift) >= least and shift != 0.0
    moved = (
        said(
            "moves by {result}{result2}", result=_figure(result, shift, "+"), result2=_unit(result)
        )
        if moves
        else said("stays")
    )
    sentences = [
        sentence(
            said(
                "{what} {moved}; its sigma is {sigma} instead of {before}.",
                what=term(result.value_name),
                moved=moved,
                sigma=sigma,
                before=before,
            )
        )
    ]
    datum = result.after_best.value_at_datum
    if datum is not None:
        for text, quantity in datum.states:
            apart = (quantity.value - result.averaged.value) / result.scale
            sentences.append(
                said(
                    "With {effect} in the model: {text} {apart}{unit} from the average (sigma "
                    "{sigma}).",
                    effect=named(datum.effect),
                    text=_state(text),
                    apart=_figure(result, apart, "+"),
                    unit=_unit(result),
                    sigma=_small(result, quantity.sigma),
                )
            )
    return sentences


def _state(text: str) -> str:
    """A state of ``value_at_datum`` in words."""
    value, _, unit = text.partition(" degrees Celsius")
    if value != text and not unit:
        return said("{value} degrees Celsius", value=value)
    return term(text)


def _predicted(result: Diagnosis) -> list[str]:
    """Errors of what was left out in time order, before and after, with their intervals."""
    held = result.prediction
    if held is None or not held.count:
        return []

    def told(item: PredictionErrors) -> str:
        share = round((item.coverage or 0.0) * held.count)
        return said(
            "{result}, {share} of {count} inside +-{result2}",
            result=_small(result, item.rms),
            share=share,
            count=held.count,
            result2=_small(result, item.interval95),
        )

    return [
        said(
            "Azimuths predicted ({scheme}) err by {before} with the mean, by {after} "
            "with the average over what may be at work.",
            scheme=held.scheme,
            before=told(held.before),
            after=told(held.after),
        )
    ]


def _errors(result: Diagnosis) -> list[str]:
    after: ModelResult = result.after_best
    if after.effects == result.before.effects:
        return []
    label = said(" (best member of what cannot be told apart)") if result.ambiguous else ""
    sentences = [
        said(
            "Residuals {result} before and {result2} after{label}, on the data that "
            "chose the model.",
            result=_small(result, result.before.rms),
            result2=_small(result, after.rms),
            label=label,
        )
    ]
    pairs = (
        (said("on points left out in turn"), result.before.loo_rms, after.loo_rms),
        (
            said("predicting the last quarter from the rest"),
            result.before.forecast_rms,
            after.forecast_rms,
        ),
        (said("on the second, independent set"), result.before.confirm_rms, after.confirm_rms),
    )
    for text, one, two in pairs:
        if one is not None and two is not None:
            sentences.append(
                said(
                    "{result} before and {result2} after {text}.",
                    result=_small(result, one),
                    result2=_small(result, two),
                    text=text,
                )
            )
    return sentences
