"""From the gyro azimuths of a line to its grid azimuth, with the budget by source.

grid = gyro azimuth + constant - deflection - convergence - arc_to_chord (design.md section 2).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from surveyapp.core.geodesy import (
    Azimuth,
    DeflectionTerm,
    Grid,
    Position,
    arc_to_chord,
    deflection_term,
)
from surveyapp.core.orientation.instrument_constant import Chosen
from surveyapp.core.orientation.terms import ALWAYS, TERMS
from surveyapp.core.statistics.repeated import Consistency, consistency, weights_of
from surveyapp.core.uncertain import Source, Uncertain, aligned, combine
from surveyapp.domain.mine_grid import StatedConvergence
from surveyapp.domain.project import Centring, Station, grid_bearing, grid_distance_m
from surveyapp.domain.results import AngleResult, BudgetLine, LineResult, Reference
from surveyapp.languages import said, term
from surveyapp_models.angles import wrap_two_pi

NOTHING = 1e-18
"""Share of a variance that is rounding of the arithmetic and no source of error."""


ZERO = Uncertain(0.0)


@dataclass(frozen=True, slots=True)
class LineGeometry:
    """What the Earth and the grid do to the azimuth of one line.

    Parameters
    ----------
    start, end : Station
    position : Position
        Of the occupied station.
    zenith : float
        Zenith angle of the target [rad].
    convergence, arc_to_chord : float or None
        [rad]; None without a grid (or, for the chord, without the target's position).
    distance_m : float or None
    from_south : bool
    convergence_error : Uncertain
        Zero with the uncertainty of the convergence: printed, or a rotation of the mine's grid.
    deflection_sources : mapping of Source to float
        Independent sources of each component of the deflection at the station [rad].
    """

    start: Station
    end: Station
    position: Position
    zenith: float
    convergence: float | None
    arc_to_chord: float | None
    distance_m: float | None
    from_south: bool
    convergence_error: Uncertain = ZERO
    deflection_sources: Mapping[Source, float] = field(default_factory=dict)

    def deflection(self, azimuth: float) -> DeflectionTerm | None:
        """Deflection term at an azimuth [rad], None without a latitude."""
        if self.position.latitude is None:
            return None
        return deflection_term(
            self.start.deflection,
            latitude=self.position.latitude,
            azimuth=azimuth,
            zenith=self.zenith,
        )

    def deflection_parts(self, azimuth: float) -> Uncertain:
        """The deflection correction with the uncertainty of the deflection itself [rad]."""
        term = self.deflection(azimuth)
        if term is None:
            return Uncertain(0.0)
        parts: dict[Source, float] = {}
        for source, sigma in self.deflection_sources.items():
            parts[replace(source, detail="xi")] = term.by_xi * sigma
            parts[replace(source, detail="eta")] = term.by_eta * sigma
        return Uncertain(term.value, parts)

    def centring(self, centring: Centring, *, own: str | None = None) -> Uncertain:
        """Zero with the uncertainty of centring.

        Sets on one line share their marks; ``own`` is the session that was centred anew.
        """
        if not self.distance_m:
            return Uncertain(0.0)
        sigma = math.hypot(centring.instrument_m, centring.target_m) / self.distance_m
        name = f"{self.start.name}-{self.end.name}"
        return Uncertain(0.0, {Source("centring", name if own is None else own): sigma})


def line_geometry(
    start: Station,
    end: Station,
    *,
    grid: Grid | None,
    positions: Mapping[str, Position],
    zenith: float | None,
    stated: StatedConvergence | None = None,
    deflection_sources: Mapping[Source, float] | None = None,
) -> LineGeometry:
    """Collect what position and grid say of a line.

    The zenith angle is the one read, else from the station heights, else 90 degrees; the
    convergence is that of the grid, else the one that the record states.
    """
    at, to = positions[start.name], positions[end.name]
    convergence = chord = None
    error = ZERO
    if grid is not None and at.latitude is not None and at.longitude is not None:
        convergence = grid.convergence(latitude=at.latitude, longitude=at.longitude)
        chord = arc_to_chord(grid, at, to)
        if grid.frame.sigma > 0.0:
            error = error.with_part(Source("rotation of the mine grid", "grid"), grid.frame.sigma)
    elif stated is not None:
        convergence = stated.value
        error = error.with_part(Source("printed convergence", start.name), stated.sigma)
    distance = grid_distance_m(
        Station(start.name, e=at.e, n=at.n), Station(end.name, e=to.e, n=to.n)
    )
    if zenith is None:
        zenith = 0.5 * math.pi
        if distance and start.h is not None and end.h is not None:
            zenith = math.atan2(distance, end.h - start.h)
    return LineGeometry(
        start=start,
        end=end,
        position=at,
        zenith=zenith,
        convergence=convergence,
        arc_to_chord=chord,
        distance_m=distance,
        from_south=grid is not None and grid.directions_from_south,
        convergence_error=error,
        deflection_sources=deflection_sources or {},
    )


def known_astronomic(
    geometry: LineGeometry, grid_azimuth: float, error: Uncertain
) -> Uncertain | None:
    """Astronomic azimuth [rad] of a line of known grid azimuth, None without a convergence.

    ``error`` is zero with the error of the known azimuth.
    """
    if geometry.convergence is None:
        return None
    geodetic = grid_azimuth + geometry.convergence + (geometry.arc_to_chord or 0.0)
    deflection = geometry.deflection_parts(geodetic)
    return Uncertain(geodetic) + deflection + geometry.convergence_error + error


@dataclass(frozen=True, slots=True)
class Round:
    """One survey session of a line, ready to be combined."""

    session: str
    azimuth: Uncertain
    chosen: Chosen
    rounds: int
    own_centring: str | None = None
    levelling: float | None = None


@dataclass(frozen=True, slots=True)
class OrientedLine:
    """A line with its error contributions still apart: for checks and for adjustment.

    ``without_constant`` is the gyro azimuth with the errors of deflection and convergence.
    """

    result: LineResult
    gyro: Uncertain
    true: Uncertain | None
    grid: Uncertain | None
    agreement: Consistency | None
    without_constant: Uncertain


def angle_result(item: Uncertain, reference: Reference | None = None) -> AngleResult:
    """A direction as it is reported."""
    return AngleResult(wrap_two_pi(item.value), item.sigma, item.interval95, item.dof, reference)


def orient_line(
    geometry: LineGeometry,
    rounds: Sequence[Round],
    *,
    instrument: str,
    centring: Centring,
    calibration_sessions: frozenset[str],
    agreement_of: Sequence[Uncertain],
) -> OrientedLine:
    """Combine all survey sessions of one line and carry them to the grid.

    Parameters
    ----------
    geometry : LineGeometry
    rounds : sequence of Round
        At least one; weights by the inverse variance of what is independent in each.
    instrument : str
    centring : Centring
    calibration_sessions : frozenset of str
        Ids whose contributions the budget counts as the constant's.
    agreement_of : sequence of Uncertain
        The rounds before any run-to-run scatter was added: for the test of their agreement.
    """
    azimuths = aligned(
        [item.azimuth + geometry.centring(centring, own=item.own_centring) for item in rounds]
    )
    weights = weights_of(azimuths)
    gyro = combine(zip(weights, azimuths, strict=True))
    constant = _constant(rounds, weights)
    true = None if constant is None else gyro + constant
    deflection = geometry.deflection_parts((true or gyro).value)
    grid = None if true is None else _on_grid(geometry, gyro, true, deflection)
    existing = grid_bearing(geometry.start, geometry.end)
    result = LineResult(
        station=geometry.start.name,
        target=geometry.end.name,
        instrument=instrument,
        rounds=sum(item.rounds for item in rounds),
        sessions=tuple(item.session for item in rounds),
        gyro_azimuth=angle_result(gyro, "GYRO"),
        constant=None if constant is None else constant.value,
        constant_sigma=None if constant is None else constant.sigma,
        constant_choice=_choices(rounds),
        true_azimuth=None if true is None else angle_result(true, "ASTRONOMIC"),
        deflection=deflection.value,
        convergence=geometry.convergence,
        arc_to_chord=geometry.arc_to_chord,
        levelling=_levelling(rounds, weights),
        grid_azimuth=None if grid is None else angle_result(grid),
        direction_from_south=(
            wrap_two_pi(grid.value + math.pi) if grid is not None and geometry.from_south else None
        ),
        budget=budget(grid or true or gyro, calibration_sessions),
        existing_azimuth=None if existing is None else wrap_two_pi(existing),
        distance_m=geometry.distance_m,
    )
    agreement = consistency([aligned(agreement_of)])
    alone = replace(gyro - deflection - geometry.convergence_error, value=gyro.value)
    return OrientedLine(result, gyro, true, grid, agreement, alone)


def _levelling(rounds: Sequence[Round], weights: Sequence[float]) -> float | None:
    """What level readings have moved the line by [rad]; None where none of its rounds has any."""
    if all(item.levelling is None for item in rounds):
        return None
    return math.fsum(w * (r.levelling or 0.0) for w, r in zip(weights, rounds, strict=True))


def _constant(rounds: Sequence[Round], weights: Sequence[float]) -> Uncertain | None:
    """Constant of all rounds together, None where one of them has none."""
    constants = [item.chosen.value for item in rounds if item.chosen.value is not None]
    if len(constants) < len(rounds):
        return None
    return combine(zip(weights, constants, strict=True))


def _choices(rounds: Sequence[Round]) -> str | None:
    names = dict.fromkeys(item.chosen.choice for item in rounds if item.chosen.choice)
    return " + ".join(names) or None


def _on_grid(
    geometry: LineGeometry, gyro: Uncertain, true: Uncertain, deflection: Uncertain
) -> Uncertain | None:
    """Carry the gyro azimuth of a line to the grid, None without one."""
    if geometry.convergence is None:
        return None
    moved = (
        Azimuth(gyro.value, "GYRO")
        .with_constant(true.value - gyro.value)
        .without_deflection(deflection.value)
        .to_grid(convergence=geometry.convergence, arc_to_chord=geometry.arc_to_chord or 0.0)
    )
    return replace(true - deflection - geometry.convergence_error, value=moved.value)


def budget(item: Uncertain, calibration_sessions: frozenset[str]) -> tuple[BudgetLine, ...]:
    """Variance of an azimuth by source, the largest first; shares sum to 1.

    Terms that nobody states stand at its end with zero: what is not counted is seen.
    """
    by_source: dict[tuple[str, bool], float] = {}
    for source, part in item.parts.items():
        key = source.name, source.entity in calibration_sessions
        by_source[key] = by_source.get(key, 0.0) + part * part
    total = math.fsum(by_source.values())
    if not 0.0 < total < math.inf:
        return ()
    ordered = sorted(by_source.items(), key=lambda entry: -entry[1])
    rows = [
        _budget_line(name, value, value / total, at_calibration=there)
        for (name, there), value in ordered
        if value > NOTHING * total
    ]
    named = {row.name for row in rows}
    rows += [_budget_line(name, 0.0, 0.0) for name in ALWAYS if name not in named]
    return tuple(rows)


def _budget_line(
    name: str, variance: float, share: float, *, at_calibration: bool = False
) -> BudgetLine:
    """A line whose source is a text: of a constant's terms the term is a text of its own."""
    told = said("constant: {name}", name=term(name)) if at_calibration else term(name)
    sigma, origin = math.sqrt(variance), TERMS.get(name, "")
    return BudgetLine(told, sigma, share, origin, name=name, at_calibration=at_calibration)
