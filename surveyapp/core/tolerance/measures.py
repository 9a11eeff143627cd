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
from surveyapp.core.tolerance.side_measures import gyro_side_length, gyro_side_sigma
from surveyapp.domain.readings import SWING_KINDS, Place, ReadingKind
from surveyapp.domain.subject import Subject
from surveyapp.languages import said
from surveyapp_models.angles import RHO_ARCSEC, circular_mean, wrap_pi

Measure = Callable[[Orientation], list[Measured]]


def measure(orientation: Orientation) -> tuple[Measured, ...]:
    """Everything that an orientation answers, quantity by quantity."""
    return tuple(item for function in MEASURES.values() for item in function(orientation))


def _found(
    identity: str,
    value: float,
    subject: Subject,
    text: str = "",
    *,
    n: float | None = None,
    where: str = "",
) -> Measured:
    variables = {} if n is None else {"n": n}
    return Measured(identity, value, where or subject.text, text, variables, subject=subject)


def _missing(identity: str, subject: Subject, why: str = "", *, where: str = "") -> Measured:
    text = said("missing: {why}", why=why or quantity(identity).needs)
    return Measured(identity, None, where or subject.text, text, subject=subject)


def _session(item: ReducedSession) -> Subject:
    return Subject.session(item.session.id)


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
        line = Subject.line(*key)
        if len(values) > 1:
            text = said("{values} rounds with {key}", values=len(values), key=key[2])
            value = largest_difference(values) * RHO_ARCSEC
            found.append(_found(name, value, line, text, n=float(len(values))))
        else:
            why = said("the book holds only the mean of the rounds") if key in means else ""
            found.append(_missing(name, line, why))
    return found


def calibration_means_difference(orientation: Orientation) -> list[Measured]:
    """Largest difference of two calibrations of one known side."""
    name = "calibration_means_difference"
    found = []
    for constant in orientation.constants:
        for line, _ in constant.lines:
            own = [item for item in constant.calibrations if item.line == line]
            subject = Subject.line(line.station, line.target, constant.instrument.id)
            if len(own) < 2:
                found.append(_missing(name, subject, said("a second calibration of this side")))
                continue
            value = largest_difference([item.value.value for item in own]) * RHO_ARCSEC
            found.append(_found(name, value, subject, said("{own} calibrations", own=len(own))))
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
        subject = Subject.of("instrument", constant.instrument.id)
        if not all(groups.values()):
            if constant.calibrations:
                found.append(_missing(name, subject))
            continue
        means = [circular_mean(values) for values in groups.values()]
        text = said(
            "{number} before, {number2} after",
            number=len(groups["before"]),
            number2=len(groups["after"]),
        )
        found.append(_found(name, abs(wrap_pi(means[1] - means[0])) * RHO_ARCSEC, subject, text))
    return found


def tape_zero(orientation: Orientation) -> list[Measured]:
    """Tape zero before and after of every session."""
    name = "tape_zero"
    found = []
    for item in orientation.sessions:
        zero = item.reduction.tape_zero
        if zero is None:
            if item.session.method != "automatic":
                found.append(_missing(name, _session(item)))
            continue
        for place, rest in (("before", zero.before), ("after", zero.after)):
            where = f"{item.session.id} {place}"
            if rest is None:
                why = said("tape_zero rows {place} the observation", place=place)
                found.append(_missing(name, _session(item), why, where=where))
            else:
                text = said(
                    "{value_div:+.3f} div from {points} turning points",
                    value_div=rest.value_div,
                    points=rest.points,
                )
                value = abs(rest.value_div)
                found.append(_found(name, value, _session(item), text, where=where))
    return found


