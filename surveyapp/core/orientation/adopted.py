"""Adopted effects of an instrument, applied: the loop is closed here.

A campaign found that the constant depends on something, a person adopted it, and from then on
every gyro azimuth of the instrument, on known lines and on unknown ones, is reduced by it to the
reference that was written down at the adoption: what a session is corrected by depends on that
session alone. A constant, pooled or stated, is then the one at the reference. Inside the range of
the data that chose it the correction carries the sigma of its coefficients; outside it is held at
the edge of the range, and the whole of what it would have become enters the sigma.

An effect of a line stands in what the calibrations of that line are compared with, not in the gyro
(line_offset: its known azimuth, centring, deflection): it is taken from calibrations alone.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from surveyapp.core.geodesy import Position
from surveyapp.core.orientation.campaign_columns import BLOCK_GAP_DAYS, LABELLED, Name, Place
from surveyapp.core.orientation.circumstances import (
    Circumstances,
    circumstances_of,
    columns_of,
    name_of,
)
from surveyapp.core.swing.session import ReducedSession, TargetReduction
from surveyapp.core.uncertain import Source, Uncertain
from surveyapp.domain.instrument import AdoptedEffect, Instrument
from surveyapp.domain.station_line import StationLine
from surveyapp.domain.subject import Subject
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import joined, listed, said
from surveyapp_models.angles import RHO_ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.effects import of_subject
from surveyapp_models.effects.effect import Effect

SOURCE = said("adopted effect")
STEPS = 25
"""Values of a missing column that are tried over its range for the largest effect."""


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
        Its effects are checked (``adopted_checks``).
    reduced : sequence of ReducedSession
        All sessions; those of other instruments are passed on.
    positions : mapping of station to Position
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
    sessions = [reduced[place.session].session for place in places]
    targets = {place: reduced[place.session].targets[place.target] for place in places}
    facts = circumstances_of(
        [
            Place(reduced[place.session], targets[place], positions[session.station])
            for place, session in zip(places, sessions, strict=True)
        ]
    )
    warnings: list[ResultWarning] = []
    for adopted in instrument.effects:
        effect = known_effects()[adopted.id]
        chosen = list(range(len(places)))
        if effect.per == "line":
            chosen = [i for i in chosen if sessions[i].purpose == "calibration"]
            warnings += _not_moved(adopted, [s.id for s in sessions], facts, chosen)
        shifts, found = effect_shifts(
            instrument, adopted, [facts[i] for i in chosen], [sessions[i].id for i in chosen]
        )
        warnings += found
        for i, shift in zip(chosen, shifts, strict=True):
            azimuth = targets[places[i]].gyro_azimuth
            if azimuth is not None:
                targets[places[i]] = replace(targets[places[i]], gyro_azimuth=azimuth + shift)
    return _replaced(reduced, targets), warnings


def known_effects() -> dict[str, Effect]:
    """The effects that an instrument can have adopted."""
    return {effect.id: effect for effect in of_subject("campaign")}


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


def _not_moved(
    adopted: AdoptedEffect,
    sessions: Sequence[str],
    facts: Sequence[Circumstances],
    calibrations: Sequence[int],
) -> list[ResultWarning]:
    """Surveys of the very line that stands off: its offset is not the gyro's."""
    line = _named(adopted, facts).get("line")
    told = {
        sessions[i]: None
        for i in range(len(sessions))
        if i not in calibrations and facts[i].name("line") == line
    }
    if not told or not isinstance(line, StationLine):
        return []
    size = ", ".join(f"{value:+.1f} {unit}" for _, value, _, unit in adopted.coefficients)
    text = said(
        "{told}: the line {line} stands off by {size} in its calibrations (adopted "
        "effect {id}): its known azimuth, centring or deflection; a survey of it "
        "is not moved by that",
        told=joined(", ", told),
        line=line,
        size=size,
        id=adopted.id,
    )
    return [ResultWarning("line_not_moved", text, Subject.side(line.station, line.target))]


@dataclass(frozen=True, slots=True)
class _Rows:
    """Rows of a basis for each gyro azimuth, shape (n, p), and what stands in the way.

    Parameters
    ----------
    inside : ndarray
        Held inside the range that is known; 0 where none is.
    free : ndarray
        As the columns are.
    outside : list of list of str
        Columns outside their range.
    missing : list of list of str
        Columns that the project does not tell.
    """

    inside: Floats
    free: Floats
    outside: list[list[str]]
    missing: list[list[str]]


