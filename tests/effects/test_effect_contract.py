"""One test over the whole catalogue: what every effect promises."""

from __future__ import annotations

import importlib
from collections import Counter
from collections.abc import Callable, Mapping

import numpy as np
import pytest

from surveyapp_models.effects import CATALOGUE
from surveyapp_models.effects.effect import Columns, Effect

IDS = [f"{effect.subject}.{effect.id}" for effect in CATALOGUE]
# Subjects whose columns this test knows how to make; other subjects bring their own test.
PLAIN = {"reversal_run", "campaign", "traverse"}


def columns_of(subject: str) -> Columns:
    generator = np.random.default_rng(5)
    if subject == "reversal_run":
        time = np.delete(np.arange(20.0), 7)
        return {
            "half_swing": time,
            "side": np.where(time % 2 == 0, -1.0, 1.0),
            "relative_amplitude": np.exp(-0.02 * time),
            "first_amplitude": np.full(19, 0.02),
            "decay": np.full(19, 0.02),
            "temperature_c": 20.0 + generator.normal(size=19),
        }
    if subject == "traverse":
        kind = np.arange(30) % 3
        gyro = (np.arange(30) % 10 == 9).astype(float)
        return {
            "distance_m": np.where(kind == 0, generator.uniform(30.0, 200.0, 30), 0.0),
            "sights_turned": (kind == 1).astype(float),
            "wall_length_m": np.where(kind == 1, generator.uniform(-90.0, 90.0, 30), 0.0),
            "gyro_side": gyro * np.cumsum(gyro),
            "gyro_group": gyro,
            "observation": np.arange(1.0, 31.0),
            "own_sigma": np.where(kind == 0, 0.002, 3e-5),
            "distance_temperature_c": np.where(kind == 0, generator.normal(15.0, 5.0, 30), 0.0),
            "prism": np.where(kind == 0, generator.integers(1, 4, 30), 0.0),
            **{
                f"by_{role}_{axis}": generator.normal(size=30)
                for role in ("station", "target", "backsight")
                for axis in ("east", "north")
            },
            "station": np.repeat(np.arange(1.0, 11.0), 3),
            "target": np.repeat(np.arange(2.0, 12.0), 3),
            "backsight": np.where(kind == 1, np.repeat(np.arange(0.0, 10.0), 3), 0.0),
            **{
                f"{role}_fixed": (np.arange(30) < 4).astype(float)
                for role in ("station", "target", "backsight")
            },
        }
    return {
        "elapsed_days": np.cumsum(generator.uniform(1.0, 20.0, 30)),
        "temperature_c": 15.0 + 5.0 * generator.normal(size=30),
        "latitude": np.radians(generator.uniform(30.0, 60.0, 30)),
        "line": generator.integers(0, 4, 30).astype(float),
        "block": np.repeat(np.arange(10.0), 3),
        "line_reading": generator.uniform(0.0, 6.28, 30),
        "north_reading": generator.uniform(0.0, 6.28, 30),
        "running_s": generator.uniform(60.0, 3600.0, 30),
        "observer": generator.integers(0, 3, 30).astype(float),
        "pressure_hpa": generator.uniform(950.0, 1030.0, 30),
        "humidity_percent": generator.uniform(20.0, 95.0, 30),
        "supply_v": generator.uniform(22.0, 28.0, 30),
        "transport_h": generator.uniform(0.5, 72.0, 30),
    }


def test_ids_are_unique_within_their_subject() -> None:
    assert max(Counter((e.subject, e.id) for e in CATALOGUE).values()) == 1


@pytest.mark.parametrize("effect", CATALOGUE, ids=IDS)
def test_the_id_is_the_name_of_its_file_which_holds_nothing_else(effect: Effect) -> None:
    module = importlib.import_module(f"surveyapp_models.effects.{effect.subject}.{effect.id}")
    assert module.EFFECT is effect


@pytest.mark.parametrize("effect", CATALOGUE, ids=IDS)
def test_everything_a_surveyor_reads_is_there(effect: Effect) -> None:
    for text in ("title", "datum", "source", "remedy", "symptom", "separate_by"):
        assert getattr(effect, text).strip(), text
    for coefficient in effect.coefficients:
        assert coefficient.low < coefficient.high
        assert coefficient.low <= 0.0 <= coefficient.high, "zero = absent lies in the range"
        assert coefficient.scale > 0.0
        assert coefficient.unit
        assert coefficient.meaning
    assert not effect.one_sided or effect.coefficients[0].low == 0.0
    known = {e.id for e in CATALOGUE if e.subject == effect.subject}
    assert set(effect.confusable_with) <= known - {effect.id}


