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
from numpy.typing import NDArray

from surveyapp.core.simulate.specification import RUN_EFFECTS, Effect, SessionSpec
from surveyapp_models.gyro.integration import Disturbance, TapeTop
from surveyapp_models.gyro.moments import directive_moment, effective_inertia
from surveyapp_models.gyro.suspended import SuspendedGyro

FloatArray = NDArray[np.float64]
OfTime = Callable[[FloatArray], FloatArray]
"""Times of shape (), (runs, 1) or (runs, n) to values of each run, (runs, 1) or (runs, n)."""

PATH_STEPS = 16
"""Steps of a random path per half swing."""
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
    drawn: dict[str, FloatArray]


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
    gyro = damped_gyro(spec)
    moment = directive_moment(gyro, spec.latitude)
    stiffness = moment + (gyro.torsion if spec.clamped else 0.0)
    inertia = effective_inertia(gyro, spec.latitude)
    drawn: dict[str, FloatArray] = {}
    temperature = _temperature(spec, design, rng)
    shifts = [
        shift
        for effect in spec.effects
        if (shift := _shift(effect, spec, design, rng, drawn, temperature)) is not None
    ]

    def north_shift(t: FloatArray) -> FloatArray:
        total = np.zeros(np.broadcast_shapes(np.shape(t), (design.runs, 1)))
        for shift in shifts:
            total = total + shift(t)
        return total

    size = dict.fromkeys(
        ("quadratic_drag", "dry_friction", "amplitude_asymmetry", "one_sided_lag"), 0.0
    )
    for effect in spec.effects:
        if effect.id in size:
            size[effect.id] += effect.size
    first = spec.first_amplitude
    asymmetry = size["amplitude_asymmetry"] / first**2
    disturbance = Disturbance(
        torque=(lambda t: moment * north_shift(np.asarray(t))[:, 0]) if shifts else None,
        damping=_damping(spec, design, gyro, (rng, drawn)),
        quadratic_drag=0.75 * size["quadratic_drag"] * inertia / first,
        dry_friction=0.5 * size["dry_friction"] * stiffness,
        asymmetry=-3.0 * asymmetry * stiffness,
    )
    ratio = gyro.torsion / moment
    lag = size["one_sided_lag"] / ratio if ratio > 0.0 else 0.0
    return Disturbed(gyro, disturbance, lag, north_shift, temperature, asymmetry, drawn)


def tape_top(spec: SessionSpec, disturbed: Disturbed, zero_div: OfTime) -> TapeTop:
    """Return what the tape top does: follow or hold, with the drifting tape zero [div]."""

    def zero(t: float) -> FloatArray:
        return np.asarray(spec.scale_value * zero_div(np.asarray(t)))

    return TapeTop(
        mode="clamped" if spec.clamped else "tracking",
        clamp=spec.clamp_offset,
        zero=zero,
        eastward_lag=disturbed.eastward_lag,
    )


def _drawn_option(
    effect: Effect, name: str, drawn: dict[str, FloatArray], values: FloatArray
) -> FloatArray:
    """The option as given or by its default, else as drawn; kept for the truth; (runs, 1)."""
    given = effect.option(name)
    if given is None:
        kind = next(kind for kind in RUN_EFFECTS if kind.id == effect.id)
        given = dict(kind.options)[name]
    result = values if given is None else np.full_like(values, given)
    drawn[f"{effect.id}.{name}"] = result
    return result[:, None]


def _ramp(t: FloatArray, at: FloatArray, duration: float) -> FloatArray:
    """A step of finite duration, from 0 to 1."""
    return np.asarray(np.clip((t - at) / duration + 0.5, 0.0, 1.0))


def _place(effect: Effect, design: RunDesign, rng: np.random.Generator) -> FloatArray:
    """Where in the run, as a share of it: not near its ends, where nothing could be told."""
    margin = min(0.3, 3.0 / design.points)
    return rng.uniform(margin, 1.0 - margin, design.runs)


