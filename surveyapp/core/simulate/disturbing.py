"""How each disturbing effect acts on the motion: as a torque, a friction, a lag or a reading.

No effect is added to the readings as a column of a fitted model, except the gross error. A shift
of north by theta is the torque M theta; whatever follows from it (the kick that a sudden torque
gives to the amplitude, the way a swing smooths what changes within it) comes out of the equation
of motion.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from surveyapp.core.simulate.specification import RUN_EFFECTS, Effect, SessionSpec
from surveyapp_models.arrays import Floats
from surveyapp_models.gyro.integration import Disturbance, TapeTop
from surveyapp_models.gyro.moments import directive_moment, effective_inertia
from surveyapp_models.gyro.suspended import SuspendedGyro

OfTime = Callable[[Floats], Floats]
"""Times of shape (), (runs, 1) or (runs, n) to values of each run, (runs, 1) or (runs, n)."""

PATH_STEPS = 16
"""Steps of a random path per half swing."""
PATH_LEAD = 2
"""Half swings by which a random path is longer than the run at either end."""
STEP_DURATION = 0.01
"""Duration of a sudden change in half swings: a touch of the tripod lasts seconds, not zero."""


@dataclass(frozen=True, slots=True)
class RunDesign:
    """Times of a run that its effects need.

    Parameters
    ----------
    runs : int
    half_swing_s : float
        Half of the period in force [s].
    points : int
        Turning points; the first lies near t = 0.
    """

    runs: int
    half_swing_s: float
    points: int

    @property
    def length_s(self) -> float:
        """From the first to the last turning point [s]."""
        return (self.points - 1) * self.half_swing_s


@dataclass(frozen=True, slots=True)
class Disturbed:
    """A session's disturbances for an ensemble of runs.

    Parameters
    ----------
    gyro : SuspendedGyro
        With the damping of the session.
    disturbance : Disturbance
    eastward_lag : float
        Of the follow-up [rad].
    north_shift : callable
        Shift of gyro north theta(t) [rad].
    temperature_c : callable
        True temperature [degree Celsius].
    asymmetry : float
        Shift of the midpoint between turning points over the squared amplitude [1/rad].
    drawn : dict
        What was drawn at random, (runs,) each, by "effect.option".
    """

    gyro: SuspendedGyro
    disturbance: Disturbance
    eastward_lag: float
    north_shift: OfTime
    temperature_c: OfTime
    asymmetry: float
    drawn: dict[str, Floats]


@dataclass(frozen=True, slots=True)
class _Draw:
    """What the realisation of an effect needs; ``drawn`` collects the truth."""

    spec: SessionSpec
    design: RunDesign
    rng: np.random.Generator
    temperature: OfTime
    drawn: dict[str, Floats]


def damped_gyro(spec: SessionSpec) -> SuspendedGyro:
    """Return the session's gyro with the viscous damping that gives ``spec.ratio`` tracked."""
    decrement = -math.log(spec.ratio) / math.pi
    inertia = effective_inertia(spec.gyro, spec.latitude)
    stiffness = directive_moment(spec.gyro, spec.latitude)
    zeta = decrement / math.hypot(1.0, decrement)
    return dataclasses.replace(spec.gyro, damping=2.0 * zeta * math.sqrt(inertia * stiffness))


def disturb(spec: SessionSpec, design: RunDesign, rng: np.random.Generator) -> Disturbed:
    """Realise the effects of a session for an ensemble of runs.

    Parameters
    ----------
    spec : SessionSpec
    design : RunDesign
    rng : numpy.random.Generator
        Draws paths, places and phases, each run its own.

    Returns
    -------
    Disturbed
    """
    draw = _Draw(spec, design, rng, _temperature(spec, design, rng), {})
    gyro = damped_gyro(spec)
    moment = directive_moment(gyro, spec.latitude)
    shifts = [SHIFTS[effect.id](effect, draw) for effect in spec.effects if effect.id in SHIFTS]

    def north_shift(t: Floats) -> Floats:
        total = np.zeros(np.broadcast_shapes(np.shape(t), (design.runs, 1)))
        for shift in shifts:
            total = total + shift(t)
        return total

    first = spec.first_amplitude
    stiffness = moment + (gyro.torsion if spec.clamped else 0.0)
    asymmetry = total_size(spec, "amplitude_asymmetry") / first**2
    inertia = effective_inertia(gyro, spec.latitude)
    disturbance = Disturbance(
        torque=(lambda t: moment * north_shift(np.asarray(t))[:, 0]) if shifts else None,
        damping=_damping(gyro, draw),
        quadratic_drag=0.75 * total_size(spec, "quadratic_drag") * inertia / first,
        dry_friction=_friction(draw, stiffness),
        asymmetry=-3.0 * asymmetry * stiffness,
    )
    follows = not spec.clamped and gyro.torsion > 0.0
    lag = total_size(spec, "one_sided_lag") * moment / gyro.torsion if follows else 0.0
    return Disturbed(gyro, disturbance, lag, north_shift, draw.temperature, asymmetry, draw.drawn)


