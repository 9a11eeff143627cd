"""The constant of each line at its own time, temperature, latitude, circle and place.

The determinations of an instrument and the circumstances of its survey sessions are put before the
average over the base model and its rivals (``core/prediction``); what comes back is a constant with
its contributions: what determinations share, their scatter, and what not knowing the cause adds.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from surveyapp.core.orientation.campaign_columns import BY_NAME
from surveyapp.core.orientation.circumstances import Circumstances, columns_of
from surveyapp.core.orientation.far_dates import drift_notes, if_drifting
from surveyapp.core.orientation.instrument_constant import (
    LEAST_PREDICTED,
    Calibration,
    InstrumentConstant,
)
from surveyapp.core.orientation.prediction_notes import Wanted, counted_in, one_block, told_of
from surveyapp.core.orientation.set_ups import one_a_set_up
from surveyapp.core.prediction.average import Determinations, Predicted, predict
from surveyapp.core.prediction.kernels import COLUMNS_READ, telling
from surveyapp.core.statistics.distributions import student_quantile
from surveyapp.core.statistics.repeated import SHARED, RunScatter
from surveyapp.core.uncertain import Source, Spread, Uncertain
from surveyapp.domain.priors import DEFAULT_PRIORS, Priors
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import said
from surveyapp_models.angles import wrap_pi
from surveyapp_models.arrays import Floats

MOST = 240
"""The latest determinations that are used: older ones tell of another instrument."""
CAUSE = said("constant: cause not known")
SCATTER = said("constant: scatter of the determinations")
TOGETHER = 16
"""Lines that are predicted at once: work and memory grow with their number, no faster."""
BESIDE = (said("run-to-run scatter"), said("adopted effect outside its range"))
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
    "pressure": "covariate",
    "humidity": "covariate",
    "supply_voltage": "covariate",
}
"""A named effect is taken out of the azimuths and out of the average."""
SCENARIOS = (-1.2816, -0.5244, 0.0, 0.5244, 1.2816)
"""Equally likely states of what a later visit does not tell, in standard deviations."""


@dataclass(frozen=True, slots=True)
class PredictedConstants:
    """Constants of the lines of one instrument.

    Parameters
    ----------
    average : Uncertain
        The constant averaged over the campaign.
    lines : tuple of Uncertain
        One for each line that was wanted.
    drifting : tuple of (float or None)
        Half-width of the 95 % interval of each if the instrument drifts [rad], where the
        determinations are far from it in time.
    causes : mapping of unit to float
        Weight of each cause in the average.
    scatter : RunScatter
        What every run has beside its stated sigma once the causes are accounted for.
    warnings : tuple of ResultWarning
    """

    average: Uncertain
    lines: tuple[Uncertain, ...]
    drifting: tuple[float | None, ...]
    causes: Mapping[str, float]
    scatter: RunScatter
    warnings: tuple[ResultWarning, ...]


def predictable(constant: InstrumentConstant) -> bool:
    """Whether there are enough determinations to predict from."""
    return constant.set_ups >= LEAST_PREDICTED


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
        With calibrations in at least ``LEAST_PREDICTED`` sessions.
    facts : mapping of (session, target) to Circumstances
        Of the calibrations.
    wanted : sequence of Wanted
    priors : Priors
    """
    latest = _latest(one_a_set_up(constant.calibrations, facts))
    used, known = [item for item, _ in latest], [told for _, told in latest]
    base = _Base(constant, used, known, *_shared(used))
    named = frozenset(
        UNIT_OF_EFFECT[e.id] for e in constant.instrument.effects if e.id in UNIT_OF_EFFECT
    )
    priors = priors.without(named)
    first, _, warnings = base.predicted([], base.told_by([]), priors)
    average = _uncertain(constant.instrument.id, first, base.sources, 0)[0]
    lines: list[Uncertain] = []
    for start in range(0, len(wanted), TOGETHER):
        part = wanted[start : start + TOGETHER]
        more, gaps, told = base.predicted(part, base.told_by(part), priors)
        more = base.each_alone(part, more.with_targets({0: 0}, first), priors)
        values = _uncertain(constant.instrument.id, more, base.sources, start)
        average = average if start else values[0]
        lines += values[1:]
        warnings += [w for w in told if w not in warnings]
        warnings += told_of(constant.instrument.id, part, known, gaps)
    stated = base.sigmas if base.stated else None
    drifting = if_drifting(wanted, known, lines, values=base.values, sigmas=stated, priors=priors)
    warnings += drift_notes(constant.instrument.id, wanted, lines, drifting, priors=priors)
    warnings += one_block(constant.instrument.id, known, bool(wanted))
    scatter = RunScatter(first.excess if base.stated else 0.0, round(first.dof), None)
    return PredictedConstants(
        average, tuple(lines), drifting, first.weights, scatter, tuple(warnings)
    )


