"""Approximate plane coordinates by itself: what a surveyor would compute by hand, step by step.

Known points orient their sets of directions; oriented sets and distances give polar points;
bearings pass along a traverse; what is left is intersected, resected or trilaterated. Where
nothing is oriented a local frame is built first and then laid on the known points. The result only
has to be good enough for the first linearisation.
"""

from __future__ import annotations

import cmath
import math
from collections import deque
from dataclasses import dataclass, field

from surveyapp.core.network.loci import Arc, Circle, Fix, Locus, Ray, construct
from surveyapp_models.angles import wrap_pi

Positions = dict[str, complex]


@dataclass(slots=True)
class Pencil:
    """Rays seen from one station with a common, perhaps unknown orientation [rad]."""

    station: str
    rays: dict[str, float]
    orientation: float | None = None
    absolute: bool = False


@dataclass(frozen=True, slots=True)
class Sights:
    """Everything that joins points in the plane.

    Parameters
    ----------
    pencils : tuple of Pencil
    distances : dict
        Horizontal distances [m] by point and neighbour, both ways.
    vectors : dict
        East + i north from a point to its neighbour, both ways.
    """

    pencils: tuple[Pencil, ...]
    distances: dict[str, dict[str, float]]
    vectors: dict[str, dict[str, complex]] = field(default_factory=dict)


