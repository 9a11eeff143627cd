"""Which observation would tell most next: expected separation of the causes, expected interval.

The average over the causes says what each action would read; every such reading, drawn from it,
moves the weights of the causes and narrows the interval of the next line. The mean over the draws
is what the action is worth before it is made.

Source: prediction.md D; Lindley, D. V. (1956), On a measure of the information provided by an
experiment, Ann. Math. Statist. 27, 986-1005.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from surveyapp.core.orientation.campaign_columns import COLUMNS
from surveyapp.core.prediction.members import Members, members
from surveyapp.core.statistics.mixture import half_widths
from surveyapp.diagnosis.action import POSITION, Action, completed
from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.later_visits import campaign_data, is_campaign
from surveyapp.diagnosis.outlook import ActionResult, Outlook
from surveyapp.domain.priors import DEFAULT_PRIORS, GROSS, Priors
from surveyapp.languages import joined, said, term
from surveyapp_models.arrays import Floats

DRAWS = 200
WIDTH_DRAWS = 40
"""Draws for which the final interval is formed as well."""
LEAST_WEIGHT = 1e-4
LEAST = 4
"""Determinations from which advice is given."""
HORIZON_DAYS = 30.0
"""The later line for which the final interval is told: so many days on, at another line."""
UNUSED_NUMBER = 1000.0
"""Beyond the numbers of the names of a record: a name that none of it has."""


def advice(case: Case, rng: np.random.Generator, priors: Priors = DEFAULT_PRIORS) -> Outlook | None:
    """What each feasible action at the end of a campaign would tell; None where nothing can.

    Parameters
    ----------
    case : Case
        With its ``actions``.
    rng : numpy.random.Generator
        For the readings that are drawn.
    """
    if not is_campaign(case) or case.size < LEAST or not case.actions:
        return None
    columns = {name: np.asarray(values) for name, values in case.columns.items()}
    columns.setdefault("elapsed_days", case.position)
    columns[POSITION] = case.position
    feasible = [(a, rows) for a in case.actions if (rows := a.rows(columns)) is not None]
    if not feasible:
        return None
    visits = [completed(columns, rows) for _, rows in feasible]
    found = _members(case, visits, _later(columns), priors)
    return _outlook(case, [action for action, _ in feasible], found, rng)


def _later(columns: Mapping[str, Floats]) -> dict[str, Floats]:
    """The line that is wanted: some weeks on, another line, the mean of all that varies."""
    days = columns["elapsed_days"]
    later = {name: np.array([float(np.mean(values))]) for name, values in columns.items()}
    later["elapsed_days"] = later[POSITION] = np.array([days.max() + HORIZON_DAYS])
    for column in COLUMNS:
        values = columns.get(column.name)
        if values is not None and column.later == "last":
            later[column.name] = values[-1:]
        elif values is not None and column.later == "new":
            later[column.name] = np.array([values.max() + UNUSED_NUMBER])
    return later


def _members(
    case: Case, visits: Sequence[Mapping[str, Floats]], later: Mapping[str, Floats], priors: Priors
) -> Members:
    """Every cause with its prediction of each action's reading and of the later line (last)."""
    n, q = case.size, len(visits) + 1
    names = set(case.columns) | {"elapsed_days"}
    more = {
        name: np.concatenate([*(v[name][:1] for v in visits), later[name]])
        for name in names
        if all(name in v for v in visits)
    }
    targets = np.zeros((q, n + q))
    targets[np.arange(q), n + np.arange(q)] = 1.0
    return members(campaign_data(case, np.arange(n), targets, more), priors)


def _outlook(
    case: Case, actions: Sequence[Action], found: Members, rng: np.random.Generator
) -> Outlook:
    keep = found.weights > LEAST_WEIGHT * found.weights.max()
    weights = found.weights[keep] / found.weights[keep].sum()
    units = np.array(found.units)[keep]
    # a slip that is not carried forward is no rival of anything for the next line
    names = sorted(set(units.tolist()) - {GROSS})
    classes = np.array([[float(u == name) for name in names] for u in units])
    means, covariance = found.means[keep], found.covariance[keep]
    noise = found.noise[keep]
    state = _State(weights, classes, means, covariance, noise, found.dof)
    share = weights @ classes
    interval = float(
        half_widths(weights[None, :], means[None, :, -1], covariance[None, :, -1, -1], state.dof)[0]
    )
    sigma = 1.0 if case.sigma is None else float(np.median(case.sigma)) / found.unit
    results = [
        _worth(state, place, action, (rng, sigma, found.unit))
        for place, action in enumerate(actions)
    ]
    results.sort(key=lambda item: (-item.information, item.interval95))
    later = said("a line in {horizon_days:.0f} days at", horizon_days=HORIZON_DAYS)
    now = float(share.max() / share.sum())
    return Outlook(now, interval * found.unit, tuple(results), later)