@dataclass(frozen=True, slots=True)
class _Base:
    """The determinations that everything is predicted from, with what they share."""

    constant: InstrumentConstant
    used: Sequence[Calibration]
    known: Sequence[Circumstances]
    sources: list[Source]
    carried: Floats

    @property
    def values(self) -> Floats:
        """The determinations, about the first [rad]."""
        first = self.used[0].value.value
        return np.array([first + wrap_pi(item.value.value - first) for item in self.used])

    @property
    def sigmas(self) -> Floats:
        """Stated standard deviations of what belongs to one determination alone [rad]."""
        return np.array([_own(item).sigma for item in self.used])

    @property
    def stated(self) -> bool:
        """Whether every determination states one."""
        return bool(np.all(np.isfinite(self.sigmas) & (self.sigmas > 0.0)))

    def told_by(self, part: Sequence[Wanted]) -> frozenset[str]:
        """Columns that vary at all over the determinations and the visits of some lines."""
        visits = [visit for line in part for _, visit in line.visits]
        return frozenset(telling(columns_of([*self.known, *visits], time=counted_in(self.known))))

    def predicted(
        self, part: Sequence[Wanted], read: frozenset[str], priors: Priors
    ) -> tuple[Predicted, frozenset[str], list[ResultWarning]]:
        """Predict the average and some lines from the columns that are read.

        Returns
        -------
        predicted, gaps, warnings
            Gaps are the columns that a visit does not tell.
        """
        visits = [visit for line in part for _, visit in line.visits]
        columns, gaps, told = _columns(self.constant.instrument.id, self.known, visits)
        columns = {name: values for name, values in columns.items() if name in read}
        gaps = gaps & read
        n, sigmas = len(self.used), self.sigmas if self.stated else None
        columns, targets, states = _scenarios(columns, _targets(part, n, sigmas), gaps, n)
        data = Determinations(self.values, sigmas, columns, targets, self.carried, states)
        return predict(data, priors), gaps, told

    def each_alone(self, part: Sequence[Wanted], together: Predicted, priors: Priors) -> Predicted:
        """Lines as each of them is without the others; only what they share is of all together.

        Another line may be the first to tell of a column in which the determinations do not vary.
        That adds causes, which take their weight from those that this line knows.
        """
        everything = self.told_by(part)
        kinds = [self.told_by([line]) for line in part]
        found = together
        for kind in set(kinds) - {everything}:
            places = [place for place, own in enumerate(kinds) if own == kind]
            alone, _, _ = self.predicted([part[place] for place in places], kind, priors)
            rows = {1 + place: row for row, place in enumerate(places, start=1)}
            found = found.with_targets(rows, alone)
        return found