def effect_shifts(
    instrument: Instrument,
    adopted: AdoptedEffect,
    facts: Sequence[Circumstances],
    sessions: Sequence[str],
) -> tuple[list[Uncertain], list[ResultWarning]]:
    """What one adopted effect adds to each gyro azimuth [rad], and warnings.

    The constant is larger by the effect: true = gyro + constant + effect. Where a column is
    missing nothing is corrected (without a reference: as in the middle of the range), and the
    largest effect inside the range is the sigma of that.
    """
    if not facts:
        return [], []
    effect = known_effects()[adopted.id]
    columns = _columns(effect, adopted, facts)
    values, root = _coefficients(effect, adopted)
    rows = _rows(effect, adopted, columns)
    name = " ".join([adopted.id, *(str(value) for _, value in adopted.grid)])
    shifts, warnings = [], []
    for i, session in enumerate(sessions):
        parts = {
            Source(SOURCE, instrument.id, detail=f"{name} {k}"): float(part)
            for k, part in enumerate(rows.inside[i] @ root)
        }
        shift = Uncertain(float(rows.inside[i] @ values), parts)
        beyond = said("{source} outside its range", source=SOURCE)
        if rows.missing[i]:
            excess = _largest(effect, adopted, columns, (i, rows), values=values)
            shift = shift.with_part(Source(beyond, session, detail=name), excess)
        else:
            # sessions on one side of the range err alike: it does not average out
            excess = float((rows.free[i] - rows.inside[i]) @ values)
            if excess != 0.0:
                shift = shift.with_part(Source(beyond, instrument.id, detail=name), excess)
        if rows.missing[i]:
            warnings.append(_missing_warning(session, adopted, rows.missing[i], excess))
        elif rows.outside[i] and not unknown_ranges(adopted):
            warnings.append(_outside_warning(session, adopted, rows.outside[i], abs(excess)))
        shifts.append(shift)
    return shifts, warnings


def unknown_ranges(adopted: AdoptedEffect) -> list[str]:
    """Columns of an adopted effect that have no range."""
    ranged = {name for name, _, _ in adopted.valid}
    effect = known_effects()[adopted.id]
    return [n.name for n in effect.needs if n.name not in LABELLED and n.name not in ranged]


def without_reference(adopted: AdoptedEffect) -> bool:
    """Whether an adopted effect lacks the reference that it needs to be the same everywhere."""
    return known_effects()[adopted.id].reference is not None and not adopted.reference


def _columns(
    effect: Effect, adopted: AdoptedEffect, facts: Sequence[Circumstances]
) -> dict[str, Floats]:
    """The columns that an effect needs; a named line or block has the number 0."""
    named = _named(adopted, facts)
    columns = columns_of(
        facts, known={name: [value] for name, value in named.items()}, time=adopted.time
    )
    days = {name: (low, high) for name, low, high in adopted.valid}.get("elapsed_days")
    if "block" in named and days is not None:
        # the name of a block depends on its first session, which may be in another project
        start, end = days[0] - BLOCK_GAP_DAYS, days[1] + BLOCK_GAP_DAYS
        known = [fact.number("elapsed_days") for fact in facts]
        dates = np.array([np.nan if day is None else day for day in known], dtype=np.float64)
        within = (dates >= start) & (dates <= end)
        columns["block"] = np.where(np.isnan(dates), np.nan, np.where(within, 0.0, 1.0))
    return {need.name: columns[need.name] for need in effect.needs}


def _named(adopted: AdoptedEffect, facts: Sequence[Circumstances]) -> dict[str, Name]:
    """The line or block of an effect, found by its text among those that were observed."""
    return {
        column: name_of(str(text), [fact.name(column) for fact in facts])
        for column, text in adopted.grid
        if column in LABELLED
    }


def _grid(adopted: AdoptedEffect) -> dict[str, float]:
    return {name: 0.0 if isinstance(value, str) else value for name, value in adopted.grid}


def _coefficients(effect: Effect, adopted: AdoptedEffect) -> tuple[Floats, Floats]:
    """Values of the coefficients and square root of their covariance, in internal units."""
    scale = np.array([c.scale for c in effect.coefficients])
    values = np.array([value for _, value, _, _ in adopted.coefficients]) * scale
    return values, _root(adopted) * scale[:, None]


def _rows(effect: Effect, adopted: AdoptedEffect, columns: Mapping[str, Floats]) -> _Rows:
    ranges = {name: (low, high) for name, low, high in adopted.valid}
    count = len(next(iter(columns.values())))
    held, free = dict(columns), dict(columns)
    outside: list[list[str]] = [[] for _ in range(count)]
    missing: list[list[str]] = [[] for _ in range(count)]
    for name, values in columns.items():
        gaps = np.isnan(values)
        for i in np.flatnonzero(gaps).tolist():
            missing[i].append(name)
        filled = np.where(gaps, _filler(adopted, name, values), values)
        held[name] = free[name] = filled
        if name in ranges and name not in LABELLED:
            low, high = ranges[name]
            held[name] = np.clip(filled, low, high)
            slack = 1e-9 * max(abs(low), abs(high), 1.0)
            beyond = (np.abs(held[name] - filled) > slack) & ~gaps
            for i in np.flatnonzero(beyond).tolist():
                outside[i].append(name)
            # a filler is no observation: it may lie outside the range of those
            held[name] = np.where(gaps, filled, held[name])
    inside = _basis(effect, adopted, held)
    if unknown_ranges(adopted):
        inside = np.zeros_like(inside)
    return _Rows(inside, _basis(effect, adopted, free), outside, missing)


