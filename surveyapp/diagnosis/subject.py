"""What a subject of diagnosis is: columns, a base model, effects, a value and actions.

One file for each subject (``diagnosis/subjects``); the engine knows none of them. A subject says
what is observed and what stands without any effect; it must not fit, test or rank anything.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from surveyapp.diagnosis.action import Action
from surveyapp.diagnosis.case import Case
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Column, Columns, Effect


class BaseModel(Protocol):
    """Linear model that stands before any effect is looked for."""

    def __call__(self, columns: Columns, /) -> Floats:
        """Return the design, shape (n, p) [SI unit of the observations per parameter]."""
        ...


@dataclass(frozen=True, slots=True)
class DiagnosedSubject:
    """One kind of record.

    Parameters
    ----------
    id : str
        Equal to the file's name and to ``subject`` of its effects.
    title : str
        For people, with its article: ``a tilt sensor``.
    value_name : str
        What the result is called: ``the zero of the sensor``.
    columns : tuple of Column
        What a record may have; effects read them by name.
    base : callable
        ``base(columns) -> (n, p)``.
    base_names : tuple of str
        Of its p parameters.
    effects : tuple of Effect
    value : tuple of float
        The result as a linear function of the base parameters.
    actions : tuple of Action
    unit : str
        Printed unit of the observations.
    scale : float
        SI value of one printed unit.
    position : str
        Column that orders the observations; empty = as they come.
    position_unit : str
        ``s`` makes the frequencies of lines Hz.
    """

    id: str
    title: str
    value_name: str
    columns: tuple[Column, ...]
    base: BaseModel
    base_names: tuple[str, ...]
    effects: tuple[Effect, ...]
    value: tuple[float, ...]
    actions: tuple[Action, ...] = ()
    unit: str = "arcsec"
    scale: float = ARCSEC
    position: str = ""
    position_unit: str = ""

    def __post_init__(self) -> None:
        if not self.id.isidentifier():
            raise ValueError(f"subject {self.id!r}: the id is no identifier")
        if len(self.value) != len(self.base_names):
            raise ValueError(f"subject {self.id}: the value has a number for each base parameter")
        strange = [effect.id for effect in self.effects if effect.subject != self.id]
        if strange:
            raise ValueError(f"subject {self.id}: effects of another subject: {strange}")


@dataclass(frozen=True, slots=True)
class Record:
    """Observations of a subject.

    Parameters
    ----------
    observations : sequence of float
        [SI].
    columns : mapping
        Each of the length of the observations; NaN = missing there.
    sigma : sequence of float or None
        Stated standard deviations [SI].
    resolution : float
        Of the reading [SI]; 0 = unknown.
    references : mapping
        Values at which a datum is wanted.
    identity, instrument : str
    labels : tuple of str
        Name of each observation.
    grid_labels : mapping
        Names behind numbered columns.
    warnings : tuple of ResultWarning
    extra : tuple of Effect
        The user's own.
    groups : ndarray or None, shape (n,)
        What is left out together, such as the rows of one stop.
    series : ndarray or None, shape (n,)
        The channel of each row where several were observed side by side.
    """

    observations: Sequence[float] | Floats
    columns: Mapping[str, Sequence[float] | Floats] = field(default_factory=dict)
    sigma: Sequence[float] | Floats | None = None
    resolution: float = 0.0
    references: Mapping[str, float] = field(default_factory=dict)
    identity: str = ""
    instrument: str = ""
    labels: tuple[str, ...] = ()
    grid_labels: Mapping[str, Mapping[float, str]] = field(default_factory=dict)
    warnings: tuple[ResultWarning, ...] = ()
    extra: tuple[Effect, ...] = ()
    groups: Floats | None = None
    series: Floats | None = None


def case_of(subject: DiagnosedSubject, record: Record) -> Case:
    """Make the case of a record of any subject.

    The value is taken over the record: what an effect adds on average belongs to it.

    Raises
    ------
    SurveyError
        If a column has another length, an observation is no number, or a sigma is not positive.
    """
    values = np.asarray(record.observations, dtype=np.float64)
    columns = {name: np.asarray(c, dtype=np.float64) for name, c in record.columns.items()}
    sigma = None if record.sigma is None else np.asarray(record.sigma, dtype=np.float64)
    _check(subject, record.identity, values, columns, sigma=sigma)
    position = columns.get(subject.position, np.arange(values.size, dtype=np.float64))
    weights = np.full(values.size, 1.0 / max(values.size, 1))
    if sigma is not None:
        weights = sigma**-2 / float(np.sum(sigma**-2))
    return Case(
        subject=subject.id,
        observations=values,
        base=subject.base(columns) if columns else subject.base({POSITION_ONLY: position}),
        base_names=subject.base_names,
        value_base=np.asarray(subject.value, dtype=np.float64),
        value_weights=weights,
        position=position,
        columns=columns,
        effects=(*subject.effects, *record.extra),
        sigma=sigma,
        weighted=sigma is not None,
        resolution=record.resolution,
        references=record.references,
        unit=subject.unit,
        scale=subject.scale,
        instrument=record.instrument,
        identity=record.identity,
        labels=record.labels,
        grid_labels=record.grid_labels,
        warnings=record.warnings,
        position_unit=subject.position_unit,
        title=subject.title,
        value_name=subject.value_name,
        actions=subject.actions,
        base_of=subject.base,
        groups=record.groups,
        series=record.series,
    )


POSITION_ONLY = "position"
"""Column that a base model finds in a record without any."""


def _check(
    subject: DiagnosedSubject,
    identity: str,
    values: Floats,
    columns: Mapping[str, Floats],
    *,
    sigma: Floats | None,
) -> None:
    where = identity or subject.title
    faults = []
    if values.ndim != 1 or not np.isfinite(values).all():
        faults.append(Problem("an observation is no number", where, "nan", "numbers"))
    for name, column in columns.items():
        if column.shape != values.shape:
            faults.append(
                Problem(
                    "a column has another length than the observations",
                    f"{where}, {name}",
                    str(column.size),
                    str(values.size),
                )
            )
    order = columns.get(subject.position)
    if order is not None and not np.isfinite(order).all():
        faults.append(
            Problem(
                "the column that orders the observations has gaps",
                f"{where}, {subject.position}",
                said(
                    "{value} of {size} missing",
                    value=int((~np.isfinite(order)).sum()),
                    size=order.size,
                ),
                "a number for each observation",
            )
        )
    if sigma is not None and (sigma.shape != values.shape or not bool(np.all(sigma > 0.0))):
        faults.append(Problem("a sigma is not positive", where, "", "sigmas above 0"))
    if faults:
        raise SurveyError(faults)
