"""What a computed orientation answers of a rule book: one function per quantity.

Each returns measured values, or says what is missing. Nothing here knows a limit.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from itertools import combinations, pairwise
from typing import Final

from surveyapp.core.orientation.whole_project import Orientation
from surveyapp.core.swing.automatic import stated_rounds
from surveyapp.core.swing.session import ReducedSession, TargetReduction
from surveyapp.core.tolerance.evaluate import Measured
from surveyapp.core.tolerance.independent import independent_difference, independent_mean_sigma
from surveyapp.core.tolerance.quantities import quantity
from surveyapp.domain.readings import SWING_KINDS, Place, ReadingKind
from surveyapp_models.angles import RHO_ARCSEC, circular_mean, wrap_pi

Measure = Callable[[Orientation], list[Measured]]


def measure(orientation: Orientation) -> tuple[Measured, ...]:
    """Everything that an orientation answers, quantity by quantity."""
    return tuple(item for function in MEASURES.values() for item in function(orientation))


def _missing(identity: str, where: str, why: str = "") -> Measured:
    return Measured(identity, None, where, f"missing: {why or quantity(identity).needs}")


def _sights(
    orientation: Orientation,
) -> Iterator[tuple[tuple[str, str, str], ReducedSession, TargetReduction]]:
    """Every sighted target with the key of its side: station, target, instrument."""
    for item in orientation.sessions:
        for target in item.targets:
            yield (item.session.station, target.target, item.session.instrument), item, target


def _rounds(item: ReducedSession, target: TargetReduction) -> list[float] | None:
    """Gyro azimuth [rad] of every round of a session; None where only their mean is known."""
    session = item.session
    if target.gyro_azimuth is None:
        return []
    if session.method != "automatic":
        return [target.gyro_azimuth.value]
    if item.reduction.azimuth is not None:
        values = [
            row.value
            for row in session.book.of_kind(ReadingKind.AZIMUTH)
            if (row.target or session.target or "") == target.target and row.value is not None
        ]
    else:
        north = item.reduction.north
        reference = target.gyro_azimuth.value + (0.0 if north is None else north.value)
        values = [
            reference - row.value
            for row in session.book.of_kind(ReadingKind.NORTH)
            if row.value is not None
        ]
    return None if (stated_rounds(session) or 0) > len(values) else values


def largest_difference(values: list[float]) -> float:
    """Largest difference [rad] of any two directions."""
    return max(abs(wrap_pi(a - b)) for a, b in combinations(values, 2))


def rounds_difference(orientation: Orientation) -> list[Measured]:
    """Largest difference of any two rounds on one side."""
    name = "rounds_difference"
    sides: dict[tuple[str, str, str], list[float]] = {}
    means: set[tuple[str, str, str]] = set()
    for key, item, target in _sights(orientation):
        own = _rounds(item, target)
        sides.setdefault(key, []).extend(own or [])
        if own is None:
            means.add(key)
    found = []
    for key, values in sides.items():
        where = f"{key[0]}-{key[1]}"
        if len(values) > 1:
            text = f"{len(values)} rounds with {key[2]}"
            value = largest_difference(values) * RHO_ARCSEC
            found.append(Measured(name, value, where, text, {"n": float(len(values))}))
        else:
            why = "the book holds only the mean of the rounds" if key in means else ""
            found.append(_missing(name, where, why))
    return found


def calibration_means_difference(orientation: Orientation) -> list[Measured]:
    """Largest difference of two calibrations of one known side."""
    name = "calibration_means_difference"
    found = []
    for constant in orientation.constants:
        for line, _ in constant.lines:
            own = [item for item in constant.calibrations if item.line == line]
            if len(own) < 2:
                found.append(_missing(name, line, "a second calibration of this side"))
                continue
            value = largest_difference([item.value.value for item in own]) * RHO_ARCSEC
            found.append(Measured(name, value, line, f"{len(own)} calibrations"))
    return found


def calibration_epochs_difference(orientation: Orientation) -> list[Measured]:
    """Mean constant before against mean constant after, of each instrument."""
    name = "calibration_epochs_difference"
    found = []
    for constant in orientation.constants:
        groups = {
            phase: [c.value.value for c in constant.calibrations if c.phase == phase]
            for phase in ("before", "after")
        }
        where = constant.instrument.id
        if not all(groups.values()):
            if constant.calibrations:
                found.append(_missing(name, where))
            continue
        means = [circular_mean(values) for values in groups.values()]
        text = f"{len(groups['before'])} before, {len(groups['after'])} after"
        found.append(Measured(name, abs(wrap_pi(means[1] - means[0])) * RHO_ARCSEC, where, text))
    return found


def tape_zero(orientation: Orientation) -> list[Measured]:
    """Tape zero before and after of every session."""
    name = "tape_zero"
    found = []
    for item in orientation.sessions:
        zero = item.reduction.tape_zero
        if zero is None:
            if item.session.method != "automatic":
                found.append(_missing(name, item.session.id))
            continue
        for place, rest in (("before", zero.before), ("after", zero.after)):
            where = f"{item.session.id} {place}"
            if rest is None:
                found.append(_missing(name, where, f"tape_zero rows {place} the observation"))
            else:
                text = f"{rest.value_div:+.3f} div from {rest.points} turning points"
                found.append(Measured(name, abs(rest.value_div), where, text))
    return found


def tape_zero_change(orientation: Orientation) -> list[Measured]:
    """Tape zero after against before, of every session."""
    name = "tape_zero_change"
    found = []
    for item in orientation.sessions:
        zero = item.reduction.tape_zero
        if zero is not None and zero.before is not None and zero.after is not None:
            value = abs(zero.after.value_div - zero.before.value_div)
            found.append(Measured(name, value, item.session.id))
        elif item.session.method != "automatic":
            found.append(_missing(name, item.session.id))
    return found


def _pre_orientation(
    orientation: Orientation, name: str, methods: tuple[str, ...]
) -> list[Measured]:
    found = []
    for item in orientation.sessions:
        if item.session.method not in methods:
            continue
        book, north = item.session.book, item.reduction.north
        rows = [
            row
            for row in book.of_kind(ReadingKind.CLAMP)
            if row.value is not None and book.place_of(row) is Place.BEFORE
        ]
        if not rows or north is None or rows[0].value is None:
            found.append(_missing(name, item.session.id))
            continue
        value = abs(wrap_pi(rows[0].value - north.value)) * RHO_ARCSEC
        text = f"clamped at seq {rows[0].seq}"
        found.append(Measured(name, value, item.session.id, text))
    return found


def pre_orientation_tracking(orientation: Orientation) -> list[Measured]:
    """Distance of the alidade from gyro north before tracking."""
    return _pre_orientation(orientation, "pre_orientation_tracking", ("tracking",))


def pre_orientation_clamped(orientation: Orientation) -> list[Measured]:
    """Distance of the clamped alidade from gyro north."""
    return _pre_orientation(orientation, "pre_orientation_clamped", ("transit", "amplitude"))


def sights_difference(orientation: Orientation) -> list[Measured]:
    """Sights after against sights before, of every target of a session."""
    name = "sights_difference"
    found = []
    for _, item, target in _sights(orientation):
        if target.sights is None:
            continue
        where = f"{item.session.id} to {target.target}"
        if target.sights.drift is None:
            found.append(_missing(name, where))
        else:
            found.append(Measured(name, abs(target.sights.drift) * RHO_ARCSEC, where))
    return found


def _occupations(orientation: Orientation) -> dict[tuple[str, str], list[ReducedSession]]:
    """Sessions of one instrument at one station, where there are two or more."""
    groups: dict[tuple[str, str], list[ReducedSession]] = {}
    for item in orientation.sessions:
        groups.setdefault((item.session.station, item.session.instrument), []).append(item)
    return {key: items for key, items in groups.items() if len(items) > 1}


def rotor_rest(orientation: Orientation) -> list[Measured]:
    """Pause between two rounds at one station: an upper bound of the rotor's rest."""
    name = "rotor_rest"
    found = []
    for (station, _), items in _occupations(orientation).items():
        spans = []
        for item in items:
            times = [
                row.time.timestamp()
                for row in item.session.book.live
                if row.kind in SWING_KINDS and row.time is not None
            ]
            if times:
                spans.append((min(times), max(times), item.session.id))
        if len(spans) < len(items):
            found.append(_missing(name, station, "times on the rows of every round"))
            continue
        spans.sort()
        for earlier, later in pairwise(spans):
            text = f"after {earlier[2]}; the book does not show when the rotor stood"
            found.append(Measured(name, max(later[0] - earlier[1], 0.0), later[2], text))
    return found


