"""The constant of each line at its own time, temperature, latitude, circle and place.

The determinations of an instrument and the circumstances of its survey sessions are put before the
average over the base model and its rivals (``core/prediction``); what comes back is a constant with
its contributions: what determinations share, their scatter, and what not knowing the cause adds.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from surveyapp.core.orientation.campaign_columns import Circumstances, columns_of
from surveyapp.core.orientation.instrument_constant import Calibration, InstrumentConstant
from surveyapp.core.prediction.average import Determinations, Predicted, predict
from surveyapp.core.statistics.distributions import student_quantile
from surveyapp.core.statistics.repeated import SHARED, RunScatter
from surveyapp.core.uncertain import Source, Spread, Uncertain
from surveyapp.domain.priors import DEFAULT_PRIORS, Priors
from surveyapp.domain.project import ResultWarning
from surveyapp_models.angles import RHO_ARCSEC, wrap_pi
from surveyapp_models.arrays import Floats

LEAST = 4
"""Determinations from which the constant is predicted."""
MOST = 240
"""The latest determinations that are used: older ones tell of another instrument."""
CAUSE = "constant: cause not known"
SCATTER = "constant: scatter of the determinations"
BESIDE = ("run-to-run scatter", "adopted effect outside its range")
"""Contributions that the prediction estimates itself, from the scatter and its causes."""
UNIT_OF_EFFECT: Mapping[str, str] = {
    "temperature": "temperature",
    "latitude": "latitude",
    "time_drift": "drift",
    "transport_step": "step",
    "circle_eccentricity": "circle",
    "line_offset": "line",
    "gyro_block": "day",
    "warm_up": "warm_up",
}
"""A named effect is taken out of the azimuths and out of the average."""
SCENARIOS = (-1.2816, -0.5244, 0.0, 0.5244, 1.2816)
"""Equally likely states of what a later visit does not tell, in standard deviations."""
LEAST_TEMPERATURE_K = 5.0
"""Standard deviation of a temperature that nobody read, at least."""
ONE_TEMPERATURE_K = 3.0
"""Beyond the range of the determinations, from which an extrapolation is told."""


@dataclass(frozen=True, slots=True)
class Wanted:
    """A line whose constant is wanted: sessions with their weights.

    Parameters
    ----------
    name : str
        For messages.
    visits : tuple of (float, Circumstances)
        Weight (sum 1) and circumstances of each session.
    """

    name: str
    visits: tuple[tuple[float, Circumstances], ...]


@dataclass(frozen=True, slots=True)
class PredictedConstants:
    """Constants of the lines of one instrument.

    Parameters
    ----------
    average : Uncertain
        The constant averaged over the campaign.
    lines : tuple of Uncertain
        One for each line that was wanted.
    causes : mapping of unit to float
        Weight of each cause in the average.
    scatter : RunScatter
        What every run has beside its stated sigma once the causes are accounted for.
    warnings : tuple of ResultWarning
    """

    average: Uncertain
    lines: tuple[Uncertain, ...]
    causes: Mapping[str, float]
    scatter: RunScatter
    warnings: tuple[ResultWarning, ...]


def predictable(constant: InstrumentConstant) -> bool:
    """Whether there are enough determinations to predict from."""
    return len(constant.calibrations) >= LEAST


def predict_constants(
    constant: InstrumentConstant,
    facts: Mapping[tuple[str, str], Circumstances],
    wanted: Sequence[Wanted],
    priors: Priors = DEFAULT_PRIORS,
) -> PredictedConstants:
    """Predict the constant of every wanted line and its average over the campaign.

    Parameters
    ----------
    constant : InstrumentConstant
        With at least ``LEAST`` calibrations.
    facts : mapping of (session, target) to Circumstances
        Of the calibrations.
    wanted : sequence of Wanted
    priors : Priors
    """
    used = _latest(constant.calibrations, facts)
    circumstances = [facts[item.session, item.target] for item in used]
    n = len(used)
    owns = [_own(item) for item in used]
    sigmas = np.array([own.sigma for own in owns])
    stated = bool(np.all(np.isfinite(sigmas) & (sigmas > 0.0)))
    sources, carried = _shared(used)
    visits = [visit for line in wanted for _, visit in line.visits]
    columns, gaps, warnings = _columns(constant.instrument.id, circumstances, visits)
    targets = _targets(wanted, n, sigmas if stated else None)
    columns, targets, states = _scenarios(columns, targets, gaps, n)
    first = used[0].value.value
    values = np.array([first + wrap_pi(item.value.value - first) for item in used])
    named = frozenset(
        UNIT_OF_EFFECT[e.id] for e in constant.instrument.effects if e.id in UNIT_OF_EFFECT
    )
    found = predict(
        Determinations(values, sigmas if stated else None, columns, targets, carried, states),
        priors.without(named),
    )
    constants = _uncertain(constant.instrument.id, found, sources)
    warnings += _told(constant.instrument.id, wanted, circumstances, gaps)
    scatter = RunScatter(found.excess if stated else 0.0, round(found.dof), None)
    return PredictedConstants(constants[0], constants[1:], found.weights, scatter, tuple(warnings))


def _latest(
    calibrations: Sequence[Calibration], facts: Mapping[tuple[str, str], Circumstances]
) -> list[Calibration]:
    """The latest determinations, all of them where nobody knows when they were made."""
    days = [facts[item.session, item.target].elapsed_days for item in calibrations]
    if len(calibrations) <= MOST or any(day is None for day in days):
        return list(calibrations)[-MOST:]
    order = np.argsort(np.array(days, dtype=np.float64), kind="stable")[-MOST:]
    return [calibrations[i] for i in sorted(order.tolist())]


def _own(item: Calibration) -> Uncertain:
    return item.value.without(*SHARED, *BESIDE)


def _shared(used: Sequence[Calibration]) -> tuple[list[Source], Floats]:
    """Contributions that determinations share with each other and with the lines, (n, r)."""
    parts = [item.value.only(*SHARED).parts for item in used]
    sources = list(dict.fromkeys(source for own in parts for source in own))
    table = [[own.get(source, 0.0) for source in sources] for own in parts]
    return sources, np.array(table, dtype=np.float64).reshape(len(used), len(sources))


def _targets(wanted: Sequence[Wanted], n: int, sigmas: Floats | None) -> Floats:
    """Weights of the wanted constants: first the mean over the campaign, then each line."""
    count = sum(len(line.visits) for line in wanted)
    targets = np.zeros((1 + len(wanted), n + count))
    weights = np.ones(n) if sigmas is None else sigmas**-2
    targets[0, :n] = weights / weights.sum()
    place = n
    for row, line in enumerate(wanted, start=1):
        for weight, _ in line.visits:
            targets[row, place] = weight
            place += 1
    return targets


def _columns(
    instrument: str, known: Sequence[Circumstances], visits: Sequence[Circumstances]
) -> tuple[dict[str, Floats], frozenset[str], list[ResultWarning]]:
    """Columns of determinations and visits, those with gaps at visits, and what is told of it.

    A number that some determinations lack is their mean there; what most of them lack is left out.
    """
    columns = columns_of([*known, *visits])
    n = len(known)
    kept: dict[str, Floats] = {}
    warnings = []
    for name, values in columns.items():
        missing = ~np.isfinite(values[:n])
        if not missing.any():
            kept[name] = values
        elif 2 * int(missing.sum()) < n and name in ("temperature_c", "running_s"):
            mean = float(values[:n][~missing].mean())
            kept[name] = np.concatenate([np.where(missing, mean, values[:n]), values[n:]])
            text = (
                f"instrument {instrument}: {name} is missing at {int(missing.sum())} of {n} "
                "determinations: the mean of the others stands for it in the prediction"
            )
            warnings.append(ResultWarning("covariate_missing", text))
    if "elapsed_days" not in kept:
        kept["elapsed_days"] = np.concatenate([np.arange(n), np.full(len(visits), float(n))])
        text = (
            f"instrument {instrument}: neither dates nor order: the prediction takes the "
            "determinations in the order of the file and the lines after them"
        )
        warnings.append(ResultWarning("no_dates", text))
    gaps = frozenset(name for name, values in kept.items() if np.isnan(values).any())
    return kept, gaps, warnings


def _scenarios(
    columns: dict[str, Floats], targets: Floats, gaps: frozenset[str], n: int
) -> tuple[dict[str, Floats], Floats, int]:
    """Fill what visits do not tell with equally likely states, each target once in each."""
    if not gaps:
        return columns, targets, 1
    later = targets.shape[1] - n
    count = len(SCENARIOS)
    wide = {}
    for rank, (name, values) in enumerate(columns.items()):
        rows = [values[:n]]
        for k in range(count):
            visit = values[n:]
            if name in gaps:
                # neighbouring columns run through their states in different orders
                state = SCENARIOS[(k * (rank % (count - 1) + 1)) % count]
                visit = np.where(np.isnan(visit), _state(name, values[:n], state), visit)
            rows.append(visit)
        wide[name] = np.concatenate(rows)
    big = np.zeros((count * targets.shape[0], n + count * later))
    for k in range(count):
        rows_of = slice(k * targets.shape[0], (k + 1) * targets.shape[0])
        big[rows_of, :n] = targets[:, :n]
        big[rows_of, n + k * later : n + (k + 1) * later] = targets[:, n:]
    return wide, big, count


def _state(name: str, known: Floats, z: float) -> float:
    """One of the equally likely values of a column that a visit does not tell."""
    mean, spread = float(known.mean()), float(known.std())
    if name == "temperature_c":
        spread = max(spread, LEAST_TEMPERATURE_K)
    if name == "elapsed_days":
        # within the campaign or one more span of it
        return float(known.max()) + z * float(np.ptp(known))
    return mean + z * spread


def _uncertain(
    instrument: str, found: Predicted, sources: Sequence[Source]
) -> tuple[Uncertain, ...]:
    """Predicted values with their contributions.

    The part of the cause is such that the 95 % interval is that of the mixture: a standard
    deviation of rare large errors would say more than two thirds of the lines will see. Lines share
    it as far as the average says so.
    """
    quantile = student_quantile(0.975, found.dof)
    wanted = []
    for t, mixture in enumerate(found.mixtures):
        half = found.half_width(t) / quantile
        total = mixture.variance
        cause = max(half**2 - float(found.readings[t]) ** 2, 0.0)
        wanted.append(math.sqrt(cause / total) if total > 0.0 else 0.0)
    factor = np.array(wanted)
    values, vectors = np.linalg.eigh(found.causes * factor[:, None] * factor[None, :])
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    result = []
    for t, value in enumerate(found.values):
        parts = {
            source: float(part) for source, part in zip(sources, found.carried[t], strict=True)
        }
        parts[Source(SCATTER, instrument, found.dof)] = float(found.readings[t])
        for k, part in enumerate(root[t]):
            if part != 0.0:
                parts[Source(CAUSE, instrument, found.dof, str(k))] = float(part)
        kept = {source: part for source, part in parts.items() if part != 0.0}
        result.append(Uncertain(float(value), kept, Spread(CAUSE, found.mixtures[t])))
    return tuple(result)


def _told(
    instrument: str,
    wanted: Sequence[Wanted],
    known: Sequence[Circumstances],
    gaps: frozenset[str],
) -> list[ResultWarning]:
    """What the reader of a predicted constant must know."""
    warnings = []
    for line in wanted:
        missing = sorted(
            name for name in gaps if any(_lacks(visit, name) for _, visit in line.visits)
        )
        if missing:
            text = (
                f"line {line.name}: {', '.join(missing)} not told: the constant is predicted for "
                "all that it may have been, and its interval is wider for it"
            )
            warnings.append(ResultWarning("covariate_missing", text))
        beyond = _beyond(line, known)
        if beyond:
            text = (
                f"line {line.name}: {' and '.join(beyond)}: the constant of {instrument} is "
                "extrapolated, and its interval is wider for it"
            )
            warnings.append(ResultWarning("prediction_extrapolated", text))
    days = {item.block for item in known}
    if len(known) > 1 and len(days) == 1 and known[0].elapsed_days is not None and wanted:
        text = (
            f"instrument {instrument}: all determinations were made in one block of work: "
            "what changes from day to day is not seen in them"
        )
        warnings.append(ResultWarning("one_block", text))
    return warnings


def _lacks(visit: Circumstances, name: str) -> bool:
    value = getattr(visit, name, None)
    if name == "elapsed_days" and value is None:
        value = visit.order
    return value is None


def _beyond(line: Wanted, known: Sequence[Circumstances]) -> list[str]:
    """In what a line lies outside the circumstances of the determinations."""
    found = []
    thetas = [item.temperature_c for item in known if item.temperature_c is not None]
    own = [visit.temperature_c for _, visit in line.visits if visit.temperature_c is not None]
    if thetas and own:
        low, high = min(thetas) - ONE_TEMPERATURE_K, max(thetas) + ONE_TEMPERATURE_K
        far = max(own, key=lambda theta: max(low - theta, theta - high))
        if not low <= far <= high:
            found.append(
                f"its temperature of {far:.1f} C lies outside the {min(thetas):.1f} to "
                f"{max(thetas):.1f} C of the determinations"
            )
    days = [item.elapsed_days for item in known if item.elapsed_days is not None]
    visits = [visit.elapsed_days for _, visit in line.visits if visit.elapsed_days is not None]
    if len(days) == len(known) and visits:
        span = max(days) - min(days)
        gap = max(max(visits) - max(days), min(days) - min(visits))
        if gap > max(span, 1.0):
            found.append(
                f"it was observed {gap:.0f} days from the nearest determination, and they span "
                f"{span:.0f} days"
            )
    return found


def leaves_out(choice: str, chosen: Uncertain, predicted: Uncertain, where: str) -> ResultWarning:
    """What another choice of the constant leaves out, beside the prediction."""
    text = (
        f"{where}: constant_choice {choice} leaves out that the constant may have changed with "
        f'time, temperature or place: it says {chosen.value * RHO_ARCSEC:.1f}" +- '
        f'{chosen.interval95 * RHO_ARCSEC:.1f}", the average over what may be at work '
        f'{predicted.value * RHO_ARCSEC:.1f}" +- {predicted.interval95 * RHO_ARCSEC:.1f}" (95 %)'
    )
    return ResultWarning("choice_leaves_out", text)
