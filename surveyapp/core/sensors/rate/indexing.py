"""Attitude, heading and biases from a sensor turned about one axis at rest (indexing, maytagging).

Turning the sensor tells the biases of the two axes across the index axis from the earth; gravity
tells the level; and with the latitude known the earth's rotation leaves one unknown, the heading.
Everything is solved together by least squares from many beginnings, so that every heading that
fits is found; which of them is right is a matter of odds, never of the nearest root.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from surveyapp.core.sensors.rate.indexing_values import Indexed, Root, Setting, Stop
from surveyapp.core.statistics.distributions import NORMAL_95
from surveyapp_models.angles import wrap_pi
from surveyapp_models.arrays import Floats
from surveyapp_models.rate import quaternions
from surveyapp_models.rate.attitude import (
    attitude_matrix,
    axis_rotation,
    earth_rate,
)

ODDS_GAP = 2.0 * math.log(1e6)
"""Chi-square between two headings at posterior odds of a million: 27.6."""
BEGINNINGS = 24
SAME_HEADING = math.radians(0.5)
"""Solutions closer than this are one."""
FORCE_BIAS_PRIOR = 0.1
"""Standard deviation of an accelerometer bias before anything is known: 10 mg [m/s2]."""
_STEPS = 25
ATTITUDE, BIAS, FORCE_BIAS = slice(0, 3), slice(3, 6), slice(6, 8)
_UNKNOWNS = 8


CURVED = math.radians(1.0)
"""From this standard deviation on chi-square is no parabola in the heading any more [rad]."""
CONTRADICTING = 3.0
"""A misfit beyond this is no noise that was taken too small: something stated is wrong."""
UNDETERMINED_SIGMA = math.radians(30.0)
"""A heading with a larger standard deviation is none [rad]."""


def rotation_of(stop: Stop, axis: int) -> Floats:
    """Body at index angle 0 to the sensor at this stop, shape (3, 3).

    The sensor has turned clockwise, that is by minus the angle about the axis.
    """
    return axis_rotation(axis, -stop.angle).T


def solve_indexing(stops: Sequence[Stop], setting: Setting) -> Indexed:
    """Solve attitude and biases.

    Parameters
    ----------
    stops : sequence of Stop
        At least two different index angles.
    setting : Setting
    """
    turns = np.array([rotation_of(s, setting.axis) for s in stops])
    rate, rate_sigma = (np.array([getattr(s, n) for s in stops]) for n in ("rate", "rate_sigma"))
    force, force_sigma = (
        np.array([getattr(s, n) for s in stops]) for n in ("force", "force_sigma")
    )
    scale = _scatter(setting.matrix @ turns, rate, rate_sigma, setting.axis)
    rate_sigma = _with_index_error(rate, rate_sigma * scale, setting)
    force_sigma = force_sigma * _scatter(turns, force, force_sigma, setting.axis)
    problem = _System(turns, rate, rate_sigma, force, force_sigma, setting)
    found = problem.refined()
    misfit = _misfit(found, dof=6 * len(stops) - _UNKNOWNS)
    if misfit > 1.0:
        problem = replace(problem, rate_sigma=rate_sigma * misfit, force_sigma=force_sigma * misfit)
        found = problem.refined()
    roots = [problem.with_covariance(r) for r in _distinct(found)]
    if roots and roots[0].heading_sigma() > CURVED:
        roots[0] = replace(roots[0], profile_sigma=problem.profile(roots[0]))
    plane, sigma = problem.across()
    dof = 6 * len(stops) - _UNKNOWNS
    told = setting.bias_prior is not None or index_angles(stops) > 1
    verdict = _verdict(roots, told=told and misfit <= CONTRADICTING)
    return Indexed(tuple(roots), verdict, plane, sigma, scale, dof, misfit)


def _misfit(found: Sequence[Root], *, dof: int) -> float:
    """Factor by which the best attitude fits worse than its sigmas allow, where significant."""
    from surveyapp.core.statistics.distributions import chi_square_tail

    chi = min((root.chi_square for root in found), default=0.0)
    if dof < 1 or chi_square_tail(chi, dof) > 0.01:
        return 1.0
    return math.sqrt(chi / dof)


def index_angles(stops: Sequence[Stop]) -> int:
    """How many different index angles there are, to a tenth of a degree."""
    return len({round(math.degrees(s.angle) % 360.0, 1) % 360.0 for s in stops})


def _scatter(turns: Floats, rate: Floats, sigma: Floats, axis: int) -> float:
    """Factor by which stops scatter more than their samples allow, where that is significant."""
    from surveyapp.core.statistics.distributions import chi_square_tail

    design = np.concatenate([turns, np.tile(np.eye(3), (turns.shape[0], 1, 1))], axis=2)
    weighted = (design / sigma[:, :, None]).reshape(-1, 6)
    weighted = np.delete(weighted, 3 + axis, axis=1)
    target = (rate / sigma).ravel()
    solution, *_ = np.linalg.lstsq(weighted, target, rcond=None)
    rest = target - weighted @ solution
    dof = target.size - 5
    chi = float(rest @ rest)
    if dof < 2 or chi_square_tail(chi, dof) > 0.01:
        return 1.0
    return math.sqrt(chi / dof)


def _with_index_error(rate: Floats, sigma: Floats, setting: Setting) -> Floats:
    if setting.index_sigma == 0.0:
        return sigma
    across = np.delete(rate - rate.mean(axis=0), setting.axis, axis=1)
    size = math.sqrt(float(np.mean(np.sum(across**2, axis=1))))
    extra = np.full(3, size * setting.index_sigma)
    extra[setting.axis] = 0.0
    return np.asarray(np.hypot(sigma, extra))


@dataclass(frozen=True, slots=True)
class _System:
    """Observation equations of all stops, and the prior."""

    turns: Floats
    rate: Floats
    rate_sigma: Floats
    force: Floats
    force_sigma: Floats
    setting: Setting

    def beginnings(self) -> list[Floats]:
        """Attitudes level with gravity at headings all round, shape (3, 3) each."""
        felt = np.einsum("kji,kj->ki", self.turns, self.force).mean(axis=0)
        up = felt / np.linalg.norm(felt)
        pitch = math.asin(min(1.0, max(-1.0, float(up[1]))))
        roll = math.atan2(-float(up[0]), float(up[2]))
        step = 2.0 * math.pi / BEGINNINGS
        return [
            attitude_matrix(heading=k * step, pitch=pitch, roll=roll) for k in range(BEGINNINGS)
        ]

    def gravity(self) -> float:
        """Size of the specific force [m/s2]."""
        if self.setting.gravity is not None:
            return self.setting.gravity
        return float(np.mean(np.linalg.norm(self.force, axis=1)))

    def refined(self) -> list[Root]:
        """Levenberg and Marquardt from every beginning, all side by side."""
        attitude = np.array(self.beginnings())
        count = attitude.shape[0]
        linear, damping = np.zeros((count, 5)), np.full(count, 1e-3)
        design, rest = self._equations(attitude, linear)
        chi = np.einsum("bm,bm->b", rest, rest)
        busy = np.ones(count, dtype=bool)
        for _ in range(_STEPS):
            step = _damped(design[busy], rest[busy], damping[busy])
            turn = np.linalg.norm(step[:, ATTITUDE], axis=1)
            step = step * np.minimum(1.0, 0.5 / np.maximum(turn, 1e-300))[:, None]
            moved = _turned(attitude[busy], step[:, ATTITUDE])
            there = linear[busy] + step[:, 3:]
            next_design, next_rest = self._equations(moved, there)
            next_chi = np.einsum("bm,bm->b", next_rest, next_rest)
            better = next_chi <= chi[busy]
            rows = np.flatnonzero(busy)
            small = better & (chi[busy] - next_chi < 1e-9 * (1.0 + chi[busy])) & (turn < 1e-7)
            good = rows[better]
            attitude[good], linear[good] = moved[better], there[better]
            design[good], rest[good], chi[good] = (
                next_design[better],
                next_rest[better],
                next_chi[better],
            )
            damping[good] = np.maximum(damping[good] * 0.1, 1e-12)
            bad = rows[~better]
            damping[bad] = np.minimum(damping[bad] * 10.0, 1e6)
            busy[rows[small]] = False
            if not busy.any():
                break
        unknown = np.full((6, 6), np.nan)
        return [Root(attitude[k], linear[k, :3], float(chi[k]), unknown) for k in range(count)]

    def with_covariance(self, root: Root) -> Root:
        """The root with what its equations say of its certainty: no derivative has a bias."""
        design, _ = self._equations(root.attitude[None], np.zeros((1, 5)))
        return replace(root, covariance=_covariance(design[0]))

    def _equations(self, attitude: Floats, linear: Floats) -> tuple[Floats, Floats]:
        """Whitened designs (b, m, 8) and residuals (b, m) at attitudes (b, 3, 3) and biases."""
        axis = self.setting.axis
        earth = earth_rate(self.setting.latitude)
        up = np.array([0.0, 0.0, self.gravity()])
        many, count = attitude.shape[0], self.turns.shape[0]
        bias = linear[:, :3]
        others = [k for k in range(3) if k != axis]
        force_bias = np.zeros((many, 3))
        force_bias[:, others] = linear[:, 3:]
        # [b, k]: navigation frame to the sensor at stop k
        to_sensor = self.turns[None] @ attitude.transpose(0, 2, 1)[:, None]
        to_gyros = self.setting.matrix @ to_sensor
        design = np.zeros((many, 2, count, 3, _UNKNOWNS))
        design[:, 0, :, :, ATTITUDE] = to_gyros @ _skew(earth)
        design[:, 0, :, :, BIAS] = np.eye(3)
        design[:, 1, :, :, ATTITUDE] = to_sensor @ _skew(up)
        for column, k in enumerate(others):
            design[:, 1, :, k, 6 + column] = 1.0
        rest = np.stack(
            [
                self.rate - to_gyros @ earth - bias[:, None],
                self.force - to_sensor @ up - force_bias[:, None],
            ],
            axis=1,
        )
        sigma = np.stack([self.rate_sigma, self.force_sigma])
        rows = (design / sigma[..., None]).reshape(many, -1, _UNKNOWNS)
        values = (rest / sigma).reshape(many, -1)
        held = np.zeros((many, 2, _UNKNOWNS))
        held[:, :, FORCE_BIAS] = np.eye(2) / FORCE_BIAS_PRIOR
        rows = np.concatenate([rows, held], axis=1)
        values = np.concatenate([values, -linear[:, 3:] / FORCE_BIAS_PRIOR], axis=1)
        prior, spread = self.setting.bias_prior, self.setting.bias_prior_sigma
        if prior is None or np.all(spread <= 0.0):
            return rows, values
        extra = np.zeros((many, 3, _UNKNOWNS))
        extra[:, :, BIAS] = np.diag(1.0 / spread)
        return (
            np.concatenate([rows, extra], axis=1),
            np.concatenate([values, (prior - bias) / spread], axis=1),
        )

    def profile(self, root: Root) -> float:
        """Half the 95 % interval of the heading as a sigma, everything else free [rad].

        Used where an index axis level and east-west makes the fit blind to small turns.
        """
        ends = []
        for sign in (1.0, -1.0):
            inside, step = 0.0, math.radians(0.25)
            while inside < math.pi and self._held(root, sign * (inside + step)) < NORMAL_95**2:
                inside += step
                step *= 1.15
            ends.append(inside + 0.5 * step)
        return 0.5 * (ends[0] + ends[1]) / NORMAL_95

    def _held(self, root: Root, turn: float) -> float:
        """Increase of chi-square with the heading held at a turn from the root."""
        attitude, linear = _turned(root.attitude, np.array([0.0, 0.0, -turn])), np.zeros(5)
        linear[:3] = root.bias
        free = [0, 1, *range(3, _UNKNOWNS)]
        chi = math.inf
        for _ in range(4):
            designs, rests = self._equations(attitude[None], linear[None])
            design, rest = designs[0], rests[0]
            chi = min(chi, float(rest @ rest))
            size = np.maximum(np.linalg.norm(design[:, free], axis=0), 1e-12)
            part = np.linalg.lstsq(design[:, free] / size, rest, rcond=1e-10)[0] / size
            step = np.zeros(_UNKNOWNS)
            step[free] = part
            attitude, linear = _turned(attitude, step[ATTITUDE]), linear + step[3:]
        return chi - root.chi_square

    def across(self) -> tuple[float, float]:
        """Earth rate across the index axis from the two axes alone, and its sigma [rad/s]."""
        axis = self.setting.axis
        others = [k for k in range(3) if k != axis]
        rate = np.linalg.solve(self.setting.matrix, self.rate.T).T
        back = np.einsum("kji,kj->ki", self.turns, rate)[:, others]
        offset = np.einsum("kji->kij", self.turns)[:, others][:, :, others]
        count = back.shape[0]
        rows = np.concatenate([np.tile(np.eye(2), (count, 1, 1)), offset], axis=2).reshape(-1, 4)
        solution, *_ = np.linalg.lstsq(rows, back.ravel(), rcond=None)
        noise = float(np.mean(self.rate_sigma[:, others]))
        spread = noise * math.sqrt(float(np.linalg.pinv(rows.T @ rows)[0, 0]))
        return math.hypot(*solution[:2].tolist()), spread


def _skew(vector: Floats) -> Floats:
    x, y, z = vector.tolist()
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def _damped(design: Floats, rest: Floats, damping: Floats) -> Floats:
    """Steps of damped least squares for many problems, shape (b, p)."""
    size = np.maximum(np.linalg.norm(design, axis=1), 1e-12)
    scaled = design / size[:, None, :]
    normal = scaled.transpose(0, 2, 1) @ scaled
    normal += damping[:, None, None] * np.eye(design.shape[2])
    right = np.einsum("bmp,bm->bp", scaled, rest)
    return np.asarray(np.linalg.solve(normal, right[..., None])[..., 0] / size)


def _turned(attitude: Floats, rotation: Floats) -> Floats:
    """exp([rotation]) attitude: the body turned about axes of the navigation frame."""
    return np.asarray(quaternions.to_matrix(quaternions.from_rotation_vector(rotation)) @ attitude)


def _covariance(design: Floats) -> Floats:
    """Of attitude and gyro biases, shape (6, 6); what nothing tells has a huge variance."""
    size = np.maximum(np.linalg.norm(design, axis=0), 1e-300)
    _, s, right = np.linalg.svd(design / size, full_matrices=False)
    s = np.maximum(s, 1e-9 * s[0])
    whole = (right.T / s**2) @ right / np.outer(size, size)
    return np.asarray(whole[:6, :6])


def _distinct(found: list[Root]) -> list[Root]:
    roots: list[Root] = []
    for root in sorted(found, key=lambda r: r.chi_square):
        if all(_apart(root.attitude, other.attitude) > SAME_HEADING for other in roots):
            roots.append(root)
    if not roots:
        return []
    best = roots[0].chi_square
    return [r for r in roots if r.chi_square - best < 4.0 * ODDS_GAP][:4]


def _apart(one: Floats, other: Floats) -> float:
    """Angle between two attitudes [rad]."""
    cosine = 0.5 * (float(np.trace(one @ other.T)) - 1.0)
    return math.acos(min(1.0, max(-1.0, cosine)))


def _verdict(roots: Sequence[Root], *, told: bool) -> str:
    if not roots or not told or roots[0].heading_sigma() > UNDETERMINED_SIGMA:
        return "undetermined"
    rivals = [
        r
        for r in roots[1:]
        if r.chi_square - roots[0].chi_square < ODDS_GAP
        and abs(wrap_pi(r.heading - roots[0].heading)) > 3.0 * roots[0].heading_sigma()
    ]
    return "ambiguous" if rivals else "resolved"
