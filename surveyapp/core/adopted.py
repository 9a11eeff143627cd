"""Adopted effects of an instrument, applied: the loop is closed here.

A campaign found that the constant depends on something, a person adopted it, and from then on
every gyro azimuth of the instrument, on known lines and on unknown ones, is reduced by it. Inside
the range of the data that chose it the correction carries the sigma of its coefficients; outside
it is held at the edge of the range, and the whole of what it would have become enters the sigma.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from surveyapp.core.campaign_columns import Circumstances, circumstances, columns_of, in_blocks
from surveyapp.core.geodesy import Position
from surveyapp.core.session import ReducedSession, TargetReduction
from surveyapp.core.uncertain import Source, Uncertain
from surveyapp.domain.instrument import AdoptedEffect, Instrument
from surveyapp.domain.project import ResultWarning
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp_models.effects import of_subject
from surveyapp_models.effects.effect import Effect

Floats = NDArray[np.float64]

SOURCE = "adopted effect"


@dataclass(frozen=True, slots=True)
class _Place:
    """Where one gyro azimuth stands in the list of sessions."""

    session: int
    target: int


def apply_adopted(
    instrument: Instrument,
    reduced: Sequence[ReducedSession],
    positions: Mapping[str, Position],
) -> tuple[tuple[ReducedSession, ...], list[ResultWarning]]:
    """Reduce every gyro azimuth of one instrument by its adopted effects.

    Parameters
    ----------
    instrument : Instrument
    reduced : sequence of ReducedSession
        All sessions; those of other instruments are passed on.
    positions : mapping of station to Position

    Raises
    ------
    SurveyError
        If an adopted effect is in no catalogue, or its coefficients do not fit it.
    """
    if not instrument.effects:
        return tuple(reduced), []
    places = [
        _Place(i, j)
        for i, item in enumerate(reduced)
        if item.session.instrument == instrument.id
        for j, target in enumerate(item.targets)
        if target.gyro_azimuth is not None
    ]
    facts = in_blocks(
        [
            circumstances(
                reduced[place.session],
                reduced[place.session].targets[place.target],
                latitude=positions[reduced[place.session].session.station].latitude,
            )
            for place in places
        ]
    )
    targets = {place: reduced[place.session].targets[place.target] for place in places}
    warnings: list[ResultWarning] = []
    for effect in instrument.effects:
        shifts, found = effect_shifts(
            instrument, effect, facts, [reduced[place.session].session.id for place in places]
        )
        warnings += found
        for place, shift in zip(places, shifts, strict=True):
            azimuth = targets[place].gyro_azimuth
            if azimuth is not None:
                targets[place] = replace(targets[place], gyro_azimuth=azimuth + shift)
    return _replaced(reduced, targets), warnings


def _replaced(
    reduced: Sequence[ReducedSession], targets: Mapping[_Place, TargetReduction]
) -> tuple[ReducedSession, ...]:
    return tuple(
        replace(
            item,
            targets=tuple(targets.get(_Place(i, j), t) for j, t in enumerate(item.targets)),
        )
        for i, item in enumerate(reduced)
    )


def _known(instrument: Instrument, adopted: AdoptedEffect) -> Effect:
    catalogue = {effect.id: effect for effect in of_subject("campaign")}
    where = f"instrument {instrument.id}, adopted effect"
    if adopted.id not in catalogue:
        hint = nearest_names(adopted.id, catalogue)
        raise SurveyError(
            Problem("an adopted effect is in no catalogue", where, adopted.id, hint=hint)
        )
    effect = catalogue[adopted.id]
    if len(adopted.coefficients) != len(effect.coefficients):
        raise SurveyError(
            Problem(
                "the coefficients of an adopted effect do not fit it",
                f"{where} {adopted.id}",
                f"{len(adopted.coefficients)} coefficients",
                ", ".join(c.name for c in effect.coefficients),
            )
        )
    return effect


def effect_shifts(
    instrument: Instrument,
    adopted: AdoptedEffect,
    facts: Sequence[Circumstances],
    sessions: Sequence[str],
) -> tuple[list[Uncertain], list[ResultWarning]]:
    """What one adopted effect adds to each gyro azimuth [rad], and warnings.

    The constant is larger by the effect: true = gyro + constant + effect. A column that is missing
    for a session counts as its mean, with the largest effect of the range as sigma.
    """
    effect = _known(instrument, adopted)
    ranges = {name: (low, high) for name, low, high in adopted.valid}
    named = dict(adopted.grid)
    columns = columns_of(
        facts,
        lines=[str(named["line"])] if "line" in named else [],
        blocks=[str(named["block"])] if "block" in named else [],
    )
    grid = {name: 0.0 if isinstance(value, str) else value for name, value in adopted.grid}
    held, outside, missing = _held(effect, columns, ranges)
    values, root = _coefficients(effect, adopted)
    inside = effect.basis(held, **grid)
    free = effect.basis(_filled(columns, held), **grid)
    shifts, warnings = [], []
    for i, session in enumerate(sessions):
        parts = {
            Source(SOURCE, instrument.id, detail=f"{adopted.id} {k}"): float(part)
            for k, part in enumerate(inside[i] @ root)
        }
        shift = Uncertain(float(inside[i] @ values), parts)
        if outside[i] or missing[i]:
            excess = abs(float((free[i] - inside[i]) @ values))
            if missing[i]:
                excess = float(np.max(np.abs(inside @ values), initial=0.0))
            source = Source(f"{SOURCE} outside its range", session, detail=adopted.id)
            shift = shift.with_part(source, excess)
            warnings.append(_outside_warning(session, adopted, missing[i]))
        shifts.append(shift)
    return shifts, warnings


def _coefficients(effect: Effect, adopted: AdoptedEffect) -> tuple[Floats, Floats]:
    """Values of the coefficients and square root of their covariance, in internal units."""
    scale = np.array([c.scale for c in effect.coefficients])
    values = np.array([value for _, value, _, _ in adopted.coefficients]) * scale
    return values, _root(adopted) * scale[:, None]


def _outside_warning(session: str, adopted: AdoptedEffect, missing: Sequence[str]) -> ResultWarning:
    why = f"{', '.join(missing)} missing" if missing else "outside its range"
    text = (
        f"session {session}: the adopted effect {adopted.id} is used "
        f"{why}: its correction is held at the edge and its sigma enlarged"
    )
    return ResultWarning("effect_outside_range", text)


def _held(
    effect: Effect, columns: Mapping[str, Floats], ranges: Mapping[str, tuple[float, float]]
) -> tuple[dict[str, Floats], list[bool], list[list[str]]]:
    """Columns held inside the valid ranges, which rows lay outside, and which lack a column."""
    held = dict(columns)
    count = len(next(iter(columns.values())))
    outside = [False] * count
    missing: list[list[str]] = [[] for _ in range(count)]
    for need in effect.needs:
        values = held.get(need.name, np.full(count, math.nan))
        gaps = np.isnan(values)
        for i in np.flatnonzero(gaps).tolist():
            missing[i].append(need.name)
        filler = float(values[~gaps].mean()) if np.any(~gaps) else 0.0
        values = np.where(gaps, filler, values)
        if need.name in ranges:
            low, high = ranges[need.name]
            clipped = np.clip(values, low, high)
            slack = 1e-9 * max(abs(low), abs(high), 1.0)
            for i in np.flatnonzero(np.abs(clipped - values) > slack).tolist():
                outside[i] = True
            values = clipped
        held[need.name] = values
    return held, outside, missing


def _filled(columns: Mapping[str, Floats], held: Mapping[str, Floats]) -> dict[str, Floats]:
    """The columns as they are, gaps filled as in the held ones."""
    return {
        name: np.where(np.isnan(columns[name]), values, columns[name])
        if name in columns
        else values
        for name, values in held.items()
    }


def _root(adopted: AdoptedEffect) -> Floats:
    """Square root of the covariance of the coefficients, shape (p, p), in their own units."""
    if adopted.covariance:
        matrix = np.array(adopted.covariance, dtype=np.float64)
        values, vectors = np.linalg.eigh(0.5 * (matrix + matrix.T))
        return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)))
    return np.diag([sigma for _, _, sigma, _ in adopted.coefficients])
