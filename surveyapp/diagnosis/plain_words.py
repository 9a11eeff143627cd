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
from surveyapp_models.effects.effect import Effect

NOISE_AND_SHAPES = {
    "random_walk": "a north that wanders at random",
    "amplitude_walk": "a following that is irregular at random",
    "ar1": "correlated noise",
    "quadratic": "a bent drift without a known cause",
    "smooth": "a smooth change without a known cause",
    "long_oscillation": "an oscillation longer than the record can judge",
    "periodic": "an oscillation without a known cause",
    "pulse": "a shift of several readings that came and went",
    "step": "a step without a known cause",
    "amplitude_smooth": "a change of the damping without a known cause",
    "amplitude_step": "a sudden change of the amplitude without a known cause",
    "outlier": "a single determination that stands off",
}


HALF_SWINGS = "half swing"
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
    said = [_seen(result)]
    said += [_adopted(result, item, known, labels or {}) for item in result.adopted]
    if not result.adopted and result.verdict != "adequate":
        said.append("No cause is named.")
    said += _ambiguous(result, known)
    said += [_line(result, line, known) for line in result.lines]
    said += _consequence(result)
    said += _errors(result)
    said += _predicted(result)
    said += result.advice
    if result.verdict == "unattributed":
        said.append("Something is left that no known cause explains; it stays in the stated sigma.")
    said += [f"{text.rstrip('.')}." for text in result.remedy]
    said += [f"{w.text[0].upper()}{w.text[1:].rstrip('.')}." for w in result.warnings]
    return said


def words_of(result: Diagnosis, problem: Case) -> list[str]:
    """Same as ``plain_words`` with the effects and labels of a problem."""
    return plain_words(result, problem.effects, problem.grid_labels)


def _unit(result: Diagnosis) -> str:
    return '"' if result.unit == "arcsec" else f" {result.unit}"


def _small(result: Diagnosis, value: float | None) -> str:
    if value is None:
        return "unknown"
    return f"{_figure(result, value / result.scale)}{_unit(result)}"


def _figure(result: Diagnosis, value: float, sign: str = "") -> str:
    """A number: to a tenth of an arc-second, else to three figures."""
    return format(value, f"{sign}.1f" if result.unit == "arcsec" else f"{sign}.3g")


def _name(identity: str, known: dict[str, Effect]) -> str:
    parts = identity.split(" + ")
    titles = [NOISE_AND_SHAPES.get(p, known[p].title.lower() if p in known else p) for p in parts]
    return " with ".join(titles)


def _seen(result: Diagnosis) -> str:
    error = _small(result, result.before.rms)
    if any(w.code == "block_means" for w in result.warnings):
        error = f"the block means, {error},"
    if result.verdict == "adequate" and result.subject == "traverse":
        return (
            f"The misclosures, {error} on the average, are as large as the stated sigmas say: "
            "nothing that this traverse controls is missing."
        )
    if result.verdict == "adequate":
        return f"The residuals of {error} look like noise: the model that stands is adequate."
    low = min((t.p for t in result.battery), default=1.0)
    tail = ""
    if low <= 0.01:
        test = min(result.battery, key=lambda t: t.p)
        tail = f" (plainest in the {test.channel}: {test.name}, p = {test.p:.3f})"
    return f"The residuals of {error} are more than noise{tail}."


def _adopted(result: Diagnosis, item: Adoption, known: dict[str, Effect], labels: Labels) -> str:
    symptom = known[item.effect].symptom if item.effect in known else item.title
    parts = [
        f"{c.name} {c.value:.3g} {c.unit} (sigma {c.sigma or 0.0:.1g})" for c in item.coefficients
    ]
    turns = [_turning_point(name, value) for name, value, unit in item.grid if unit == HALF_SWINGS]
    if any(turns):
        where = ", ".join(text for text in turns if text)
    else:
        where = ", ".join(_place(n, v, labels) for n, v, _ in item.grid)
    place = f" at {where}" if where else ""
    margin = ""
    if item.margin_bic is not None:
        margin = f"; the next explanation is {item.margin_bic:.0f} BIC worse"
    return f"{item.title}: it looks as if {symptom}{place}: {', '.join(parts)}{margin}."


def _turning_point(name: str, value: float) -> str:
    """Where in a run, counted from 1 as everywhere that a surveyor reads it; else empty."""
    base, _, number = name.rpartition("_")
    kind = base if number.isdigit() else name
    if kind == "after_point":
        return f"turning point {value + 1.0:g} to {value + 2.0:g}"
    return f"turning point {value + 1.0:g}" if kind in ("point", "position") else ""