def tape_zero_change(orientation: Orientation) -> list[Measured]:
    """Tape zero after against before, of every session."""
    name = "tape_zero_change"
    found = []
    for item in orientation.sessions:
        zero = item.reduction.tape_zero
        if zero is not None and zero.before is not None and zero.after is not None:
            value = abs(zero.after.value_div - zero.before.value_div)
            found.append(_found(name, value, _session(item)))
        elif item.session.method != "automatic":
            found.append(_missing(name, _session(item)))
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
            found.append(_missing(name, _session(item)))
            continue
        value = abs(wrap_pi(rows[0].value - north.value)) * RHO_ARCSEC
        text = said("clamped at seq {seq}", seq=rows[0].seq)
        found.append(_found(name, value, _session(item), text))
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
        subject = Subject.session(item.session.id, target.target)
        if target.sights.drift is None:
            found.append(_missing(name, subject))
        else:
            found.append(_found(name, abs(target.sights.drift) * RHO_ARCSEC, subject))
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
            why = said("times on the rows of every round")
            found.append(_missing(name, Subject.of("station", station), why))
            continue
        spans.sort()
        for earlier, later in pairwise(spans):
            text = said(
                "after {earlier}; the book does not show when the rotor stood", earlier=earlier[2]
            )
            pause = max(later[0] - earlier[1], 0.0)
            found.append(_found(name, pause, Subject.session(later[2]), text))
    return found


def _circle_place(item: ReducedSession) -> float | None:
    """Where on the circle a round was observed [rad]."""
    north = item.reduction.north
    return item.session.circle_shift if north is None else north.value


def circle_spacing(orientation: Orientation) -> list[Measured]:
    """Smallest distance of the circle readings of north of the rounds at one station.

    Where a method reads no north on the circle, the stated ``circle_shift`` of its rounds stands
    in. The circle is divided anew after half a turn: two faces read opposite sides of it.
    """
    name = "circle_spacing"
    found = []
    for (station, _), items in _occupations(orientation).items():
        norths = [place for item in items if (place := _circle_place(item)) is not None]
        subject = Subject.of("station", station)
        if len(norths) < len(items):
            found.append(_missing(name, subject))
            continue
        value = min(0.5 * abs(wrap_pi(2.0 * (a - b))) for a, b in combinations(norths, 2))
        n = float(len(norths))
        found.append(_found(name, value * RHO_ARCSEC, subject, said("{n:.0f} rounds", n=n), n=n))
    return found


def _programme(orientation: Orientation, name: str, phase: str) -> list[Measured]:
    surveyed = {
        item.session.instrument for item in orientation.sessions if item.session.purpose == "survey"
    }
    found = []
    for constant in orientation.constants:
        if constant.instrument.id not in surveyed:
            continue
        subject = Subject.of("instrument", constant.instrument.id)
        if not constant.calibrations:
            found.append(_missing(name, subject, said("calibration sessions")))
            continue
        rounds = sum(item.rounds for item in constant.calibrations if item.phase == phase)
        found.append(_found(name, float(rounds), subject))
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
        _found("rounds_on_side", float(line.result.rounds), line.result.subject)
        for line in orientation.lines
    ]


def observers(orientation: Orientation) -> list[Measured]:
    """Number of observers of one instrument."""
    found = []
    for constant in orientation.constants:
        subject = Subject.of("instrument", constant.instrument.id)
        names = [
            item.session.observer.strip()
            for item in orientation.sessions
            if item.session.instrument == subject.id
        ]
        if not names:
            continue
        if not all(names):
            found.append(_missing("observers", subject))
            continue
        distinct = sorted(set(names))
        found.append(_found("observers", float(len(distinct)), subject, ", ".join(distinct)))
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
            found.append(_missing(name, _session(item)))
            continue
        largest = max(abs(row.value) for row in rows if row.value is not None)
        found.append(_found(name, largest * RHO_ARCSEC / float(division), _session(item)))
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
    "gyro_side_length": gyro_side_length,
    "gyro_side_sigma": gyro_side_sigma,
    "observers": observers,
    "level_excursion": level_excursion,
}
"""Measures by quantity; those of traverses, plumbings and breakthroughs stand with them."""