@pytest.mark.parametrize(
    "effect",
    [e for e in CATALOGUE if e.subject in PLAIN],
    ids=[i for i in IDS if i.split(".")[0] in PLAIN],
)
def test_the_basis_is_pure_finite_and_needs_only_what_it_declares(effect: Effect) -> None:
    columns = columns_of(effect.subject)
    n = next(iter(columns.values())).size
    only = {c.name: columns[c.name] for c in effect.needs}
    before = {name: values.copy() for name, values in only.items()}
    points = effect.grid_points(only)
    assert points
    for point in points:
        first = effect.basis(only, **point)
        assert first.shape == (n, len(effect.coefficients))
        assert np.isfinite(first).all()
        assert np.ptp(first, axis=0).min() > 0.0, "a column that does not vary explains nothing"
        np.testing.assert_array_equal(first, effect.basis(only, **point))
        assert 0 <= effect.searched(point) <= len(effect.grid)
        if effect.at_datum is not None:
            for text, row in effect.at_datum(only, {}, **point):
                assert text
                assert len(row) == len(effect.coefficients)
    for name, values in before.items():
        np.testing.assert_array_equal(values, only[name])


def relative(
    effect: Effect, columns: Columns, state: Mapping[str, float], point: Mapping[str, float]
) -> np.ndarray:
    """Rows of a basis relative to a state; no state = as they are."""
    if not state:
        return effect.basis(columns, **point)
    basis = effect.basis({n: np.append(v, state[n]) for n, v in columns.items()}, **point)
    return np.asarray(basis[:-1] - basis[-1])


@pytest.mark.parametrize(
    "effect", [e for e in CATALOGUE if e.subject == "campaign"], ids=lambda e: e.id
)
def test_an_adopted_effect_of_a_campaign_depends_on_one_session_alone(effect: Effect) -> None:
    # relative to its reference a row of the basis is the same in any company
    columns = {c.name: columns_of("campaign")[c.name] for c in effect.needs}
    few = {name: values[3:9] for name, values in columns.items()}
    for point in effect.grid_points(columns):
        state = {} if effect.reference is None else effect.reference(columns, {}, **point)
        assert set(state) <= set(columns)
        whole = relative(effect, columns, state, point)
        np.testing.assert_allclose(relative(effect, few, state, point), whole[3:9], atol=1e-9)
        if effect.at_datum is not None:  # the reference is the state that the result is told at
            _, row = effect.at_datum(columns, {}, **point)[-1]
            told = effect.basis(columns, **point) - np.array(row)
            np.testing.assert_allclose(whole, told, atol=1e-9)


@pytest.mark.parametrize("effect", [e for e in CATALOGUE if e.law is not None], ids=lambda e: e.id)
def test_an_amplitude_law_starts_as_exponential_and_its_basis_is_its_derivative(
    effect: Effect,
) -> None:
    assert effect.law is not None
    columns = columns_of(effect.subject)
    time, first, decay = (columns[c] for c in ("half_swing", "first_amplitude", "decay"))
    for point in effect.grid_points(columns):
        zero = effect.law(time, first, decay, np.zeros(1), **point)
        np.testing.assert_allclose(zero, first * np.exp(-decay * time), rtol=1e-12)
        step = 1e-6 * effect.coefficients[0].scale
        up = effect.law(time, first, decay, np.array([step]), **point)
        down = effect.law(time, first, decay, np.array([-step]), **point)
        slope = columns["side"] * (up - down) / (2.0 * step)
        tangent = effect.basis(columns, **point)[:, 0]
        np.testing.assert_allclose(tangent, slope, rtol=1e-5, atol=1e-9)


@pytest.mark.parametrize("k", [0.0, 1e-9, 0.03])
def test_the_amplitude_laws_solve_their_differential_equations(k: float) -> None:
    # An independent route: Runge-Kutta on a' = -k a - b a^2 and a' = -k a - c.
    laws = {e.id: e.law for e in CATALOGUE if e.law is not None}
    b, c, first = 0.8, 1e-4, 0.02
    losses: tuple[tuple[str, Callable[[float], float]], ...] = (
        ("quadratic_drag", lambda a: -k * a - b * a * a),
        ("dry_friction", lambda a: -k * a - c),
    )
    for identity, loss in losses:
        a, h = first, 0.01
        for _ in range(1000):
            k1 = loss(a)
            k2 = loss(a + 0.5 * h * k1)
            k3 = loss(a + 0.5 * h * k2)
            k4 = loss(a + h * k3)
            a += h * (k1 + 2 * k2 + 2 * k3 + k4) / 6.0
        law = laws[identity]
        assert law is not None
        value = b if identity == "quadratic_drag" else c
        closed = law(np.array([10.0]), np.array([first]), np.array([k]), np.array([value]))
        assert closed[0] == pytest.approx(a, rel=1e-9)


def test_an_effect_that_contradicts_itself_is_refused() -> None:
    good = CATALOGUE[0]
    with pytest.raises(ValueError, match="exactly one coefficient"):
        Effect(
            **{f: getattr(good, f) for f in good.__slots__}
            | {"coefficients": good.coefficients * 2}
        )
    with pytest.raises(ValueError, match="belong together"):
        Effect(**{f: getattr(good, f) for f in good.__slots__} | {"acts_on": "midpoint"})
