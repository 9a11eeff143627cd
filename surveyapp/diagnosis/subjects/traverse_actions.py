"""What can be observed next at a traverse: an angle again, a further gyro side, another instrument.

Every offer is an observation more. What it would read follows from the adjusted network; what an
effect does to it follows from the effect's own columns: a slip and a set-up beside the mark do not
recur, what belongs to an instrument recurs with it alone, a constant that has shifted stays
shifted. What is wanted is the azimuth of the least certain side.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from surveyapp.core.network.model import Model, compile_network
from surveyapp.core.network.observation_equations import linearised
from surveyapp.diagnosis.action import Kept, Linear, Plan, Point
from surveyapp.diagnosis.subjects.traverse_columns import observation_columns
from surveyapp.diagnosis.subjects.traverse_offers import Offer, offers_of, sides_of
from surveyapp.domain.observations import Observation, ObservationKind
from surveyapp.domain.traverse import Network
from surveyapp.languages import said
from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Columns, Effect

K = ObservationKind
RANK = 1e-6
"""Share of an offer's row that the network must determine, and of one row beside the others."""
SHORTLISTED = 1
"""Offers of a kind that are computed for separation, and as many for the interval."""


@dataclass(frozen=True, slots=True)
class Adjusted:
    """An adjusted network as the subject has it.

    Parameters
    ----------
    network : Network
    model : Model
    values : ndarray
        Adjusted values of all slots.
    whitener, design, right : ndarray, shape (n, n), (n, u), (n,)
    inverse : ndarray, shape (u, n)
        Of the design.
    transform : ndarray, shape (1 + r, n)
        The row of the least certain point, and an orthonormal base of what the unknowns leave.
    columns : mapping
        Of the observations.
    labels : mapping
        Names behind numbered columns.
    """

    network: Network
    model: Model
    values: Floats
    whitener: Floats
    design: Floats
    right: Floats
    inverse: Floats
    transform: Floats
    columns: Columns
    labels: Mapping[str, Mapping[float, str]]

    @property
    def conditions(self) -> Floats:
        """Orthonormal base of what the unknowns leave, shape (r, n)."""
        return np.asarray(self.transform[1:])


