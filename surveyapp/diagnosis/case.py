"""What is diagnosed: observations, the model that stands, and the columns that effects may use.

One form for every subject. A reversal run has a swing (side and half swings) beside its linear
base; the other subjects have a linear base only. The engine works in SI units inside and prints in
``unit``. Nothing here fits anything.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from surveyapp.diagnosis.action import Action, Planner
from surveyapp.domain.subject import Subject
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import said
from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Columns, Effect, SubjectId

FEW_OBSERVATIONS = 6
"""Below this number the stated sigmas serve instead of the residuals (diagnosis.md step 0)."""


def _read_only(values: Floats) -> Floats:
    """A view through which nobody can write; the array of the caller stays as it is."""
    view = np.asarray(values).view()
    view.flags.writeable = False
    return view


@dataclass(frozen=True, slots=True)
class OwnScale:
    """Rows whose sigma was found from their own residuals: a test has to count with its error.

    Parameters
    ----------
    rows : ndarray of int
    basis : ndarray, shape (m, p)
        Orthonormal columns of the model about which it was found.
    """

    rows: NDArray[np.intp]
    basis: Floats

    def scaled(self, sample: Floats) -> Floats:
        """Draws (d, n) of noise of variance 1 as the rows would show them."""
        part = sample[:, self.rows]
        left = part - (part @ self.basis) @ self.basis.T
        dof = max(self.rows.size - self.basis.shape[1], 1)
        result = sample.copy()
        result[:, self.rows] = part / np.sqrt((left**2).sum(axis=1) / dof)[:, None]
        return result


@dataclass(frozen=True, slots=True)
class Levels:
    """What the search asks of a record (diagnosis.md steps 3 and 4).

    Parameters
    ----------
    first, further : float
        Family p below which the search goes on. Beside the base model: the rate of false alarms;
        beside what was found: the rate of wrong names that stand with a right one.
    margin : float
        BIC by which every rival of a name must be worse.
    shape_odds : float
        BIC that each generic shape in a rival is charged beforehand: twice the logarithm of prior
        odds against it.
    """

    first: float = 0.05
    further: float = 0.05
    margin: float = 4.0
    shape_odds: float = 0.0


@dataclass(frozen=True, slots=True)
class Case:
    """Observations with their base model.

    Parameters
    ----------
    subject : str
        Whose catalogue applies.
    observations : ndarray, shape (n,)
        Relative to ``offset`` [SI].
    base : ndarray, shape (n, p)
        Linear base design [SI per parameter]; a run and a campaign have one column of ones.
    base_names : tuple of str
    value_base : ndarray, shape (p,)
        The result as a function of the base parameters.
    value_weights : ndarray, shape (n,)
        The result takes this weighted sum of every midpoint effect: 1/n = mean over the run.
    position : ndarray, shape (n,)
        Time or order for generic shapes and stochastic rivals.
    columns : mapping
        What effects may use, each of shape (n,); NaN = missing there.
    effects : tuple of Effect
        The subject's catalogue and the user's own.
    side, half_swing : ndarray or None, shape (n,)
        Of a swing: +1 right, -1 left; half swings since the first point.
    sigma : ndarray or None, shape (n,)
        Stated standard deviations [SI]; relative weights of a campaign, not taken for known noise
        from six observations on.
    weighted : bool
        Whether the stated sigmas weight the observations.
    resolution : float
        Of the reading [SI]; 0 = unknown.
    references : mapping
        Values at which a datum is wanted, such as temperature_c.
    offset : float
        Added to the value [SI].
    unit : str
        Printed unit of residuals.
    scale : float
        SI value of one printed unit.
    direction : bool
        Whether the value is a direction (printed in degrees) or a small quantity (in ``unit``).
    instrument : str
    identity : str
        Session or campaign, for messages.
    labels : tuple of str
        Name of each observation for messages: nothing is looked up by it.
    grid_labels : mapping
        Names behind numbered columns: ``{"line": {0.0: "A-B"}}``.
    warnings : tuple of ResultWarning
    position_unit : str
        Of ``position`` where it is a time: ``s`` makes frequencies Hz; empty = an order.
    title : str
        The subject with its article; empty = its id.
    value_name : str
        What the result is called.
    actions : tuple of Action
        What can be observed next.
    members : tuple of Subject
        The session and target of each observation, where it has one.
    groups : ndarray or None, shape (n,)
        What is left out together when a model is proved: the rows of one stop; None = each row by
        itself.
    series : ndarray or None, shape (n,)
        Which of several channels that were observed side by side an observation belongs to; what
        wanders at random wanders in each by itself. NaN = what does not wander; None = one channel.
    reported : ndarray or None, shape (n,)
        1 where an observation counts in the errors that are printed, else 0; None = all. Others
        take part in everything else.
    own_scales : tuple of OwnScale
        Where the stated sigmas were found from the observations themselves.
    levels : Levels
        At which its gates open.
    base_of : callable or None
        The base design of other rows; None = the mean of the record's own rows.
    nuisance : int
        Columns of the base model of which nobody asks, such as those of crooked seats.
    planner : callable or None
        Makes the record with its actions where these are no further rows of the columns (a
        ``next_rows.Planner``): when advice is asked for, as it costs.
    """

    subject: SubjectId
    observations: Floats
    base: Floats
    base_names: tuple[str, ...]
    value_base: Floats
    value_weights: Floats
    position: Floats
    columns: Mapping[str, Floats]
    effects: tuple[Effect, ...]
    side: Floats | None = None
    half_swing: Floats | None = None
    sigma: Floats | None = None
    weighted: bool = False
    resolution: float = 0.0
    references: Mapping[str, float] = field(default_factory=dict)
    offset: float = 0.0
    unit: str = "arcsec"
    scale: float = ARCSEC
    direction: bool = False
    instrument: str = ""
    identity: str = ""
    labels: tuple[str, ...] = ()
    grid_labels: Mapping[str, Mapping[float, str]] = field(default_factory=dict)
    warnings: tuple[ResultWarning, ...] = ()
    position_unit: str = ""
    title: str = ""
    value_name: str = said("the result")
    actions: tuple[Action, ...] = ()
    members: tuple[Subject, ...] = ()
    base_of: Callable[[Columns], Floats] | None = None
    groups: Floats | None = None
    series: Floats | None = None
    reported: Floats | None = None
    own_scales: tuple[OwnScale, ...] = ()
    levels: Levels = field(default_factory=Levels)
    nuisance: int = 0
    planner: Callable[[], Planner | None] | None = None

    def __post_init__(self) -> None:
        """Hand out what effects may read so that they cannot write into it."""
        frozen = {name: _read_only(values) for name, values in self.columns.items()}
        object.__setattr__(self, "columns", frozen)
        for name in ("side", "half_swing"):
            values = getattr(self, name)
            if values is not None:
                object.__setattr__(self, name, _read_only(values))

    @property
    def size(self) -> int:
        """Number of observations."""
        return int(self.observations.size)

    @property
    def has_swing(self) -> bool:
        """Whether an amplitude law belongs to the base model."""
        return self.side is not None

    @property
    def ordered(self) -> bool:
        """Whether the observations follow each other at all: conditions of a traverse do not."""
        return self.size < 2 or float(np.ptp(self.position)) > 0.0

    @property
    def base_parameters(self) -> int:
        """Parameters of the base model: linear ones, amplitude and damping of a swing."""
        return int(self.base.shape[1]) + (2 if self.has_swing else 0)

    @property
    def sigma_known(self) -> bool:
        """Whether stated sigmas serve for the noise because there are too few observations."""
        return self.size < FEW_OBSERVATIONS and self.sigma is not None

    @property
    def root_weights(self) -> Floats:
        """Factors that make the observations equally good, with mean square 1."""
        if not self.weighted or self.sigma is None:
            return np.ones(self.size)
        root = 1.0 / self.sigma
        return np.asarray(root / np.sqrt(np.mean(root**2)))

    @property
    def noise_floor(self) -> float:
        """Smallest standard deviation that rounded readings can have [SI]."""
        return self.resolution / float(np.sqrt(12.0))

    def digest(self) -> str:
        """Sha256 of everything that the result depends on."""
        parts = [
            self.subject.encode(),
            repr(self.resolution).encode(),
            repr(self.weighted).encode(),
        ]
        arrays = [self.observations, self.base, self.position, self.value_weights]
        arrays += [
            a for a in (self.side, self.half_swing, self.sigma, self.series) if a is not None
        ]
        for name in sorted(self.columns):
            parts.append(name.encode())
            arrays.append(self.columns[name])
        parts += [effect.id.encode() for effect in self.effects]
        parts += [np.ascontiguousarray(a, dtype=np.float64).tobytes() for a in arrays]
        return hashlib.sha256(b"\x00".join(parts)).hexdigest()


def unit_variance(problem: Case) -> float | None:
    """Variance of an observation of mean weight where stated sigmas serve, else None [SI^2]."""
    if not problem.sigma_known or problem.sigma is None:
        return None
    if problem.weighted:
        return float(1.0 / np.mean(1.0 / problem.sigma**2))
    return float(np.mean(problem.sigma**2))
