"""A campaign judged by what it predicts: later determinations from earlier ones.

Residuals get smaller with every parameter; the azimuth of the next line does not. Here the last
third of a campaign, in order of time, is predicted from the first two, by the mean (before) and by
the average over the base model and its rivals (after).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from surveyapp.core.prediction.average import Determinations, predict
from surveyapp.core.prediction.kernels import COLUMNS_READ
from surveyapp.core.statistics.distributions import student_quantile
from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.outlook import HeldOut, PredictionErrors
from surveyapp.domain.priors import DEFAULT_PRIORS, Priors
from surveyapp.languages import said
from surveyapp_models.arrays import Floats

Rows = NDArray[np.intp]
"""Numbers of determinations."""
LEAST_TRAINING = 4
LEAST_TESTED = 2


def is_campaign(case: Case) -> bool:
    """Whether a case is one constant determined again and again."""
    return case.subject == "campaign"


def campaign_data(
    case: Case, rows: Rows, targets: Floats, more: dict[str, Floats] | None = None
) -> Determinations:
    """Determinations of the given rows, and wanted constants at these and further rows.

    Parameters
    ----------
    case : Case
    rows : ndarray of int, shape (n,)
        Determinations that are used.
    targets : ndarray, shape (t, n + q)
    more : dict, optional
        Columns of q further visits.
    """
    columns = {}
    for name in COLUMNS_READ:
        values = case.columns.get(name)
        if name == "elapsed_days" and values is None:
            values = case.position
        if values is not None and np.isfinite(values).all():
            extra = (more or {}).get(name, np.zeros(0))
            columns[name] = np.concatenate([values[rows], extra])
    sigma = None if case.sigma is None else case.sigma[rows]
    return Determinations(
        case.observations[rows], sigma, columns, targets, np.zeros((rows.size, 0))
    )


def rows_of(case: Case, rows: Rows) -> dict[str, Floats]:
    """Columns of some rows of a campaign, as further visits."""
    found = {name: values[rows] for name, values in case.columns.items()}
    found.setdefault("elapsed_days", case.position[rows])
    return found


def held_out_prediction(case: Case, *, before: float | None, after: float | None) -> HeldOut | None:
    """Errors of predicting what was observed last from what was observed first.

    Parameters
    ----------
    case : Case
    before, after : float or None
        Of other subjects than a campaign: root mean square error [SI] of the base model and of the
        best one on the last quarter.

    Returns
    -------
    HeldOut or None
        None where there are too few observations.
    """
    if is_campaign(case):
        return _campaign(case, DEFAULT_PRIORS)
    if before is None:
        return None
    errors = [PredictionErrors(rms, None, None) for rms in (before, after)]
    return HeldOut(said("the last quarter from the rest"), 0, errors[0], errors[1])


def _campaign(case: Case, priors: Priors) -> HeldOut | None:
    n = case.size
    count = n - math.ceil(2.0 * n / 3.0)
    first = n - count
    if first < LEAST_TRAINING or count < LEAST_TESTED:
        return None
    order = np.argsort(case.position, kind="stable")
    train, test = order[:first], order[first:]
    targets = np.zeros((count, n))
    targets[np.arange(count), first + np.arange(count)] = 1.0
    data = campaign_data(case, train, targets, rows_of(case, test))
    found = predict(data, priors)
    own = _own_variance(case, test, found.excess)
    halves = np.array([found.half_width(t, float(own[t])) for t in range(count)])
    errors = case.observations[test] - found.values
    mean, half = _mean(case, train, test)
    return HeldOut(
        said("the last third from the first two, in order of time"),
        count,
        _errors(case.observations[test] - mean, half),
        _errors(errors, halves),
    )


def _own_variance(case: Case, rows: Rows, excess: float) -> Floats:
    """Variance of the left-out determinations themselves [SI^2]."""
    stated = np.zeros(rows.size) if case.sigma is None else case.sigma[rows] ** 2
    return np.asarray(stated + excess**2)


def _mean(case: Case, train: Rows, test: Rows) -> tuple[float, Floats]:
    """The mean of the first determinations and the half-widths for the later ones [SI]."""
    y = case.observations[train]
    w = np.ones(train.size) if case.sigma is None else case.sigma[train] ** -2
    mean = float(w @ y / w.sum())
    dof = train.size - 1
    factor = float(w @ (y - mean) ** 2) / dof
    own = np.ones(test.size) if case.sigma is None else case.sigma[test] ** 2
    half = student_quantile(0.975, dof) * np.sqrt(factor * (1.0 / w.sum() + own))
    return mean, np.asarray(half)


def _errors(errors: Floats, half: Floats) -> PredictionErrors:
    return PredictionErrors(
        float(np.sqrt(np.mean(errors**2))),
        float(np.mean(np.abs(errors) <= half)),
        float(np.median(half)),
    )