class Sketch:
    """A growing set of positions; mutable, private to one construction."""

    def __init__(self, sights: Sights, known: Positions, variant: int = 0) -> None:
        self.sights = sights
        self.variant = variant
        self.guesses = 0
        self.positions: Positions = dict(known)
        self.orientation: dict[int, float] = {
            i: p.orientation for i, p in enumerate(sights.pencils) if p.orientation is not None
        }
        self.at: dict[str, list[int]] = {}
        self.seen_by: dict[str, list[int]] = {}
        for i, pencil in enumerate(sights.pencils):
            self.at.setdefault(pencil.station, []).append(i)
            for target in pencil.rays:
                self.seen_by.setdefault(target, []).append(i)
        self.queue: deque[str] = deque(known)
        for i in tuple(self.orientation):
            self._pass_on(i)

    def place(self, name: str, point: complex) -> None:
        """Put a point down and go on from there."""
        if name not in self.positions:
            self.positions[name] = point
            self.queue.append(name)

    def orient(self, number: int, value: float) -> None:
        """Orient a pencil, pass the bearings on, and use it."""
        if number in self.orientation:
            return
        self.orientation[number] = value
        self._pass_on(number)
        if self.sights.pencils[number].station in self.positions:
            self.queue.append(self.sights.pencils[number].station)

    def _pass_on(self, first: int) -> None:
        """A bearing A to B orients the pencils at B that see A: no coordinates are needed."""
        work = [first]
        while work:
            number = work.pop()
            pencil = self.sights.pencils[number]
            for target, reading in pencil.rays.items():
                back = self.orientation[number] + reading + math.pi
                for other in self.at.get(target, ()):
                    rays = self.sights.pencils[other].rays
                    if other not in self.orientation and pencil.station in rays:
                        self.orientation[other] = back - rays[pencil.station]
                        if target in self.positions:
                            self.queue.append(target)
                        work.append(other)

    def spread(self) -> None:
        """Place everything that orientation, distance and vectors give directly."""
        while self.queue:
            name = self.queue.popleft()
            here = self.positions[name]
            for target, vector in self.sights.vectors.get(name, {}).items():
                self.place(target, here + vector)
            for number in self.at.get(name, ()):
                self._orient_from(number, here)
                self._polar(number, name, here)
            for number in self.seen_by.get(name, ()):
                station = self.sights.pencils[number].station
                if number not in self.orientation and station in self.positions:
                    self._orient_from(number, self.positions[station])
                elif number in self.orientation and station not in self.positions:
                    self._backward(number, name, here)

    def _orient_from(self, number: int, here: complex) -> None:
        if number in self.orientation:
            return
        turns = []
        for target, reading in self.sights.pencils[number].rays.items():
            there = self.positions.get(target)
            if there is not None and there != here:
                gap = there - here
                turns.append((abs(gap), wrap_pi(math.atan2(gap.real, gap.imag) - reading)))
        if turns:
            reference = max(turns)[1]
            spread = sorted(wrap_pi(turn - reference) for _, turn in turns)
            self.orient(number, reference + spread[len(spread) // 2])

    def _polar(self, number: int, name: str, here: complex) -> None:
        orientation = self.orientation.get(number)
        distances = self.sights.distances.get(name)
        if orientation is None or distances is None:
            return
        for target, reading in self.sights.pencils[number].rays.items():
            if target not in self.positions and target in distances:
                bearing = orientation + reading
                step = complex(math.sin(bearing), math.cos(bearing)) * distances[target]
                self.place(target, here + step)

    def _backward(self, number: int, name: str, here: complex) -> None:
        """The station of an oriented pencil, from a known target and the distance to it."""
        pencil = self.sights.pencils[number]
        length = self.sights.distances.get(name, {}).get(pencil.station)
        if length is not None:
            bearing = self.orientation[number] + pencil.rays[name]
            self.place(
                pencil.station, here - complex(math.sin(bearing), math.cos(bearing)) * length
            )

    def loci(self, name: str) -> list[Locus]:
        """Everything that the placed points say about ``name``."""
        found: list[Locus] = []
        for number in self.seen_by.get(name, ()):
            pencil = self.sights.pencils[number]
            start, turn = self.positions.get(pencil.station), self.orientation.get(number)
            if start is not None and turn is not None:
                found.append(Ray(start, turn + pencil.rays[name]))
        for other, length in self.sights.distances.get(name, {}).items():
            if other in self.positions:
                found.append(Circle(self.positions[other], length))
        for number in self.at.get(name, ()):
            found += self._resection(number)
        return found

    def _resection(self, number: int) -> list[Locus]:
        pencil = self.sights.pencils[number]
        seen = [(t, r) for t, r in pencil.rays.items() if t in self.positions]
        turn = self.orientation.get(number)
        if turn is not None:
            return [Ray(self.positions[t], turn + r + math.pi) for t, r in seen]
        return [
            Arc(self.positions[a], self.positions[b], reading_b - reading_a)
            for (a, reading_a), (b, reading_b) in zip(seen, seen[1:] + seen[:1], strict=True)
            if a != b and self.positions[a] != self.positions[b]
        ]

    def candidates(self) -> list[str]:
        """Points that are joined to anything but not placed."""
        names = dict.fromkeys(self.seen_by) | dict.fromkeys(self.at)
        names |= dict.fromkeys(self.sights.distances)
        return [name for name in names if name not in self.positions]

    def grow(self, *, guess: bool = False) -> None:
        """Spread and construct until nothing more can be placed.

        Of two points that serve equally well one is taken only if ``guess`` and only where
        nothing certain is left; which one, the bits of ``variant`` say.
        """
        self.spread()
        while True:
            sure: list[tuple[str, complex]] = []
            doubtful: list[tuple[int, float, str, Fix]] = []
            for name in self.candidates():
                loci = self.loci(name)
                fix = construct(loci) if len(loci) >= 2 else None
                if fix is not None and fix.other is None:
                    sure.append((name, fix.point))
                elif fix is not None:
                    doubtful.append((-len(loci), fix.misfit, name, fix))
            if not sure and not (guess and doubtful):
                return
            for name, point in sure:
                self.place(name, point)
            if not sure:
                self._guess(min(doubtful, key=lambda item: item[:3]))
            self.spread()

    def _guess(self, choice: tuple[int, float, str, Fix]) -> None:
        _, _, name, fix = choice
        second = bool(self.variant >> self.guesses & 1) and fix.other is not None
        self.guesses += 1
        self.place(name, fix.other if second and fix.other is not None else fix.point)


def _seed(sights: Sights, sketch: Sketch) -> tuple[Positions, tuple[int, float] | None, bool]:
    """Where a local frame starts: positions, the pencil oriented in it, whether it has a scale."""
    best: tuple[int, int] | None = None
    for number, pencil in enumerate(sights.pencils):
        if all(t in sketch.positions for t in (pencil.station, *pencil.rays)):
            continue
        near = sights.distances.get(pencil.station, {})
        count = sum(target in near for target in pencil.rays)
        if best is None or count > best[0]:
            best = (count, number)
    if best is not None:
        count, number = best
        start = sights.pencils[number]
        if count:
            return {start.station: 0j}, (number, 0.0), True
        if not any(sights.distances.values()) and start.rays:
            target, reading = next(iter(start.rays.items()))
            unit = complex(math.sin(reading), math.cos(reading)) * 1000.0
            return {start.station: 0j, target: unit}, (number, 0.0), False
    for name in sketch.candidates():
        for other, length in sights.distances.get(name, {}).items():
            return {name: 0j, other: complex(length, 0.0)}, None, True
    return {}, None, True


def _frame(sights: Sights, sketch: Sketch) -> tuple[Sketch, bool] | None:
    """A local frame that joins points which the sketch could not place."""
    start, oriented, scaled = _seed(sights, sketch)
    if not start:
        return None
    loose = tuple(Pencil(p.station, p.rays) for p in sights.pencils)
    frame = Sketch(Sights(loose, sights.distances), start, sketch.variant >> sketch.guesses)
    if oriented is not None:
        frame.orient(*oriented)
    frame.grow()
    if not scaled or len(frame.positions) < 3:
        frame.grow(guess=True)
    return frame, scaled


def _lay_on(sketch: Sketch, frame: Sketch, *, scaled: bool) -> bool:
    """Shift, turn and (without distances) scale a local frame onto the sketch."""
    common = [name for name in frame.positions if name in sketch.positions]
    fresh = len(frame.positions) > len(common)
    if not fresh:
        return False
    turn = _transformation(sketch, frame, common, scaled=scaled)
    if turn is None:
        return False
    factor, here, there = turn
    for name, point in frame.positions.items():
        sketch.place(name, there + factor * (point - here))
    sketch.queue.extend(common)
    return True


def _transformation(
    sketch: Sketch, frame: Sketch, common: list[str], *, scaled: bool
) -> tuple[complex, complex, complex] | None:
    if not sketch.positions:
        turn = _absolute_turn(sketch, frame)
        return (cmath.exp(-1j * turn) if turn is not None else 1 + 0j), 0j, 0j
    if len(common) >= 2:
        here = sum(frame.positions[name] for name in common) / len(common)
        there = sum(sketch.positions[name] for name in common) / len(common)
        pairs = [(frame.positions[n] - here, sketch.positions[n] - there) for n in common]
        square = sum(abs(a) ** 2 for a, _ in pairs)
        factor = sum(b * a.conjugate() for a, b in pairs) / square if square else 0j
        if factor == 0:
            return None
        return (factor / abs(factor) if scaled else factor), here, there
    turn = _absolute_turn(sketch, frame)
    if len(common) == 1 and (turn is not None or len(sketch.positions) == 1) and scaled:
        factor = cmath.exp(-1j * (turn or 0.0))
        return factor, frame.positions[common[0]], sketch.positions[common[0]]
    return None


def _absolute_turn(sketch: Sketch, frame: Sketch) -> float | None:
    """Rotation of the frame from pencils whose true orientation is known."""
    for number, value in sketch.orientation.items():
        if number in frame.orientation:
            return value - frame.orientation[number]
    return None


def sketch_variants(sights: Sights, known: Positions) -> list[Positions]:
    """Find approximate positions of everything that the sights join to the known points.

    Parameters
    ----------
    sights : Sights
    known : dict
        Given positions, east + i north [m]; may be empty (then the frame is local).

    Returns
    -------
    list of dict
        The known and all further positions that could be found, the best fitting first; further
        ones where points had to be guessed of two that serve as well.
    """
    best = _attempt(sights, known, 0)
    found = [(-len(best.positions), _misfit(sights, best), best.positions)]
    variant = 1
    while variant < min(2 ** min(best.guesses, 5), MOST_VARIANTS):
        other = _attempt(sights, known, variant)
        found.append((-len(other.positions), _misfit(sights, other), other.positions))
        if -found[-1][0] > len(best.positions):
            best = other
        variant += 1
    found.sort(key=lambda item: item[:2])
    return [positions for count, _, positions in found if count == found[0][0]]


MOST_VARIANTS = 32
"""So many ways of resolving two-fold points are tried; the best fitting one is taken."""


def _attempt(sights: Sights, known: Positions, variant: int) -> Sketch:
    sketch = Sketch(sights, known, variant)
    if not known:
        _anywhere(sights, sketch)
    sketch.grow()
    for _ in range(len(sights.pencils) + len(sights.distances) + 1):
        if not sketch.candidates():
            break
        before = len(sketch.positions)
        built = _frame(sights, sketch)
        if built is not None and _lay_on(sketch, built[0], scaled=built[1]):
            sketch.guesses += built[0].guesses
            sketch.grow()
        if len(sketch.positions) == before:
            sketch.grow(guess=True)
        if len(sketch.positions) == before:
            break
    return sketch


def _anywhere(sights: Sights, sketch: Sketch) -> None:
    """Start an oriented network that is nowhere at 0, 0, so that its orientation is not lost."""
    if sights.vectors:
        sketch.place(next(iter(sights.vectors)), 0j)
    elif sketch.orientation:
        number, turn = next(iter(sketch.orientation.items()))
        pencil = sights.pencils[number]
        sketch.place(pencil.station, 0j)
        if not sights.distances:  # no scale either: the first sight is taken for 1000 m
            target, reading = next(iter(pencil.rays.items()))
            bearing = turn + reading
            sketch.place(target, 1000.0 * complex(math.sin(bearing), math.cos(bearing)))


def _misfit(sights: Sights, sketch: Sketch) -> float:
    """Sum of the misfits of all distances (each at most its own length) and oriented rays [m]."""
    total = 0.0
    for name, near in sights.distances.items():
        for other, length in near.items():
            if name in sketch.positions and other in sketch.positions:
                gap = abs(sketch.positions[name] - sketch.positions[other])
                total += min(abs(gap - length), length)
    for number, pencil in enumerate(sights.pencils):
        turn, here = sketch.orientation.get(number), sketch.positions.get(pencil.station)
        if turn is None or here is None:
            continue
        for target, reading in pencil.rays.items():
            if target in sketch.positions:
                total += Ray(here, turn + reading).misfit(sketch.positions[target])
    return total
