"""The gyro of a total station on a turning table as a subject: a row for each way of each set.

One gyro only, so the effects of a rate sensor keep the coefficients of its x axis. The base model
is, in each pass, its bias with what it sees of the vertical earth rate, and its response to the
table's rate: the sine of its elevation. So an asymmetric scale, which raises both ways alike, looks
like the bias and is never told from it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.subject import DiagnosedSubject, Record, case_of
from surveyapp.diagnosis.subjects.rate import COLUMNS
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp_models.arrays import Floats
from surveyapp_models.effects import of_subject
from surveyapp_models.effects.effect import Column, Columns, Effect
from surveyapp_models.effects.rate import DEG_S
from surveyapp_models.effects.rate.gross_error import rows as rows_of

PASS = Column("pass", "number of the pass, from 1")
TABLE = Column("table_rate", "of the table about the axis that points up, rad/s")
LEAST_SETS = 2


@dataclass(frozen=True, slots=True)
class FogTurn:
    """What the gyro showed while the table turned one way.

    Parameters
    ----------
    output : float
        Mean over whole turns [rad/s].
    rate : float
        Of the table, anticlockwise from above positive [rad/s].
    set_id, pass_id : int
    elapsed_s : float
    temperature_c : float or None
    rows : tuple of int
        First and last row, last exclusive.
    """

    output: float
    rate: float
    set_id: int
    pass_id: int
    elapsed_s: float
    temperature_c: float | None
    rows: tuple[int, int]


def base(columns: Columns, /) -> Floats:
    """Bias in each pass, and the response to the table's rate in each, shape (n, 2 passes)."""
    here = (columns["pass"][:, None] == np.unique(columns["pass"])).astype(np.float64)
    return np.hstack([here, here * columns["table_rate"][:, None]])


def of_one_gyro(effect: Effect) -> Effect:
    """The effect with the coefficients that a single gyro, x, can have."""
    keep = [
        k
        for k, c in enumerate(effect.coefficients)
        if c.name not in ("y", "z") and not (len(c.name) == 2 and c.name[0] in "yz")
    ]

    def basis(columns: Columns, /, **grid: float) -> Floats:
        return np.asarray(effect.basis(columns, **grid)[:, keep])

    needs = tuple(need for need in effect.needs if not need.name.endswith(("_y", "_z")))
    kept = tuple(effect.coefficients[k] for k in keep)
    return replace(effect, needs=needs, coefficients=kept, basis=basis)


def fog_case(turns: Sequence[FogTurn], *, identity: str, extra: tuple[Effect, ...] = ()) -> Case:
    """The case of the sets of a record.

    Raises
    ------
    SurveyError
        If there are too few.
    """
    sets = {(t.pass_id, t.set_id) for t in turns}
    if len(sets) < LEAST_SETS:
        raise SurveyError(
            Problem(
                "too few sets to diagnose",
                identity,
                str(len(sets)),
                said("{least_sets} or more", least_sets=LEAST_SETS),
            )
        )
    turns = sorted(turns, key=lambda t: t.elapsed_s)
    output = np.array([t.output for t in turns])
    columns = _columns(turns, output)
    count = base(columns).shape[1] // 2
    subject = DiagnosedSubject(
        id="rate",
        title=said("a gyro on a total station"),
        value_name=said("the mean bias of the gyro"),
        columns=(*COLUMNS, PASS, TABLE),
        base=base,
        base_names=tuple(
            f"{name}_pass_{p:g}"
            for name in ("bias", "response")
            for p in np.unique(columns["pass"])
        ),
        effects=tuple(of_one_gyro(effect) for effect in of_subject("rate")),
        value=tuple(1.0 / count if k < count else 0.0 for k in range(2 * count)),
        unit="deg/s",
        scale=DEG_S,
        position="elapsed_s",
    )
    labels = tuple(
        f"pass {t.pass_id}, set {t.set_id}, {'back' if t.rate > 0.0 else 'clockwise'}"
        for t in turns
    )
    named = {"row": dict(zip(rows_of(columns).tolist(), labels, strict=True))}
    number = {key: float(k) for k, key in enumerate(sorted(sets))}
    record = Record(
        output,
        columns,
        identity=identity,
        labels=labels,
        grid_labels=named,
        groups=np.array([number[t.pass_id, t.set_id] for t in turns]),
        extra=extra,
    )
    return case_of(subject, record)


def _columns(turns: Sequence[FogTurn], output: Floats) -> dict[str, Floats]:
    """What is known of each way, and the size of the gyro's own rate in it."""
    rate = np.array([t.rate for t in turns])
    columns: dict[str, Floats] = {
        "axis": np.zeros(len(turns)),
        "stop": np.arange(1.0, len(turns) + 1.0),
        "elapsed_s": np.array([t.elapsed_s - turns[0].elapsed_s for t in turns]),
        "pass": np.array([float(t.pass_id) for t in turns]),
        "table_rate": rate,
    }
    warmth = [t.temperature_c for t in turns if t.temperature_c is not None]
    if len(warmth) == len(turns) and np.ptp(warmth) > 0.0:
        columns["temperature_c"] = np.array(warmth)
    # the gyro's own rate: the table's by the sine of the elevation, which the base model finds
    design = base(columns)
    count = design.shape[1] // 2
    slope = np.linalg.lstsq(design, output, rcond=None)[0][count:]
    own = np.abs(design[:, count:] @ slope)
    return columns | {"half_size_x": 0.5 * own, "half_size_y": 0.0 * own, "half_size_z": 0.0 * own}