@dataclass(frozen=True, slots=True)
class _State:
    """Members as they stand: weights (m,), classes (m, c), means (m, t), covariance (m, t, t)."""

    weights: Floats
    classes: Floats
    means: Floats
    covariance: Floats
    noise: Floats
    dof: float


def _worth(
    state: _State,
    place: int,
    action: Action,
    how: tuple[np.random.Generator, float, float],
) -> ActionResult:
    """Expected separation and interval once an action's reading is there."""
    rng, sigma, unit = how
    total = state.covariance[:, place, place] + state.noise * sigma**2
    chosen = rng.choice(state.weights.size, DRAWS, p=state.weights)
    scale = np.sqrt(total)
    y = state.means[chosen, place] + scale[chosen] * rng.standard_t(state.dof, DRAWS)
    z = (y[:, None] - state.means[None, :, place]) / scale[None, :]
    log = -np.log(scale) - 0.5 * (state.dof + 1.0) * np.log1p(z * z / state.dof)
    new = state.weights * np.exp(log - log.max(axis=1, keepdims=True))
    new /= new.sum(axis=1, keepdims=True)
    share = new @ state.classes
    share /= share.sum(axis=1, keepdims=True)
    before = state.weights @ state.classes
    before = before / before.sum()
    gain = _entropy(before[None, :])[0] - float(_entropy(share).mean())
    cross = state.covariance[:, place, -1]
    left = np.maximum(state.covariance[:, -1, -1] - cross**2 / total, 0.0)
    some = slice(0, WIDTH_DRAWS)
    moved = state.means[None, :, -1] + (cross / total) * (
        y[some, None] - state.means[None, :, place]
    )
    half = half_widths(new[some], moved, left[None, :], state.dof)
    return ActionResult(
        action=action.id,
        text=action.text,
        separation=float(share.max(axis=1).mean()),
        information=max(gain, 0.0),
        interval95=float(half.mean()) * unit,
    )


def _entropy(share: Floats) -> Floats:
    safe = np.where(share > 0.0, share, 1.0)
    return np.asarray(-(share * np.log(safe)).sum(axis=1))


def worth_in_words(outlook: Outlook, *, scale: float, unit: str) -> list[str]:
    """The advice in sentences with numbers, the best action first."""
    if not outlook.actions:
        return []
    best = outlook.actions[0]
    if outlook.unit:
        scale, unit = outlook.scale, outlook.unit
    sign = '"' if unit == "arcsec" else joined("", (" ", term(unit)))

    def figure(value: float) -> str:
        return format(value, ".1f" if unit == "arcsec" else ".3g")

    now = joined("", (f"+-{figure(outlook.interval / scale)}", sign))

    def told(item: ActionResult) -> str:
        return said(
            "{text}: the likeliest cause would then stand at {separation:.0%} on "
            "average, and {wanted} +-{interval95}{sign} (95 %)",
            text=item.text,
            separation=item.separation,
            wanted=outlook.wanted,
            interval95=figure(item.interval95 / scale),
            sign=sign,
        )

    sentences = [
        said(
            "Next, best: {best}; today it stands at {now:.0%} and {now2}.",
            best=told(best),
            now=outlook.now,
            now2=now,
        )
    ]
    others = [told(item) for item in outlook.actions[1:3]]
    if others:
        sentences.append(said("Else: {others}.", others=_alternatives(others)))
    return sentences


def _alternatives(texts: Sequence[str]) -> str:
    """Clauses of which one is to be done."""
    whole, *others = texts
    for text in others:
        whole = said("{before}; or {last}", before=whole, last=text)
    return whole


__all__ = ["Outlook", "advice", "worth_in_words"]
