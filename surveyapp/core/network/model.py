"""A network as arrays: which slot of the value vector and which unknown every observation touches.

Slots are the e, n, h of every point (three each, in the order of the points), then the gyro
constants, then one orientation per set of directions. A slot that is fixed or unused has no
unknown. Unknowns are numbered station by station, orientations beside the coordinates of their
station: position and orientation together separate a traverse, and eliminating whole stations is
what keeps the factorisation of a long chain accurate (differences of neighbouring points would
lose a digit with every doubling of the length).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from surveyapp.core.leastsquares.equations import Ints, Structure
from surveyapp.core.network.linearise import OFFSETS, WITH_HEIGHTS
from surveyapp.domain.observations import ANGULAR, CorrelatedBlock, Observation, ObservationKind
from surveyapp.domain.traverse import Network, Status
from surveyapp_models.arrays import Floats

NDBool = NDArray[np.bool_]
WIDEST = 6
"""Most slots that one observation touches."""


@dataclass(frozen=True, slots=True)
class BlockShape:
    """Correlated blocks of one shape.

    Parameters
    ----------
    rows : int array, shape (n, k)
    slots : int array, shape (n, p)
        Union of the slots of each block, padded with -1.
    place : int array, shape (n, k, WIDEST)
        Place of each row's slot in the union, p where there is none.
    root : float array, shape (n, k, k)
        Cholesky factors of the covariances.
    """

    rows: Ints
    slots: Ints
    place: Ints
    root: Floats


@dataclass(frozen=True, slots=True)
class Model:
    """The compiled network.

    Parameters
    ----------
    observations : tuple of Observation
        Used ones; constants known beforehand are appended as ``gyro_constant``.
    used : int array
        Places of the used ones in ``Network.observations`` (-1 for the appended ones).
    skipped : tuple of int
        Places of those that touch a coordinate with which the network does not deal.
    by_kind : tuple of (ObservationKind, int array)
        Rows of each kind.
    slots : int array, shape (rows, WIDEST)
    constant, value, sigma : float array, shape (rows,)
    angular : bool array, shape (rows,)
    independent : tuple of int array
        Rows outside blocks, by kind.
    blocks : tuple of BlockShape
    unknown_of : int array, shape (slots + 1,)
        Unknown of each slot, -1 = none; the last entry serves slot -1.
    slot_of : int array, shape (unknowns,)
    structure : Structure
    datum_unknowns : int array
        Unknown coordinates that carry the datum.
    constants : tuple of str
        Name of each constant slot.
    orientations : tuple of (str, str)
        at and set of each orientation slot.
    station_of : int array, shape (orientations,)
        Place of the station of each orientation among the points.
    pairs : int array, shape (n, 3)
        Rows of angles that are written as two directions, with the rows of these
        (``angle_pairs``).
    """

    observations: tuple[Observation, ...]
    used: Ints
    skipped: tuple[int, ...]
    by_kind: tuple[tuple[ObservationKind, Ints], ...]
    slots: Ints
    constant: Floats
    value: Floats
    sigma: Floats
    angular: NDBool
    independent: tuple[Ints, ...]
    blocks: tuple[BlockShape, ...]
    unknown_of: Ints
    slot_of: Ints
    structure: Structure
    datum_unknowns: Ints
    constants: tuple[str, ...]
    orientations: tuple[tuple[str, str], ...]
    station_of: Ints
    pairs: Ints = field(default_factory=lambda: np.empty((0, 3), dtype=np.int64))

    @property
    def coordinate_slots(self) -> int:
        """Number of slots that are coordinates."""
        return len(self.unknown_of) - 1 - len(self.orientations) - len(self.constants)


def _select(network: Network) -> tuple[list[Observation], list[int], list[int]]:
    """Used observations with their places, and the places of the skipped ones."""
    usable = {
        point.name: tuple(status is not Status.UNUSED for _, _, status in point.components())
        for point in network.points
    }
    used: list[Observation] = []
    places, skipped = [], []
    for place, obs in enumerate(network.observations):
        for who, component in OFFSETS[obs.kind]:
            name = obs.at if who == "at" else obs.to if who == "to" else obs.back
            if not usable[name][component]:
                skipped.append(place)
                break
        else:
            used.append(obs)
            places.append(place)
    for known in network.constants:
        if known.sigma is not None:
            kind = ObservationKind.GYRO_CONSTANT
            used.append(Observation(kind, known.name, "", known.value, known.sigma))
            places.append(-1)
    return used, places, skipped


def _slots(
    used: Sequence[Observation], number: dict[str, int], shared: dict[tuple[str, str], int]
) -> Ints:
    slots = np.full((len(used), WIDEST), -1, dtype=np.int64)
    for row, obs in enumerate(used):
        kind = obs.kind
        at = 3 * number.get(obs.at, 0)
        to = 3 * number.get(obs.to, 0)
        if kind is ObservationKind.ANGLE:
            back = 3 * number[obs.back]
            slots[row] = (at, at + 1, back, back + 1, to, to + 1)
        elif kind is ObservationKind.DIRECTION:
            slots[row, :5] = (at, at + 1, to, to + 1, shared[obs.at, obs.set])
        elif kind is ObservationKind.GYRO:
            slots[row, :5] = (at, at + 1, to, to + 1, shared["", obs.constant])
        elif kind is ObservationKind.GYRO_CONSTANT:
            slots[row, 0] = shared["", obs.at]
        else:
            for place, (who, component) in enumerate(OFFSETS[kind]):
                slots[row, place] = (at if who == "at" else to) + component
    return slots


def _constant(obs: Observation) -> float:
    """Known part of the computed value."""
    if obs.kind in WITH_HEIGHTS:
        return obs.ht - obs.hi
    return obs.convergence if obs.kind is ObservationKind.GYRO else 0.0


def _shared_slots(
    network: Network, used: Sequence[Observation]
) -> tuple[tuple[tuple[str, str], ...], tuple[str, ...], dict[tuple[str, str], int]]:
    sets = dict.fromkeys((obs.at, obs.set) for obs in used if obs.kind is ObservationKind.DIRECTION)
    names = dict.fromkeys(
        obs.constant or obs.at
        for obs in used
        if obs.kind in (ObservationKind.GYRO, ObservationKind.GYRO_CONSTANT)
    )
    first = 3 * len(network.points)
    shared = {("", name): first + i for i, name in enumerate(names)}
    first += len(names)
    shared.update({key: first + i for i, key in enumerate(sets)})
    return tuple(sets), tuple(names), shared


def number_unknowns(
    status: Sequence[Status], constants: int, station_of: Ints
) -> tuple[Ints, Ints, Structure, Ints]:
    """Unknown of each slot, slot of each unknown, structure, unknowns that carry the datum.

    Parameters
    ----------
    status : sequence of Status
        Of every coordinate slot.
    constants : int
        Number of gyro constants.
    station_of : int array
        Place of the station of each orientation.
    """
    slots = len(status)
    free = np.flatnonzero([item in (Status.FREE, Status.CONSTRAINED) for item in status])
    nuisance = slots + np.arange(constants + len(station_of), dtype=np.int64)
    owner = np.concatenate(
        (free // 3, slots + np.arange(constants, dtype=np.int64), station_of)
    ).astype(np.int64)
    every = np.concatenate((free, nuisance)).astype(np.int64)
    order = np.argsort(owner, kind="stable")
    slot_of = every[order]
    unknown_of = np.full(slots + len(nuisance) + 1, -1, dtype=np.int64)
    unknown_of[slot_of] = np.arange(len(slot_of))
    _, sizes = np.unique(owner, return_counts=True)
    start = np.concatenate(([0], np.cumsum(sizes))).astype(np.int64)
    held = np.flatnonzero([item is Status.CONSTRAINED for item in status])
    return unknown_of, slot_of, Structure(len(slot_of), start), unknown_of[held]


def _block_shapes(
    blocks: Sequence[tuple[list[int], Floats]], slots: Ints
) -> tuple[BlockShape, ...]:
    shapes: dict[tuple[int, int], list[tuple[list[int], Ints, Floats]]] = {}
    for rows, covariance in blocks:
        union = np.unique(slots[rows])
        union = union[union >= 0]
        root = np.asarray(np.linalg.cholesky(covariance), dtype=np.float64)
        shapes.setdefault((len(rows), len(union)), []).append((rows, union, root))
    result = []
    for (_, width), members in shapes.items():
        rows_array = np.array([rows for rows, _, _ in members], dtype=np.int64)
        unions = np.array([union for _, union, _ in members], dtype=np.int64)
        place = np.full((*rows_array.shape, WIDEST), width, dtype=np.int64)
        for i, (rows, union, _) in enumerate(members):
            mine = slots[rows]
            place[i] = np.where(mine >= 0, np.searchsorted(union, mine), width)
        root_array = np.array([root for _, _, root in members])
        result.append(BlockShape(rows_array, unions, place, root_array))
    return tuple(result)


def _used_blocks(
    blocks: Sequence[CorrelatedBlock], row_of: dict[int, int]
) -> list[tuple[list[int], Floats]]:
    """Blocks reduced to the used observations (a part of a covariance matrix is one again)."""
    reduced = []
    for block in blocks:
        keep = [i for i, member in enumerate(block.members) if member in row_of]
        if keep:
            covariance = np.asarray(block.covariance)[np.ix_(keep, keep)]
            reduced.append(([row_of[block.members[i]] for i in keep], covariance))
    return reduced


def compile_network(network: Network) -> Model:
    """Turn a network into arrays.

    Parameters
    ----------
    network : Network

    Returns
    -------
    Model
    """
    used, places, skipped = _select(network)
    number = {point.name: i for i, point in enumerate(network.points)}
    sets, constants, shared = _shared_slots(network, used)
    slots = _slots(used, number, shared)
    station_of = np.array([number[at] for at, _ in sets], dtype=np.int64)
    status = [item for point in network.points for _, _, item in point.components()]
    unknown_of, slot_of, structure, datum = number_unknowns(status, len(constants), station_of)
    row_of = {place: row for row, place in enumerate(places) if place >= 0}
    blocks = _block_shapes(_used_blocks(network.blocks, row_of), slots)
    kinds: dict[ObservationKind, list[int]] = {}
    for row, obs in enumerate(used):
        kinds.setdefault(obs.kind, []).append(row)
    by_kind = tuple((kind, np.array(rows, dtype=np.int64)) for kind, rows in kinds.items())
    correlated = np.zeros(len(used), dtype=bool)
    for shape in blocks:
        correlated[shape.rows] = True
    independent = tuple(rows[~correlated[rows]] for _, rows in by_kind)
    return Model(
        observations=tuple(used),
        used=np.array(places, dtype=np.int64),
        skipped=tuple(skipped),
        by_kind=by_kind,
        slots=slots,
        constant=np.array([_constant(obs) for obs in used]),
        value=np.array([obs.value for obs in used]),
        sigma=np.array([obs.sigma for obs in used]),
        angular=np.array([obs.kind in ANGULAR for obs in used], dtype=bool),
        independent=tuple(rows for rows in independent if len(rows)),
        blocks=blocks,
        unknown_of=unknown_of,
        slot_of=slot_of,
        structure=structure,
        datum_unknowns=datum,
        constants=constants,
        orientations=sets,
        station_of=station_of,
    )
