"""A parameter over temperature: none, linear, piecewise linear, cubic or grey model GM(1,1).

Every model is fitted to values at the nodes of a temperature chamber and asked only between them.
Which one serves is decided by leaving out one inner node after the other. The admissibility of a
grey model is reported because its users ask for it; it does not predict usefulness.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from surveyapp_models.arrays import Floats

ModelName = Literal["none", "linear", "piecewise_linear", "cubic", "grey"]
MODELS: Final[tuple[ModelName, ...]] = ("none", "linear", "piecewise_linear", "cubic", "grey")
LEAST_NODES: Final[Mapping[ModelName, int]] = {
    "none": 1,
    "linear": 2,
    "piecewise_linear": 2,
    "cubic": 4,
    "grey": 4,
}


@dataclass(frozen=True, slots=True)
class GreyModel:
    """GM(1,1) of a shifted series: an exponential in the temperature.

    Parameters
    ----------
    development, input_ : float
        a and b of x0(k) + a z(k) = b.
    shift : float
        Added to make the series positive.
    first, spacing, begin : float
        First value (shifted), mean spacing and first temperature [C].
    admissible : bool
        Whether every ratio of neighbours lies within exp(-2/(n+1)) to exp(2/(n+1)).
    """

    development: float
    input_: float
    shift: float
    first: float
    spacing: float
    begin: float
    admissible: bool

    def at(self, temperature_c: Floats) -> Floats:
        """Values at temperatures, same shape: the derivative of the accumulated series."""
        a, b = self.development, self.input_
        t = (np.asarray(temperature_c) - self.begin) / self.spacing
        if abs(a) < 1e-9:
            return np.asarray(np.full(np.shape(t), b) - self.shift)
        scale = (self.first - b / a) * (1.0 - math.exp(a))
        return np.asarray(scale * np.exp(-a * t) - self.shift)


def ratios_admissible(values: Floats) -> bool:
    """Whether neighbours of a positive series have ratios that GM(1,1) admits."""
    if float(values.min()) <= 0.0:
        return False
    bound = 2.0 / (values.size + 1.0)
    return bool(np.all(np.abs(np.log(values[:-1] / values[1:])) < bound))


def grey_model(temperature_c: Floats, values: Floats) -> GreyModel | None:
    """Fit GM(1,1) to node values at any spacing; None where they do not determine it.

    The series is made positive by lifting its smallest value to its range, unless it is admissible
    as it stands. x1 = cumulated x0, z = mean of neighbours of x1, x0(k) + a z(k) = b by least
    squares, x1(k+1) = (x0(1) - b/a) exp(-a k) + b/a. Unequal spacing weights the sums by it.

    Parameters
    ----------
    temperature_c, values : ndarray, shape (n,)
        Sorted by temperature.
    """
    if values.size < LEAST_NODES["grey"]:
        return None
    span = float(np.ptp(values))
    positive = float(values.min()) > 0.0 and ratios_admissible(values)
    shift = 0.0 if positive else span - float(values.min())
    x0 = values + shift
    if span == 0.0:
        return None
    spacing = float(np.ptp(temperature_c)) / (values.size - 1)
    steps = np.diff(temperature_c) / spacing
    x1 = np.concatenate([[x0[0]], x0[0] + np.cumsum(x0[1:] * steps)])
    z = 0.5 * (x1[1:] + x1[:-1])
    design = np.column_stack([-z, np.ones(z.size)])
    (a, b), *_ = np.linalg.lstsq(design, x0[1:], rcond=None)
    begin = float(temperature_c[0])
    model = GreyModel(
        float(a), float(b), shift, float(x0[0]), spacing, begin, ratios_admissible(x0)
    )
    return model if np.all(np.isfinite(model.at(temperature_c))) else None


def fitted(
    model: ModelName, temperature_c: Floats, values: Floats
) -> Callable[[Floats], Floats] | None:
    """The model through node values as a function of temperature; None from too few nodes.

    Parameters
    ----------
    model : str
    temperature_c, values : ndarray, shape (n,)
        Sorted by temperature [C].
    """
    if values.size < LEAST_NODES[model]:
        return None
    if model == "grey":
        grey = grey_model(temperature_c, values)
        return None if grey is None else grey.at
    if model == "piecewise_linear":
        return lambda t: np.interp(t, temperature_c, values)
    degree = {"none": 0, "linear": 1, "cubic": 3}[model]
    middle, half = float(np.mean(temperature_c)), max(float(np.ptp(temperature_c)) / 2.0, 1e-9)
    polynomial = np.polynomial.Polynomial.fit(
        temperature_c, values, degree, domain=[middle - half, middle + half]
    )
    return lambda t: np.asarray(polynomial(np.asarray(t, dtype=np.float64)))


def held_out_residuals(model: ModelName, temperature_c: Floats, values: Floats) -> Floats | None:
    """Each inner node predicted from the others, observed minus predicted, shape (n - 2,).

    The two ends are not left out: they would be extrapolated, which is refused everywhere.
    """
    rest = []
    for k in range(1, values.size - 1):
        keep = np.arange(values.size) != k
        function = fitted(model, temperature_c[keep], values[keep])
        if function is None:
            return None
        rest.append(float(values[k] - function(temperature_c[k : k + 1])[0]))
    return np.array(rest) if rest else None


@dataclass(frozen=True, slots=True)
class Compensation:
    """How well one model serves.

    Parameters
    ----------
    model : str
    held_out_rms : float or None
        Over all series, each inner node predicted from the others.
    admissible : bool or None
        Of a grey model: whether all series are admissible; None of the other models.
    """

    model: ModelName
    held_out_rms: float | None
    admissible: bool | None


def compare_models(temperature_c: Floats, series: Floats) -> tuple[Compensation, ...]:
    """Compare the models over several series, shape (n, k), all in one unit."""
    found = []
    for model in MODELS:
        parts = [held_out_residuals(model, temperature_c, column) for column in series.T]
        known = [p for p in parts if p is not None]
        rms = None
        if known and len(known) == len(parts):
            rms = math.sqrt(float(np.mean(np.concatenate(known) ** 2)))
        admissible = None
        if model == "grey":
            grey = [grey_model(temperature_c, column) for column in series.T]
            admissible = all(g is not None and g.admissible for g in grey)
        found.append(Compensation(model, rms, admissible))
    return tuple(found)


def chosen_model(comparison: tuple[Compensation, ...]) -> ModelName:
    """The model with the smallest error at left-out nodes; piecewise linear where none is known."""
    known = [c for c in comparison if c.held_out_rms is not None]
    if not known:
        return "piecewise_linear"  # of a single node its value
    return min(known, key=lambda c: c.held_out_rms or 0.0).model


def weights_at(model: ModelName, temperature_c: Floats, at: float) -> Floats | None:
    """How much each node value counts at a temperature, shape (n,); None for the grey model.

    ``at`` in degrees Celsius, as the nodes.
    """
    if model == "grey":
        return None
    unit = np.eye(temperature_c.size)
    rows = []
    for row in unit:
        function = fitted(model, temperature_c, row)
        if function is None:
            return None
        rows.append(float(function(np.array([at]))[0]))
    return np.array(rows)
