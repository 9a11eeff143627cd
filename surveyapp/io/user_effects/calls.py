"""Calls into a user's own effect: read-only arrays in, a float array of the right shape out.

Whatever else comes back, and everything that is raised there, becomes a SurveyError that names the
file, the effect and the function.
"""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import numpy as np

from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Columns, Effect, GridParameter

FAULTS = (Exception, SystemExit, GeneratorExit)
"""What code of a user may raise without ending the program: all but the interrupt key."""


def told(fault: BaseException) -> str:
    """Name and message of an exception, on one line."""
    text = " ".join(str(fault).split())
    return f"{type(fault).__name__}: {text}"[:300] if text else type(fault).__name__


def guarded(effect: Effect, file: str) -> Effect:
    """The same effect, its functions guarded; it cannot be adopted and needs no reference."""
    where = said("{file}, effect {id}", file=file, id=effect.id)
    size = len(effect.coefficients)
    law = effect.law
    return replace(
        effect,
        basis=_basis(effect.basis, effect, f"{where}, basis"),
        midpoint=None
        if effect.midpoint is None
        else _basis(effect.midpoint, effect, f"{where}, midpoint"),
        law=None if law is None else _law(law, f"{where}, law"),
        at_datum=None if effect.at_datum is None else _datum(effect.at_datum, size, where),
        reference=None,
        grid=tuple(_parameter(item, where) for item in effect.grid),
    )


@contextlib.contextmanager
def _calling(where: str) -> Iterator[None]:
    """Nothing of the user's gets to standard output, which is the result's."""
    try:
        with contextlib.redirect_stdout(sys.stderr):
            yield
    except SurveyError:
        raise
    except FAULTS as fault:
        hint = "Declare in needs every column that it reads." if isinstance(fault, KeyError) else ""
        if "read-only" in str(fault):
            hint = "It may not write into its columns: work on a copy."
        raise SurveyError(
            Problem(
                "a function of your own effect failed",
                where,
                told(fault),
                "a pure function of its columns and grid",
                hint,
            )
        ) from None


def _wrong(where: str, found: str, expected: str) -> SurveyError:
    what = "a function of your own effect does not return what it must"
    return SurveyError(Problem(what, where, found, expected))


def _frozen(value: Any) -> Any:
    """A read-only view of an array; anything else as it is."""
    if not isinstance(value, np.ndarray):
        return value
    view = value.view()
    view.flags.writeable = False
    return view


def real_array(value: Any, where: str, expected: str) -> Floats:
    """A finite array of real numbers, or a SurveyError."""
    try:
        array = np.asarray(value)
        if array.dtype.kind not in "fiub":
            raise _wrong(where, said("values of type {dtype}", dtype=array.dtype), expected)
        array = array.astype(np.float64)
    except (ValueError, TypeError):
        raise _wrong(where, type(value).__name__, expected) from None
    if not np.isfinite(array).all():
        raise _wrong(where, "values that are not finite (nan or infinite)", expected)
    return array


def _rows(columns: Columns, effect: Effect) -> int | None:
    """Observations, as the declared columns tell."""
    for need in effect.needs:
        if need.name in columns:
            return int(columns[need.name].shape[0])
    return None


def _basis(function: Callable[..., Any], effect: Effect, where: str) -> Callable[..., Floats]:
    p = len(effect.coefficients)

    def basis(columns: Columns, /, **grid: float) -> Floats:
        frozen = MappingProxyType({name: _frozen(values) for name, values in columns.items()})
        with _calling(where):
            value = function(frozen, **grid)
        n = _rows(columns, effect)
        rows = "number of observations" if n is None else str(n)
        expected = said(
            "a finite float array of shape ({rows}, {p}): a column for each coefficient",
            rows=rows,
            p=p,
        )
        array = real_array(value, where, expected)
        if array.ndim != 2 or array.shape[1] != p or (n is not None and array.shape[0] != n):
            raise _wrong(where, said("an array of shape {shape}", shape=array.shape), expected)
        return array

    return basis


def _law(function: Callable[..., Any], where: str) -> Callable[..., Floats]:
    def law(*arguments: Floats, **grid: float | Floats) -> Floats:
        with _calling(where):
            value = function(
                *(_frozen(item) for item in arguments),
                **{name: _frozen(item) for name, item in grid.items()},
            )
        shape = np.broadcast_shapes(*(np.shape(item) for item in (*arguments, *grid.values())))
        expected = said("a float array of shape {shape}: every argument broadcasts", shape=shape)
        array = np.asarray(value)
        if array.dtype.kind not in "fiub" or array.shape != shape:
            raise _wrong(
                where,
                said("{dtype} of shape {shape}", dtype=array.dtype, shape=array.shape),
                expected,
            )
        return array.astype(np.float64)  # at the edge of a search it may overflow

    return law


def _datum(function: Callable[..., Any], size: int, where: str) -> Callable[..., Any]:
    place = said("{where}, at_datum", where=where)

    def at_datum(columns: Columns, references: Mapping[str, float], /, **grid: float) -> Any:
        frozen = MappingProxyType({name: _frozen(values) for name, values in columns.items()})
        expected = said("pairs of a text and {size} numbers", size=size)
        with _calling(place):
            states = tuple(function(frozen, MappingProxyType(dict(references)), **grid))
            pairs = [(str(text), tuple(float(v) for v in row)) for text, row in states]
        if any(len(row) != size or not np.isfinite(row).all() for _, row in pairs):
            raise _wrong(place, str(pairs)[:200], expected)
        return tuple(pairs)

    return at_datum


def _parameter(item: GridParameter, where: str) -> GridParameter:
    place = said("{where}, grid {name}", where=where, name=item.name)
    function = item.values

    def values(columns: Columns) -> Floats:
        frozen = MappingProxyType({name: _frozen(column) for name, column in columns.items()})
        with _calling(place):
            value = function(frozen)
        array = real_array(value, place, "a finite float array of one dimension")
        if array.ndim != 1:
            shape = said("an array of shape {shape}", shape=array.shape)
            raise _wrong(place, shape, "a finite float array of one dimension")
        return array

    return replace(item, values=values)
