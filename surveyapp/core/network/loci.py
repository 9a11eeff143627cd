"""Where a point can lie after one observation: on a line, on a circle, on the arc of an angle.

Plane geometry only, in complex numbers east + i north. Used to find approximate coordinates; it
never adjusts anything.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass

from surveyapp_models.angles import wrap_pi

NEAR = 1e-9
"""Relative length below which two points of the construction coincide."""


@dataclass(frozen=True, slots=True)
class Ray:
    """The point lies in a known azimuth [rad] from a known point."""

    start: complex
    bearing: float

    def misfit(self, point: complex) -> float:
        """Distance by which ``point`` misses the ray [m]."""
        offset = point - self.start
        turn = wrap_pi(math.atan2(offset.real, offset.imag) - self.bearing)
        return abs(turn) * abs(offset)


@dataclass(frozen=True, slots=True)
class Circle:
    """The point lies at a known distance [m] from a known point."""

    centre: complex
    radius: float

    def misfit(self, point: complex) -> float:
        """Distance by which ``point`` misses the circle [m]."""
        return abs(abs(point - self.centre) - self.radius)


@dataclass(frozen=True, slots=True)
class Arc:
    """From the point, ``right`` stands clockwise from ``left`` by an angle [rad]."""

    left: complex
    right: complex
    angle: float

    def misfit(self, point: complex) -> float:
        """Misfit of the angle times the shorter side [m]."""
        a, b = self.left - point, self.right - point
        shorter = min(abs(a), abs(b))
        if shorter <= NEAR * abs(self.left - self.right):
            return math.inf
        seen = math.atan2(b.real, b.imag) - math.atan2(a.real, a.imag)
        return abs(wrap_pi(seen - self.angle)) * shorter


Locus = Ray | Circle | Arc


def _circle_of(arc: Arc) -> Circle | Ray | None:
    """Circle through both points on which the angle is seen (inscribed angle theorem)."""
    turn = cmath.exp(-2j * arc.angle)  # central angle, twice the inscribed one, clockwise
    if abs(1.0 - turn) < 1e-6:
        along = arc.right - arc.left
        return Ray(arc.left, math.atan2(along.real, along.imag))
    centre = (arc.right - turn * arc.left) / (1.0 - turn)
    return Circle(centre, abs(arc.left - centre))


def _ray_ray(first: Ray, second: Ray) -> list[complex]:
    a = complex(math.sin(first.bearing), math.cos(first.bearing))
    b = complex(math.sin(second.bearing), math.cos(second.bearing))
    cross = a.real * b.imag - a.imag * b.real
    if abs(cross) < 0.02:  # about 1 degree: a worse crossing is no approximation
        return []
    gap = second.start - first.start
    return [first.start + a * ((gap.real * b.imag - gap.imag * b.real) / cross)]


def _ray_circle(ray: Ray, circle: Circle) -> list[complex]:
    along = complex(math.sin(ray.bearing), math.cos(ray.bearing))
    gap = circle.centre - ray.start
    foot = (gap * along.conjugate()).real
    height = abs(gap - foot * along)
    half = math.sqrt(max(circle.radius**2 - height**2, 0.0))
    return [ray.start + (foot - half) * along, ray.start + (foot + half) * along]


def _circle_circle(first: Circle, second: Circle) -> list[complex]:
    gap = second.centre - first.centre
    length = abs(gap)
    if length <= NEAR * (first.radius + second.radius):
        return []
    along = (length**2 + first.radius**2 - second.radius**2) / (2.0 * length)
    half = math.sqrt(max(first.radius**2 - along**2, 0.0))
    unit = gap / length
    return [first.centre + unit * complex(along, half), first.centre + unit * complex(along, -half)]


def intersections(first: Locus, second: Locus) -> list[complex]:
    """Points that lie on both loci (none, one or two); not yet checked against either."""
    a = _circle_of(first) if isinstance(first, Arc) else first
    b = _circle_of(second) if isinstance(second, Arc) else second
    if a is None or b is None:
        return []
    if isinstance(a, Ray):
        return _ray_ray(a, b) if isinstance(b, Ray) else _ray_circle(a, b)
    return _ray_circle(b, a) if isinstance(b, Ray) else _circle_circle(a, b)


@dataclass(frozen=True, slots=True)
class Fix:
    """A constructed point, its misfit [m] and another point that serves as well, if there is."""

    point: complex
    misfit: float
    other: complex | None


MOST_LOCI = 8
"""So many loci are intersected pairwise; all of them judge the result."""


def construct(loci: Sequence[Locus]) -> Fix | None:
    """Best point from at least two loci.

    Parameters
    ----------
    loci : sequence of Locus

    Returns
    -------
    Fix or None
        The intersection with the smallest sum of misfits over all loci, which is the L1 choice and
        so does not follow a single gross error. ``other`` where a point elsewhere fits as well.
    """
    points: list[complex] = []
    few = loci[:MOST_LOCI]
    for i, locus in enumerate(few):
        for further in few[i + 1 :]:
            points += intersections(locus, further)
    judged = [(sum(locus.misfit(point) for locus in loci), point) for point in points]
    found = [item for item in judged if math.isfinite(item[0])]
    if not found:
        return None
    misfit, best = min(found, key=lambda item: item[0])
    size = max((_reach(locus, best) for locus in loci), default=1.0)
    if misfit > 0.3 * size:
        return None
    tolerance = max(10.0 * misfit, 1e-3 * size)
    rivals = [
        (other, point)
        for other, point in found
        if abs(point - best) > 0.05 * size and other <= tolerance
    ]
    rival = min(rivals, key=lambda item: item[0])[1] if rivals else None
    return Fix(best, misfit, rival)


def _reach(locus: Locus, point: complex) -> float:
    if isinstance(locus, Circle):
        return abs(locus.radius)
    return abs(point - (locus.start if isinstance(locus, Ray) else locus.left))