def circle_spacing(orientation: Orientation) -> list[Measured]:
    """Smallest distance of the circle readings of north of the rounds at one station.

    The circle is divided anew after half a turn: two faces read opposite sides of it.
    """
    name = "circle_spacing"
    found = []
    for (station, _), items in _occupations(orientation).items():
        norths = [item.reduction.north.value for item in items if item.reduction.north is not None]
        if len(norths) < len(items):
            found.append(_missing(name, station))
            continue
        value = min(0.5 * abs(wrap_pi(2.0 * (a - b))) for a, b in combinations(norths, 2))
        n = float(len(norths))
        found.append(Measured(name, value * RHO_ARCSEC, station, f"{n:.0f} rounds", {"n": n}))
    return found


def _programme(orientation: Orientation, name: str, phase: str) -> list[Measured]:
    surveyed = {
        item.session.instrument for item in orientation.sessions if item.session.purpose == "survey"
    }
    found = []
    for constant in orientation.constants:
        where = constant.instrument.id
        if where not in surveyed:
            continue
        if not constant.calibrations:
            found.append(_missing(name, where, "calibration sessions"))
            continue
        rounds = sum(item.rounds for item in constant.calibrations if item.phase == phase)
        found.append(Measured(name, float(rounds), where))
    return found


def rounds_before(orientation: Orientation) -> list[Measured]:
    """Rounds on known sides before the first survey session."""
    return _programme(orientation, "rounds_before", "before")