def _damping(
    spec: SessionSpec,
    design: RunDesign,
    gyro: SuspendedGyro,
    draw: tuple[np.random.Generator, dict[str, FloatArray]],
) -> Callable[[float], FloatArray] | None:
    rng, drawn = draw
    breaks = [effect for effect in spec.effects if effect.id == "damping_break"]
    if not breaks:
        return None
    changes = []
    for effect in breaks:
        at = _drawn_option(effect, "at", drawn, _place(effect, design, rng)) * design.length_s
        changed = dataclasses.replace(spec, ratio=spec.ratio - effect.size, effects=())
        changes.append((at[:, 0], damped_gyro(changed).damping - gyro.damping))

    def damping(t: float) -> FloatArray:
        total = np.full(design.runs, gyro.damping)
        for at, change in changes:
            duration = STEP_DURATION * design.half_swing_s
            total = total + change * _ramp(np.asarray(t), at, duration)
        return total

    return damping


def _shift(
    effect: Effect,
    spec: SessionSpec,
    design: RunDesign,
    rng: np.random.Generator,
    drawn: dict[str, FloatArray],
    temperature: OfTime,
) -> OfTime | None:
    """The shift of north by one effect as a function of time, None where it shifts nothing."""
    size, half = effect.size, design.half_swing_s
    if effect.id == "midpoint_drift":
        return lambda t: np.asarray(size * t / half)
    if effect.id == "midpoint_step":
        at = _drawn_option(effect, "at", drawn, _place(effect, design, rng)) * design.length_s
        return lambda t: size * _ramp(t, at, STEP_DURATION * half)
    if effect.id == "warm_up":
        tau = _drawn_option(effect, "tau", drawn, np.zeros(design.runs)) * half
        return lambda t: np.asarray(size * np.exp(-t / tau))
    if effect.id == "secondary_oscillation":
        longest = max(design.points / 1.6, 4.5)
        periods = rng.uniform(max(4.0, 0.5 * longest), longest, design.runs)
        rate = 2.0 * math.pi / (_drawn_option(effect, "period", drawn, periods) * half)
        phases = rng.uniform(0.0, 2.0 * math.pi, design.runs)
        phase = _drawn_option(effect, "phase", drawn, phases)
        return lambda t: np.asarray(size * np.cos(rate * t + phase))
    if effect.id == "temperature":
        return lambda t: size * (temperature(t) - spec.temperature_c)
    if effect.id == "random_walk":
        steps = rng.normal(size=_path_shape(design)) * size / math.sqrt(PATH_STEPS)
        return _path(np.cumsum(steps, axis=0), design)
    if effect.id == "autoregressive":
        rho = float(_drawn_option(effect, "rho", drawn, np.zeros(design.runs))[0, 0])
        return _path(size * _ornstein(rho ** (1.0 / PATH_STEPS), design, rng), design)
    return None


def _path_shape(design: RunDesign) -> tuple[int, int]:
    return (design.points + 4) * PATH_STEPS, design.runs


def _ornstein(rho: float, design: RunDesign, rng: np.random.Generator) -> FloatArray:
    """A stationary first-order Markov path of unit variance."""
    noise = rng.normal(size=_path_shape(design))
    path = np.empty_like(noise)
    path[0] = noise[0]
    gain = math.sqrt(1.0 - rho**2)
    for index in range(1, len(noise)):
        path[index] = rho * path[index - 1] + gain * noise[index]
    return path


def _path(path: FloatArray, design: RunDesign) -> OfTime:
    """Interpolate a path of shape (steps, runs) that begins two half swings before t = 0."""
    width = design.half_swing_s / PATH_STEPS
    runs = np.arange(design.runs)[:, None]

    def at(t: FloatArray) -> FloatArray:
        place = np.broadcast_to(t / width, np.broadcast_shapes(np.shape(t), (design.runs, 1)))
        place = np.clip(place + 2.0 * PATH_STEPS, 0.0, len(path) - 1.001)
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

    def at(t: FloatArray) -> FloatArray:
        total = np.zeros(np.broadcast_shapes(np.shape(t), (design.runs, 1)))
        for gain, rate, phase in zip(gains, rates, phases, strict=True):
            total = total + gain * (np.cos(rate * t + phase) - np.cos(phase))
        return spec.temperature_c + scale * total

    return at