@dataclass(frozen=True, slots=True)
class TraversePlanner:
    """The conditions of a network and what its offers add.

    Parameters
    ----------
    adjusted : Adjusted
    effects : mapping
        By id, as they read the observations.
    offers : tuple of Offer
    jacobian : ndarray, shape (offers, u)
        Of the offers, per unit.
    more : mapping
        Columns of the offers, each of shape (offers,).
    azimuth : ndarray, shape (u,)
        Of the side that is wanted.
    wanted_name, unit : str
    scale, sigma : float
    """

    adjusted: Adjusted
    effects: Mapping[str, Effect]
    offers: tuple[Offer, ...]
    jacobian: Floats
    more: Mapping[str, Floats]
    azimuth: Floats
    wanted_name: str
    unit: str = "arcsec"
    scale: float = ARCSEC
    sigma: float = 1.0

    @property
    def y(self) -> Floats:
        """The conditions."""
        return np.asarray(self.adjusted.conditions @ self.adjusted.right)

    @property
    def flat(self) -> Floats:
        """Conditions have no unknowns: shape (r, 0)."""
        return np.zeros((len(self.adjusted.conditions), 0))

    def columns(self, effect: Effect, point: Point, /) -> Floats:
        """Columns of an effect in the conditions."""
        return np.asarray(self.adjusted.conditions @ self._whitened(effect, point))

    def largest(self, effect: Effect, point: Point, /) -> float:
        """What it does to the observation that it changes most."""
        return float(np.abs(self._whitened(effect, point)).max())

    def _whitened(self, effect: Effect, point: Point) -> Floats:
        own = self.effects[effect.id]
        return np.asarray(self.adjusted.whitener @ own.basis(self.adjusted.columns, **point))

    def _new(self, effect: Effect, point: Point) -> Floats:
        """Rows of an effect in every offer, in its sigmas, shape (offers, widest)."""
        own = self.effects[effect.id]
        found = np.zeros((len(self.offers), self.widest))
        if own.acts_on == "observation" or (own.event and own.per is None):
            return found
        rows = self.rows_of(own, point)
        recurs = np.array([not (o.other and own.per == "instrument") for o in self.offers])
        # what a gyro reads more, its constant is less
        signs = [-1.0 if o.made.kind is K.GYRO_CONSTANT else 1.0 for o in self.offers]
        factor = recurs * signs / np.array([o.made.sigma for o in self.offers])
        found[:, : rows.shape[1]] = factor[:, None] * rows
        return found

    def rows_of(self, own: Effect, point: Point) -> Floats:
        """Rows of the basis in every offer as if it alone were added, shape (offers, q)."""
        here = {name: self.adjusted.columns[name] for name in self.more}
        n = self.adjusted.right.size
        all_at_once = own.basis(
            {name: np.concatenate([here[name], new]) for name, new in self.more.items()}, **point
        )
        if np.allclose(all_at_once[:n], own.basis(here, **point), rtol=1e-12, atol=0.0):
            return np.asarray(all_at_once[n:])
        # a basis that looks at all rows, such as at their mean
        return np.stack(
            [
                own.basis(
                    {name: np.append(here[name], new[i]) for name, new in self.more.items()},
                    **point,
                )[-1]
                for i in range(len(self.offers))
            ]
        )

    def plans(self, kept: Sequence[Kept], /) -> list[Plan]:
        """The offers that promise most, at most two of a kind."""
        known: dict[tuple[object, ...], tuple[Floats, Floats]] = {}
        for item in kept:
            key = _key(item)
            if key in known:
                continue
            if item.effect is None:
                nothing = np.zeros((self.adjusted.right.size, self.widest))
                known[key] = nothing, np.zeros((len(self.offers), self.widest))
            else:
                own = self._padded(self._whitened(item.effect, item.point))
                known[key] = own, self._new(item.effect, item.point)
        columns = [known[_key(item)][0] for item in kept]
        new = np.stack([known[_key(item)][1] for item in kept])  # member, offer, coefficient
        chosen = self._shortlist(kept, columns, new)
        return [self._plan(i, kept, columns, new[:, i]) for i in chosen]

    @property
    def widest(self) -> int:
        """Most coefficients of an effect."""
        return max(len(effect.coefficients) for effect in self.effects.values())

    def _padded(self, columns: Floats) -> Floats:
        """Columns beside zeros, as many as the widest effect has."""
        found = np.zeros((len(columns), self.widest))
        found[:, : columns.shape[1]] = columns
        return found

    def _readings(self) -> Floats:
        """What the observations say of every offer, in its sigmas: shape (offers, n)."""
        sigma = np.array([offer.made.sigma for offer in self.offers])
        return np.asarray(self.jacobian @ self.adjusted.inverse / sigma[:, None])

    def _shortlist(self, kept: Sequence[Kept], columns: Sequence[Floats], new: Floats) -> list[int]:
        """Of each kind those whose reading the causes foretell most differently, or that narrow."""
        reads = self._readings()
        towards = self.azimuth @ self.adjusted.inverse
        noise = 1.0 + np.einsum("in,in->i", reads, reads)
        narrows = (reads @ towards) ** 2 / noise
        weights = np.array([item.weight for item in kept])
        means = [self._padded((item.mean * item.scale)[None])[0] for item in kept]
        foretold = np.array(
            [
                rows @ mean - reads @ (x @ mean)
                for rows, x, mean in zip(new, columns, means, strict=True)
            ]
        )
        share = weights / weights.sum()
        apart = (share @ foretold**2 - (share @ foretold) ** 2) / noise
        chosen: list[int] = []
        for kind in dict.fromkeys(offer.id for offer in self.offers):
            own = [i for i, offer in enumerate(self.offers) if offer.id == kind]
            for measure in (apart, narrows):
                best = sorted(own, key=lambda i: -float(measure[i]))[:SHORTLISTED]
                chosen += [i for i in best if i not in chosen]
        return chosen

    def _plan(
        self, offer: int, kept: Sequence[Kept], columns: Sequence[Floats], new: Floats
    ) -> Plan:
        """The conditions, what the network says of the offer and of the side, and the offer."""
        a = self.adjusted
        made = self.offers[offer]
        row = self.jacobian[offer] / made.made.sigma
        said_of = np.stack([self.azimuth @ a.inverse, row @ a.inverse])
        size = np.linalg.norm(said_of, axis=1, keepdims=True)
        left, singular, _ = np.linalg.svd((said_of / size).T, full_matrices=False)
        base = left[:, singular > RANK * singular[0]].T
        r, s = len(a.conditions), len(base)
        flat = np.zeros((r + s + 1, s))
        flat[r : r + s] = np.eye(s)
        flat[-1] = base @ said_of[1]
        within = np.vstack([a.conditions, base])
        count = [1 if item.effect is None else item.mean.size for item in kept]
        return Plan(
            made.id,
            made.text,
            np.asarray(within @ a.right),
            Linear(flat, r + s, base @ said_of[0]),
            tuple(
                np.vstack([within @ x, here[None]])[:, :q]
                for x, here, q in zip(columns, new, count, strict=True)
            ),
            tuple(np.zeros(q) for q in count),
        )


