"""Elimination order: rounds of nodes of low degree that do not touch each other.

All nodes of a round are eliminated at once by array operations, which is why the order is made of
independent sets and not of single nodes. A node that touches very many others (a gyro constant
shared by a whole network) never has a low degree and so ends in the root: the border of the
matrix. Works on the graph only, never on numbers of the equations.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surveyapp.core.leastsquares.equations import ElementGroup, Ints, Structure

ROOT_UNKNOWNS = 96
"""Below this many unknowns a dense matrix is quicker than further rounds (measured, not tuned)."""
SLACK = 4
"""How far above the smallest degree a node may still be eliminated in the same round."""

PAIRS_AT_ONCE = 2_000_000
"""Pairs of unknowns handled by one array operation: bounds the memory."""


@dataclass(frozen=True, slots=True)
class Order:
    """Result of the symbolic elimination.

    Parameters
    ----------
    rounds : tuple of int array
        Nodes eliminated together, in order.
    boundaries : tuple of (int array, int array)
        For each round the neighbours of its nodes: start of each node's list, and the lists.
    root : int array
        Nodes left for one dense matrix.
    """

    rounds: tuple[Ints, ...]
    boundaries: tuple[tuple[Ints, Ints], ...]
    root: Ints


def graph_edges(groups: Sequence[ElementGroup], structure: Structure) -> Ints:
    """Pairs of nodes that share an element, as u * nodes + v with u < v, sorted, unique."""
    nodes = len(structure.sizes)
    node_of = np.append(structure.node_of, -1)
    keys = [np.empty(0, dtype=np.int64)]
    for group in groups:
        touched = np.sort(node_of[group.unknowns], axis=1)
        touched = touched[:, (touched >= 0).any(axis=0)]
        first, second = np.triu_indices(touched.shape[1], 1)
        step = max(1, PAIRS_AT_ONCE // max(len(touched), 1))
        for begin in range(0, len(first), step):
            u = touched[:, first[begin : begin + step]]
            v = touched[:, second[begin : begin + step]]
            different = (u < v) & (u >= 0)
            keys.append(np.unique(u[different] * nodes + v[different]))
    return np.unique(np.concatenate(keys))


def _independent(degree: Ints, alive: Ints, edges: tuple[Ints, Ints], rank: Ints) -> Ints:
    """Nodes of low degree, no two of them neighbours."""
    smallest = int(degree[alive].min())
    limit = smallest + max(SLACK, smallest // 4)
    candidate = np.zeros(len(degree), dtype=bool)
    candidate[alive] = degree[alive] <= limit
    chosen = np.zeros(len(degree), dtype=bool)
    u, v = edges
    key = degree * np.int64(len(degree)) + rank
    for _ in range(2):
        both = candidate[u] & candidate[v]
        cu, cv = u[both], v[both]
        loser = np.where(key[cu] > key[cv], cu, cv)
        winners = candidate.copy()
        winners[loser] = False
        chosen |= winners
        blocked = winners.copy()
        blocked[v[winners[u]]] = True
        blocked[u[winners[v]]] = True
        candidate &= ~blocked
    return np.flatnonzero(chosen)


def _neighbours(nodes: int, chosen: Ints, edges: tuple[Ints, Ints]) -> tuple[Ints, Ints]:
    """Start of each chosen node's list of neighbours, and the lists one after the other."""
    u, v = edges
    place = np.full(nodes, -1, dtype=np.int64)
    place[chosen] = np.arange(len(chosen))
    source = np.concatenate((place[u], place[v]))
    target = np.concatenate((v, u))
    keep = source >= 0
    source, target = source[keep], target[keep]
    order = np.argsort(source, kind="stable")
    counts = np.bincount(source, minlength=len(chosen))
    return np.concatenate(([0], np.cumsum(counts))), target[order]


def _clique_keys(nodes: int, start: Ints, lists: Ints) -> Ints:
    """Keys of all pairs within each list of neighbours: the fill."""
    keys = [np.empty(0, dtype=np.int64)]
    counts = np.diff(start)
    for size in np.unique(counts):
        if size < 2:
            continue
        first = start[:-1][counts == size]
        members = lists[first[:, None] + np.arange(size)]
        i, j = np.triu_indices(int(size), 1)
        low = np.minimum(members[:, i], members[:, j]).ravel()
        high = np.maximum(members[:, i], members[:, j]).ravel()
        keys.append(np.unique(low * nodes + high))
    return np.concatenate(keys)


def _spread(count: int) -> Ints:
    """A fixed scrambling of 0..count-1: breaks ties without favouring the input's order."""
    multiplier = 2654435761  # Knuth's multiplicative hash, prime to any count below 2**31
    scrambled = (np.arange(count, dtype=np.int64) * multiplier) % 4294967296
    rank = np.empty(count, dtype=np.int64)
    rank[np.argsort(scrambled, kind="stable")] = np.arange(count)
    return rank


def elimination_order(groups: Sequence[ElementGroup], structure: Structure) -> Order:
    """Find rounds of independent nodes of low degree (multiple minimum degree).

    Parameters
    ----------
    groups : sequence of ElementGroup
    structure : Structure

    Returns
    -------
    Order
        Deterministic; the same graph gives the same order.

    Notes
    -----
    After J. W. H. Liu (1985), ACM TOMS 11, 141-153 (multiple elimination), with independent sets
    chosen at once after M. Luby (1986), SIAM J. Comput. 15, 1036-1053.
    """
    sizes = structure.sizes
    nodes = len(sizes)
    keys = graph_edges(groups, structure)
    alive = np.arange(nodes, dtype=np.int64)
    rank = _spread(nodes)
    rounds, boundaries = [], []
    while int(sizes[alive].sum()) > ROOT_UNKNOWNS:
        u, v = np.divmod(keys, nodes)
        if len(keys) > 0.4 * len(alive) * (len(alive) - 1) / 2.0 and len(alive) < 1500:
            break
        degree = np.bincount(u, weights=sizes[v], minlength=nodes)
        degree += np.bincount(v, weights=sizes[u], minlength=nodes)
        chosen = _independent(degree.astype(np.int64), alive, (u, v), rank)
        start, lists = _neighbours(nodes, chosen, (u, v))
        rounds.append(chosen)
        boundaries.append((start, lists))
        gone = np.zeros(nodes, dtype=bool)
        gone[chosen] = True
        rest = keys[~(gone[u] | gone[v])]
        keys = np.unique(np.concatenate((rest, _clique_keys(nodes, start, lists))))
        alive = alive[~gone[alive]]
    return Order(tuple(rounds), tuple(boundaries), alive)