def _place(name: str, value: float, labels: Labels) -> str:
    """A scanned parameter in words: a line and a sight by their names, not by a number."""
    base, _, number = name.rpartition("_")
    own = labels.get(name) or (labels.get(base) if number.isdigit() else None) or {}
    return own.get(value, f"{name.replace('_', ' ')} {value:g}")


def _ambiguous(result: Diagnosis, known: dict[str, Effect]) -> list[str]:
    said = []
    for item in result.ambiguous:
        names = [_name(i, known) for i in item.any_of]
        if len(names) == 1:
            said.append(f"{names[0][0].upper()}{names[0][1:]} may be behind it, but is not proved.")
        else:
            listing = ", ".join(names[:-1]) + " or " + names[-1]
            said.append(f"From this record {listing} cannot be told apart.")
        if item.separate_by:
            said.append(f"To decide, observe: {item.separate_by}.")
    return said


def _line(result: Diagnosis, line: SpectralLine, known: dict[str, Effect]) -> str:
    """One spectral line: where, how large, how sure, whose."""
    unit = result.frequency_unit
    what = (
        f"A line at {line.frequency:.6g} {unit} (sigma {line.sigma_frequency:.1g} {unit}) with an "
        f"amplitude of {line.amplitude / result.scale:.3g}{_unit(result)} (sigma "
        f"{line.sigma_amplitude / result.scale:.1g}{_unit(result)}) stands out of the noise; noise "
        f"shows such a peak anywhere with a probability of {line.false_alarm:.1g}"
    )
    if line.effect:
        whose = f"the catalogue has it: {_name(line.effect, known)}"
    elif line.shared_with:
        whose = f"{line.shared_with.replace('_', ' ')} has it too, and it is left to that"
    else:
        whose = "no known cause is named"
    return f"{what}; {whose}."


def _value(result: Diagnosis, quantity: Estimate) -> str:
    return _small(result, quantity.sigma)


def _consequence(result: Diagnosis) -> list[str]:
    what = result.value_name
    head = f"{what[0].upper()}{what[1:]}"
    shift = (result.averaged.value - result.before.value.value) / result.scale
    sigma, before = _value(result, result.averaged), _value(result, result.before.value)
    least = 0.05
    if result.unit != "arcsec":
        least *= (result.averaged.sigma or 0.0) / result.scale
    moves = abs(shift) >= least and shift != 0.0
    moved = f"moves by {_figure(result, shift, '+')}{_unit(result)}" if moves else "stays"
    said = [f"{head} {moved}; its sigma is {sigma} instead of {before}."]
    datum = result.after_best.value_at_datum
    if datum is not None:
        for text, quantity in datum.states:
            apart = (quantity.value - result.averaged.value) / result.scale
            said.append(
                f"With {datum.effect.replace('_', ' ')} in the model: {text} "
                f"{_figure(result, apart, '+')}{_unit(result)} from the average (sigma "
                f"{_small(result, quantity.sigma)})."
            )
    return said


def _predicted(result: Diagnosis) -> list[str]:
    """Errors of what was left out in time order, before and after, with their intervals."""
    held = result.prediction
    if held is None or not held.count:
        return []

    def told(item: PredictionErrors) -> str:
        share = round((item.coverage or 0.0) * held.count)
        return (
            f"{_small(result, item.rms)}, {share} of {held.count} inside +-"
            f"{_small(result, item.interval95)}"
        )

    return [
        f"Azimuths predicted ({held.scheme}) err by {told(held.before)} with the mean, by "
        f"{told(held.after)} with the average over what may be at work."
    ]


def _errors(result: Diagnosis) -> list[str]:
    after: ModelResult = result.after_best
    if after.effects == result.before.effects:
        return []
    label = " (best member of what cannot be told apart)" if result.ambiguous else ""
    said = [
        f"Residuals {_small(result, result.before.rms)} before and {_small(result, after.rms)} "
        f"after{label}, on the data that chose the model."
    ]
    pairs = (
        ("on points left out in turn", result.before.loo_rms, after.loo_rms),
        (
            "predicting the last quarter from the rest",
            result.before.forecast_rms,
            after.forecast_rms,
        ),
        ("on the second, independent set", result.before.confirm_rms, after.confirm_rms),
    )
    for text, one, two in pairs:
        if one is not None and two is not None:
            said.append(f"{_small(result, one)} before and {_small(result, two)} after {text}.")
    return said