def rounds_after(orientation: Orientation) -> list[Measured]:
    """Rounds on known sides after the last survey session."""
    return _programme(orientation, "rounds_after", "after")


def rounds_on_side(orientation: Orientation) -> list[Measured]:
    """Rounds on every side to be oriented."""
    return [
        Measured(
            "rounds_on_side",
            float(line.result.rounds),
            f"{line.result.station}-{line.result.target}",
        )
        for line in orientation.lines
    ]


def observers(orientation: Orientation) -> list[Measured]:
    """Number of observers of one instrument."""
    found = []
    for constant in orientation.constants:
        where = constant.instrument.id
        names = [
            item.session.observer.strip()
            for item in orientation.sessions
            if item.session.instrument == where
        ]
        if not names:
            continue
        if not all(names):
            found.append(_missing("observers", where))
            continue
        distinct = sorted(set(names))
        found.append(Measured("observers", float(len(distinct)), where, ", ".join(distinct)))
    return found


def level_excursion(orientation: Orientation) -> list[Measured]:
    """Largest excursion of the level bubble of every session, in its divisions."""
    name = "level_excursion"
    found = []
    for item in orientation.sessions:
        session = item.session
        rows = session.book.of_kind(ReadingKind.LEVEL_ALONG, ReadingKind.LEVEL_ACROSS)
        division = dict(session.override).get("level_division_arcsec")
        usable = isinstance(division, int | float) and not isinstance(division, bool)
        if not rows or not usable or not isinstance(division, int | float) or division <= 0:
            found.append(_missing(name, session.id))
            continue
        largest = max(abs(row.value) for row in rows if row.value is not None)
        found.append(Measured(name, largest * RHO_ARCSEC / float(division), session.id))
    return found


MEASURES: Final[Mapping[str, Measure]] = {
    "rounds_difference": rounds_difference,
    "calibration_means_difference": calibration_means_difference,
    "calibration_epochs_difference": calibration_epochs_difference,
    "independent_difference": independent_difference,
    "independent_mean_sigma": independent_mean_sigma,
    "tape_zero": tape_zero,
    "tape_zero_change": tape_zero_change,
    "pre_orientation_tracking": pre_orientation_tracking,
    "pre_orientation_clamped": pre_orientation_clamped,
    "sights_difference": sights_difference,
    "rotor_rest": rotor_rest,
    "circle_spacing": circle_spacing,
    "rounds_before": rounds_before,
    "rounds_after": rounds_after,
    "rounds_on_side": rounds_on_side,
    "observers": observers,
    "level_excursion": level_excursion,
}
"""Measures by quantity; those of traverses, plumbings and breakthroughs stand with them."""
