"""Where every number of the block factorisation lives, found once per network.

A front is the dense matrix in which one node is eliminated: its own unknowns first, then the
unknowns of its boundary. Fronts of one round and one shape lie side by side in one buffer, so that
numeric work is a few array operations per batch.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surveyapp.core.leastsquares.equations import ElementGroup, Ints, Structure
from surveyapp.core.leastsquares.ordering import Order, elimination_order


@dataclass(frozen=True, slots=True)
class Batch:
    """Fronts of one round and shape.

    Parameters
    ----------
    own : int
        Unknowns eliminated in each front.
    unknowns : int array, shape (n, own + boundary)
        Own unknowns first.
    start : int
        Place of the first number of the first front in the buffer.
    parent_base, parent_size : int array, shape (n,)
        Place and order of the front that takes the update.
    parent_place : int array, shape (n, boundary)
        Place of each boundary unknown in the parent's front.
    """

    own: int
    unknowns: Ints
    start: int
    parent_base: Ints
    parent_size: Ints
    parent_place: Ints

    @property
    def shape(self) -> tuple[int, int, int]:
        """Shape of the batch's fronts."""
        n, size = self.unknowns.shape
        return n, size, size

    @property
    def stop(self) -> int:
        """Place behind the last number of the batch."""
        n, size = self.unknowns.shape
        return int(self.start + n * size * size)


@dataclass(frozen=True, slots=True)
class Plan:
    """Symbolic factorisation.

    Parameters
    ----------
    structure : Structure
    batches : tuple of Batch
        In order of elimination; the last one is the root.
    length : int
        Numbers in the buffer.
    front_of : int array, shape (count,)
        Front in which each unknown is eliminated.
    front_base, front_size : int array
        Place and order of each front.
    keys : int array
        Sorted ``front * count + unknown`` of all unknowns of all fronts.
    places : int array
        Place of that unknown within its front.
    """

    structure: Structure
    batches: tuple[Batch, ...]
    length: int
    front_of: Ints
    front_base: Ints
    front_size: Ints
    keys: Ints
    places: Ints

    def locate(self, unknowns: Ints) -> tuple[Ints, Ints, NDArray[np.bool_]]:
        """Front (n,), place in it (n, p) and whether it is there (n, p), for sets of unknowns."""
        missing = unknowns < 0
        padded = np.append(self.front_of, np.iinfo(np.int64).max)
        front = padded[unknowns].min(axis=1)
        front = np.where(front == np.iinfo(np.int64).max, 0, front)
        key = front[:, None] * self.structure.count + np.where(missing, 0, unknowns)
        found = np.minimum(np.searchsorted(self.keys, key), len(self.keys) - 1)
        if bool((~missing & (self.keys[found] != key)).any()):
            raise ValueError("these unknowns share no element: their cofactors are not computed")
        return front, self.places[found], ~missing


def _expand(nodes: Ints, structure: Structure) -> tuple[Ints, Ints]:
    """Unknowns of the nodes one after the other, and for each the index of its node."""
    sizes = structure.sizes[nodes]
    owner = np.repeat(np.arange(len(nodes), dtype=np.int64), sizes)
    within = np.arange(len(owner), dtype=np.int64) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    return structure.node_start[nodes][owner] + within, owner


def _round_fronts(
    chosen: Ints, boundary: tuple[Ints, Ints], structure: Structure, position: Ints
) -> list[tuple[int, Ints]]:
    """Own size and unknowns (n, d) of the fronts of one round, by shape."""
    start, lists = boundary
    owner = np.repeat(np.arange(len(chosen), dtype=np.int64), np.diff(start))
    order = np.lexsort((position[lists], owner))
    unknowns, index = _expand(lists[order], structure)
    owner = owner[order][index]
    counts = np.bincount(owner, minlength=len(chosen))
    first = np.cumsum(counts) - counts
    own = structure.sizes[chosen]
    shapes = []
    for size, width in np.unique(np.stack((own, counts)), axis=1).T:
        same = np.flatnonzero((own == size) & (counts == width))
        mine = structure.node_start[chosen[same]][:, None] + np.arange(size)
        rest = unknowns[first[same][:, None] + np.arange(width)]
        shapes.append((int(size), np.concatenate((mine, rest), axis=1)))
    return shapes


def make_plan(groups: Sequence[ElementGroup], structure: Structure) -> Plan:
    """Order the elimination and lay out all fronts.

    Parameters
    ----------
    groups : sequence of ElementGroup
        Only ``unknowns`` matters: the plan serves every iteration.
    structure : Structure

    Returns
    -------
    Plan
    """
    order = elimination_order(groups, structure)
    position = np.full(len(structure.sizes), len(order.rounds), dtype=np.int64)
    for number, chosen in enumerate(order.rounds):
        position[chosen] = number
    shapes = [
        shape
        for chosen, boundary in zip(order.rounds, order.boundaries, strict=True)
        for shape in _round_fronts(chosen, boundary, structure, position)
    ]
    root, _ = _expand(order.root, structure)
    shapes.append((len(root), root[None, :]))
    return _lay_out(shapes, structure, order)


def _lay_out(shapes: list[tuple[int, Ints]], structure: Structure, order: Order) -> Plan:
    counts = np.array([len(unknowns) for _, unknowns in shapes])
    widths = np.array([unknowns.shape[1] for _, unknowns in shapes])
    front_size = np.repeat(widths, counts)
    squares = front_size.astype(np.int64) ** 2
    front_base = np.cumsum(squares) - squares
    first = np.cumsum(counts) - counts
    front_of = np.zeros(structure.count, dtype=np.int64)
    keys, places = [], []
    for begin, (own, unknowns) in zip(first, shapes, strict=True):
        number = begin + np.arange(len(unknowns), dtype=np.int64)
        front_of[unknowns[:, :own]] = number[:, None]
        keys.append((number[:, None] * structure.count + unknowns).ravel())
        places.append(np.broadcast_to(np.arange(unknowns.shape[1]), unknowns.shape).ravel())
    all_keys = np.concatenate(keys)
    sorting = np.argsort(all_keys, kind="stable")
    plan = Plan(
        structure,
        (),
        int(squares.sum()),
        front_of,
        front_base,
        front_size,
        all_keys[sorting],
        np.concatenate(places)[sorting],
    )
    batches = tuple(
        _batch(plan, own, unknowns, int(front_base[begin]))
        for begin, (own, unknowns) in zip(first, shapes, strict=True)
    )
    return Plan(
        structure,
        batches,
        plan.length,
        front_of,
        front_base,
        front_size,
        plan.keys,
        plan.places,
    )


def _batch(plan: Plan, own: int, unknowns: Ints, start: int) -> Batch:
    boundary = unknowns[:, own:]
    if boundary.shape[1] == 0:
        none = np.zeros(len(unknowns), dtype=np.int64)
        return Batch(own, unknowns, start, none, none, boundary)
    front, place, _ = plan.locate(boundary)
    return Batch(own, unknowns, start, plan.front_base[front], plan.front_size[front], place)