def total_size(spec: SessionSpec, identity: str) -> float:
    """Sum of the sizes of the effects of one kind."""
    return sum(effect.size for effect in spec.effects if effect.id == identity)


def _friction(draw: _Draw, stiffness: float) -> float | Callable[[float], Floats]:
    """Torque of dry friction, and of a follow-up that is uneven from half swing to half swing."""
    spec, design = draw.spec, draw.design
    steady = 0.5 * total_size(spec, "dry_friction") * stiffness
    jitter = total_size(spec, "tracking_jitter")
    if jitter == 0.0 or spec.clamped:
        return steady
    loss = jitter * draw.rng.normal(size=(design.points + 2 * PATH_LEAD, design.runs))

    def friction(t: float) -> Floats:
        return np.asarray(
            steady + 0.5 * stiffness * loss[int(t // design.half_swing_s) + PATH_LEAD]
        )

    return friction


def tripod_twist(spec: SessionSpec, time_s: ArrayLike, length_s: float) -> Floats:
    """Return by how much the tripod has turned clockwise against the middle of the run [rad]."""
    share = np.asarray(time_s, dtype=np.float64) / length_s - 0.5
    return np.asarray(total_size(spec, "tripod_twist") * share)


def tape_top(spec: SessionSpec, disturbed: Disturbed, zero_div: OfTime, length_s: float) -> TapeTop:
    """Return what the tape top does: follow or hold, with the drifting tape zero [div].

    A held top turns with the tripod; ``length_s`` is the time from first to last point.
    """

    def zero(t: float) -> Floats:
        twist = tripod_twist(spec, t, length_s) if spec.clamped else 0.0
        return np.asarray(spec.scale_value * zero_div(np.asarray(t)) + twist)

    return TapeTop(
        mode="clamped" if spec.clamped else "tracking",
        clamp=spec.clamp_offset,
        zero=zero,
        eastward_lag=disturbed.eastward_lag,
    )


def _drawn_option(effect: Effect, name: str, draw: _Draw, values: Floats) -> Floats:
    """The option as given or by its default, else as drawn; kept for the truth; (runs, 1)."""
    given = effect.option(name)
    if given is None:
        kind = next(kind for kind in RUN_EFFECTS if kind.id == effect.id)
        given = dict(kind.options)[name]
    result = values if given is None else np.full_like(values, given)
    draw.drawn[f"{effect.id}.{name}"] = result
    return result[:, None]


def _ramp(t: Floats, at: Floats, duration: float) -> Floats:
    """A step of finite duration, from 0 to 1."""
    return np.asarray(np.clip((t - at) / duration + 0.5, 0.0, 1.0))


def _moment(effect: Effect, draw: _Draw) -> Floats:
    """When a sudden change comes [s], not near the ends, where nothing could be told."""
    margin = min(0.3, 3.0 / draw.design.points)
    share = draw.rng.uniform(margin, 1.0 - margin, draw.design.runs)
    return _drawn_option(effect, "at", draw, share) * draw.design.length_s


def _damping(gyro: SuspendedGyro, draw: _Draw) -> Callable[[float], Floats] | None:
    """The viscous coefficient as a function of time, None where it does not change."""
    spec, design = draw.spec, draw.design
    changes = []
    for effect in spec.effects:
        if effect.id == "damping_break":
            changed = dataclasses.replace(spec, ratio=spec.ratio - effect.size, effects=())
            change = damped_gyro(changed).damping - gyro.damping
            changes.append((_moment(effect, draw)[:, 0], change))

    def damping(t: float) -> Floats:
        total = np.full(design.runs, gyro.damping)
        for at, change in changes:
            total = total + change * _ramp(np.asarray(t), at, STEP_DURATION * design.half_swing_s)
        return total

    return damping if changes else None


def _midpoint_drift(effect: Effect, draw: _Draw) -> OfTime:
    return lambda t: np.asarray(effect.size * t / draw.design.half_swing_s)


def _midpoint_step(effect: Effect, draw: _Draw) -> OfTime:
    at = _moment(effect, draw)
    duration = STEP_DURATION * draw.design.half_swing_s
    return lambda t: effect.size * _ramp(t, at, duration)


def _warm_up(effect: Effect, draw: _Draw) -> OfTime:
    tau = _drawn_option(effect, "tau", draw, np.zeros(draw.design.runs))
    tau_s = tau * draw.design.half_swing_s
    return lambda t: np.asarray(effect.size * np.exp(-t / tau_s))


def _secondary_oscillation(effect: Effect, draw: _Draw) -> OfTime:
    """Period from four half swings to the length of the run over 1.6, unless given."""
    design, rng = draw.design, draw.rng
    longest = max(design.points / 1.6, 4.5)
    periods = rng.uniform(max(4.0, 0.5 * longest), longest, design.runs)
    period_s = _drawn_option(effect, "period", draw, periods) * design.half_swing_s
    phases = rng.uniform(0.0, 2.0 * math.pi, design.runs)
    phase = _drawn_option(effect, "phase", draw, phases)
    return lambda t: np.asarray(effect.size * np.cos(2.0 * math.pi * t / period_s + phase))


def _by_temperature(effect: Effect, draw: _Draw) -> OfTime:
    return lambda t: effect.size * (draw.temperature(t) - draw.spec.temperature_c)


def _random_walk(effect: Effect, draw: _Draw) -> OfTime:
    """A walk that begins at zero at the first turning point."""
    steps = draw.rng.normal(size=_path_shape(draw.design)) / math.sqrt(PATH_STEPS)
    path = np.cumsum(steps, axis=0)
    return _path(effect.size * (path - path[PATH_LEAD * PATH_STEPS]), draw.design)


def _autoregressive(effect: Effect, draw: _Draw) -> OfTime:
    """A stationary first-order Markov path."""
    option = _drawn_option(effect, "rho", draw, np.zeros(draw.design.runs))
    rho = float(option[0, 0]) ** (1.0 / PATH_STEPS)
    noise = draw.rng.normal(size=_path_shape(draw.design))
    path = np.empty_like(noise)
    path[0] = noise[0]
    gain = math.sqrt(1.0 - rho**2)
    for index in range(1, len(noise)):
        path[index] = rho * path[index - 1] + gain * noise[index]
    return _path(effect.size * path, draw.design)


SHIFTS: dict[str, Callable[[Effect, _Draw], OfTime]] = {
    "midpoint_drift": _midpoint_drift,
    "midpoint_step": _midpoint_step,
    "warm_up": _warm_up,
    "secondary_oscillation": _secondary_oscillation,
    "temperature": _by_temperature,
    "random_walk": _random_walk,
    "autoregressive": _autoregressive,
}
"""Effects that shift gyro north in time; the others act on the swing or on a reading."""


def _path_shape(design: RunDesign) -> tuple[int, int]:
    return (design.points + 2 * PATH_LEAD) * PATH_STEPS, design.runs


def _path(path: Floats, design: RunDesign) -> OfTime:
    """Interpolate a path of shape (steps, runs) that begins ``PATH_LEAD`` half swings early."""
    width = design.half_swing_s / PATH_STEPS
    runs = np.arange(design.runs)[:, None]

    def at(t: Floats) -> Floats:
        place = np.broadcast_to(t / width, np.broadcast_shapes(np.shape(t), (design.runs, 1)))
        place = np.clip(place + PATH_LEAD * PATH_STEPS, 0.0, len(path) - 1.001)
        low = place.astype(np.intp)
        share = place - low
        return np.asarray((1.0 - share) * path[low, runs] + share * path[low + 1, runs])

    return at


def _temperature(spec: SessionSpec, design: RunDesign, rng: np.random.Generator) -> OfTime:
    """A temperature that wanders smoothly: three waves of the run's length and parts of it."""
    phases = rng.uniform(0.0, 2.0 * math.pi, (3, design.runs, 1))
    gains = rng.normal(size=(3, design.runs, 1)) * np.array([1.0, 0.7, 0.4])[:, None, None]
    rates = 2.0 * math.pi / max(design.length_s, 1.0) * np.array([0.6, 1.3, 2.4])
    scale = spec.temperature_span_c / math.sqrt(0.5 * (1.0 + 0.49 + 0.16))

    def at(t: Floats) -> Floats:
        total = np.zeros(np.broadcast_shapes(np.shape(t), (design.runs, 1)))
        for gain, rate, phase in zip(gains, rates, phases, strict=True):
            total = total + gain * (np.cos(rate * t + phase) - np.cos(phase))
        return spec.temperature_c + scale * total

    return at