def _key(item: Kept) -> tuple[object, ...]:
    """What tells an effect at a grid point from others, whatever its size."""
    return item.unit, *item.point.values()


def planner_of(
    adjusted: Adjusted, effects: Sequence[Effect], gyro_sigma: float | None
) -> TraversePlanner | None:
    """What could be observed next; None where nothing is left to say.

    Parameters
    ----------
    adjusted : Adjusted
    effects : sequence of Effect
    gyro_sigma : float or None
        Standard deviation of a gyro azimuth of this office [rad], for a traverse without any.
    """
    network = adjusted.network
    offers = offers_of(network, gyro_sigma)
    sides = sides_of(network)
    asked = [Observation(K.AZIMUTH, at, to, 0.0, 1.0) for at, to in sides]
    whole = replace(
        network, observations=(*network.observations, *[o.made for o in offers], *asked)
    )
    model = compile_network(whole)
    if not np.array_equal(model.unknown_of, adjusted.model.unknown_of):
        return None
    first = len(network.observations)
    rows = {int(place): row for row, place in enumerate(model.used) if place >= first}
    jacobian = _jacobian(model, adjusted.values)
    known = [(o, rows[first + i]) for i, o in enumerate(offers) if first + i in rows]
    known = [item for item in known if _determined(adjusted, jacobian[item[1]])]
    wanted = [
        (side, jacobian[rows[place]])
        for place, side in enumerate(sides, start=first + len(offers))
        if place in rows and _determined(adjusted, jacobian[rows[place]])
    ]
    if not known or not wanted:
        return None
    spread = [float(np.linalg.norm(row @ adjusted.inverse)) for _, row in wanted]
    (at, to), azimuth = wanted[int(np.argmax(spread))]
    places = [row for _, row in known]
    columns = observation_columns(whole, model, adjusted.values).columns
    more = {name: values[places] for name, values in columns.items()}
    return TraversePlanner(
        adjusted=adjusted,
        effects={effect.id: effect for effect in effects},
        offers=tuple(offer for offer, _ in known),
        jacobian=jacobian[places],
        more=_of_gyros(adjusted, more, [offer for offer, _ in known]),
        azimuth=azimuth,
        wanted_name=said("the azimuth of {at}-{to}, the least certain side, at", at=at, to=to),
    )


def _jacobian(model: Model, values: Floats) -> Floats:
    """Partials of every observation by the unknowns, shape (rows, u)."""
    _, partials = linearised(model, values)
    unknowns = model.unknown_of[model.slots]
    found = np.zeros((len(model.value), model.structure.count))
    for place in range(partials.shape[1]):
        some = unknowns[:, place] >= 0
        np.add.at(found, (np.nonzero(some)[0], unknowns[some, place]), partials[some, place])
    return found


def _determined(adjusted: Adjusted, row: Floats) -> bool:
    """Whether the network determines what an offer would read, and does not hold it fixed."""
    size = float(np.linalg.norm(row))
    if not size > 0.0:
        return False
    back = row @ adjusted.inverse @ adjusted.design
    return float(np.linalg.norm(row - back)) < RANK * size


def _of_gyros(
    adjusted: Adjusted, more: dict[str, Floats], offers: Sequence[Offer]
) -> dict[str, Floats]:
    """A further gyro side comes after all others of its constant; sights turned back count so."""
    numbers = {name: float(i) for i, name in enumerate(adjusted.model.constants, start=1)}
    last = float(adjusted.columns["gyro_side"].max()) + 1.0
    names = [o.made.at if o.made.kind is K.GYRO_CONSTANT else o.made.constant for o in offers]
    group = np.array([numbers.get(name, 0.0) for name in names])
    turn = np.where([offer.reversed for offer in offers], -1.0, 1.0)
    turned = turn * more["sights_turned"]
    side = np.where(group > 0.0, last, 0.0)
    return {**more, "sights_turned": turned, "gyro_group": group, "gyro_side": side}