def _latest(
    items: Sequence[tuple[Calibration, Circumstances]],
) -> list[tuple[Calibration, Circumstances]]:
    """The latest determinations, all of them where nobody knows when they were made."""
    days = [told.number("elapsed_days") for _, told in items]
    if len(items) <= MOST or any(day is None for day in days):
        return list(items)[-MOST:]
    order = np.argsort(np.array(days, dtype=np.float64), kind="stable")[-MOST:]
    return [items[i] for i in sorted(order.tolist())]


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
    time = counted_in(known)
    every = columns_of([*known, *visits], time=time)
    columns = {name: values for name, values in every.items() if name in COLUMNS_READ}
    n = len(known)
    kept: dict[str, Floats] = {}
    warnings = []
    for name, values in columns.items():
        missing = ~np.isfinite(values[:n])
        if not missing.any():
            kept[name] = values
        elif 2 * int(missing.sum()) < n and BY_NAME[name].mean_fills:
            mean = float(values[:n][~missing].mean())
            kept[name] = np.concatenate([np.where(missing, mean, values[:n]), values[n:]])
            text = said(
                "instrument {instrument}: {name} is missing at {int} of {n} "
                "determinations: the mean of the others stands for it in the prediction",
                instrument=instrument,
                name=name,
                int=int(missing.sum()),
                n=n,
            )
            warnings.append(ResultWarning("covariate_missing", text))
        elif BY_NAME[name].mean_fills and not missing.all():
            text = said(
                "instrument {instrument}: {name} is missing at {int} of {n} determinations, too "
                "many for the mean of the others to stand for it: the prediction does without it",
                instrument=instrument,
                name=name,
                int=int(missing.sum()),
                n=n,
            )
            warnings.append(ResultWarning("covariate_missing", text))
    if time == "order" and "elapsed_days" in kept and visits:
        text = said(
            "instrument {instrument}: {int} of {n} determinations have no date: the stated order "
            "stands for time, and how many days a line is from them is not known",
            instrument=instrument,
            int=sum(item.number("elapsed_days") is None for item in known),
            n=n,
        )
        warnings.append(ResultWarning("no_dates", text))
    if "elapsed_days" not in kept:
        kept["elapsed_days"] = np.concatenate([np.arange(n), np.full(len(visits), float(n))])
        text = said(
            "instrument {instrument}: neither dates nor order: the prediction takes "
            "the determinations in the order of the file and the lines after them",
            instrument=instrument,
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
    mean, spread = float(known.mean()), max(float(known.std()), BY_NAME[name].least_spread)
    if name == "elapsed_days":
        # within the campaign or one more span of it
        return float(known.max()) + z * float(np.ptp(known))
    return mean + z * spread


def _uncertain(
    instrument: str, found: Predicted, sources: Sequence[Source], start: int
) -> tuple[Uncertain, ...]:
    """Predicted values with their contributions.

    The part of the cause is such that the 95 % interval is that of the mixture: a standard
    deviation of rare large errors would say more than two thirds of the lines will see. Lines share
    it as far as the average says so.
    """
    quantile = student_quantile(0.975, found.dof)
    halves = np.array([found.half_width(t) / quantile for t in range(found.values.size)])
    wanted = np.sqrt(np.maximum(halves**2 - found.readings**2, 0.0))
    root = wanted[:, None] * _shared_root(found)
    result = []
    for t, value in enumerate(found.values):
        parts = {
            source: float(part) for source, part in zip(sources, found.carried[t], strict=True)
        }
        parts[Source(SCATTER, instrument, found.dof)] = float(found.readings[t])
        for k, part in enumerate(root[t]):
            if part != 0.0:
                parts[Source(CAUSE, instrument, found.dof, f"{start}.{k}")] = float(part)
        kept = {source: part for source, part in parts.items() if part != 0.0}
        result.append(Uncertain(float(value), kept, Spread(CAUSE, found.mixtures[t])))
    return tuple(result)


def _shared_root(found: Predicted) -> Floats:
    """Root of the correlations of what not knowing the cause adds; each row has length 1.

    Where members that know the cause have less scatter than the base, the difference to the base's
    scatter is no covariance any more: what is nearest to one is taken, and no row grows by it.
    """
    own = [mixture.variance for mixture in found.mixtures]
    size = np.sqrt(np.maximum(np.abs(np.diagonal(found.causes)), own))
    size = np.where(size > 0.0, size, 1.0)
    alike = np.clip(found.causes / (size[:, None] * size[None, :]), -1.0, 1.0)
    np.fill_diagonal(alike, 1.0)
    values, vectors = np.linalg.eigh(alike)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    return np.asarray(root / np.linalg.norm(root, axis=1)[:, None])