def _filler(adopted: AdoptedEffect, name: str, values: Floats) -> float:
    """What stands for a missing value: the reference, else the middle of the range.

    Where nobody knows whether a session belongs to the named line or block, it does not.
    """
    if name in LABELLED:
        return 1.0
    reference = dict(adopted.reference)
    ranges = {column: 0.5 * (low + high) for column, low, high in adopted.valid}
    if name in reference:
        return reference[name]
    if name in ranges and not without_reference(adopted):
        return ranges[name]
    present = values[~np.isnan(values)]
    return float(present.mean()) if present.size else 0.0


def _basis(effect: Effect, adopted: AdoptedEffect, columns: Mapping[str, Floats]) -> Floats:
    """Rows of the basis relative to the reference.

    A basis may refer to the mean of its columns, which in the difference of two rows drops out:
    each row is computed with the reference alone, whatever other sessions there are.
    """
    grid, reference = _grid(adopted), dict(adopted.reference)
    if effect.reference is None or not reference:
        return effect.basis(columns, **grid)
    count = len(next(iter(columns.values())))
    rows = np.empty((count, len(effect.coefficients)))
    for i in range(count):
        pair = {name: np.array([columns[name][i], reference[name]]) for name in columns}
        both = effect.basis(pair, **grid)
        rows[i] = both[0] - both[1]
    return rows


def _largest(
    effect: Effect,
    adopted: AdoptedEffect,
    columns: Mapping[str, Floats],
    at: tuple[int, _Rows],
    *,
    values: Floats,
) -> float:
    """Largest change of the correction of one row while its missing columns run over their range.

    Without a range the other sessions tell how large the effect becomes.
    """
    place, rows = at
    ranges = {name: (low, high) for name, low, high in adopted.valid}
    gaps = rows.missing[place]
    if any(name in LABELLED for name in gaps):
        return float(np.max(np.abs(values)))
    if any(name not in ranges for name in gaps) or without_reference(adopted):
        return float(np.max(np.abs(rows.free @ values), initial=0.0))
    steps = [np.linspace(*ranges[name], STEPS) for name in gaps]
    tried = np.array(list(itertools.product(*steps)))
    trial = {name: np.full(len(tried), columns[name][place]) for name in columns}
    trial |= {name: tried[:, k] for k, name in enumerate(gaps)}
    return float(np.max(np.abs((_basis(effect, adopted, trial) - rows.inside[place]) @ values)))


def _missing_warning(
    session: str, adopted: AdoptedEffect, missing: Sequence[str], excess: float
) -> ResultWarning:
    known = {name for name, _ in adopted.reference}
    where = (
        said("at its reference")
        if known.issuperset(missing)
        else said("in the middle of its range")
    )
    text = said(
        "session {session}: {missing} missing: the adopted effect {id} is taken as "
        '{where}, and the most that it may differ, {excess:.1f}", enters the sigma',
        session=session,
        missing=listed(missing),
        id=adopted.id,
        where=where,
        excess=excess * RHO_ARCSEC,
    )
    return ResultWarning("effect_outside_range", text, Subject.session(session))


def _outside_warning(
    session: str, adopted: AdoptedEffect, outside: Sequence[str], excess: float
) -> ResultWarning:
    ranges = {name: f"{name} {low:.6g} to {high:.6g}" for name, low, high in adopted.valid}
    beyond = said("beyond it the effect does not change: the sigma stays")
    if excess > 0.0:
        size = excess * RHO_ARCSEC
        beyond = said('what lies beyond, {size:.1f}", enters the sigma', size=size)
    text = said(
        "session {session} lies outside the range of the adopted effect {id} ({ranges}): the "
        "correction is that of the edge, and {beyond}",
        session=session,
        id=adopted.id,
        ranges=", ".join(ranges[name] for name in outside),
        beyond=beyond,
    )
    return ResultWarning("effect_outside_range", text, Subject.session(session))


def _root(adopted: AdoptedEffect) -> Floats:
    """Square root of the covariance of the coefficients, shape (p, p), in their own units."""
    if adopted.covariance:
        matrix = np.array(adopted.covariance, dtype=np.float64)
        values, vectors = np.linalg.eigh(0.5 * (matrix + matrix.T))
        return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)))
    return np.diag([sigma for _, _, sigma, _ in adopted.coefficients])
