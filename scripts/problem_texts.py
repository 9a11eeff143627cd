"""Texts of refusals and warnings: ``what``, ``expected``, ``hint`` of a ``Problem`` and the like.

A plain text there needs no mark: its place says that it is a text of the catalogue. It may be given
as it is, by a name that is set in the same function or module, or through a function that hands an
argument of its own on to a ``Problem``; those calls are followed. A text with values in it is
``said``, and so are ``where`` and ``found`` where they have words: what was found in a file is
not translated.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

FIELDS: Final = ("what", "where", "found", "expected", "hint")
TEXTS: Final = ("what", "expected", "hint")
HANDED: Final = (*TEXTS, "needed", "message", "text")
"""Names of arguments that hand a text on; others (a kind, a column) are no texts."""
ERRORS: Final = ("CellError", "FormulaError", "RecordError", "WordError")
"""Errors within a reader whose message becomes the ``what`` of a problem."""
Sinks = dict[str, dict[str, int]]
"""By the name of a function: its arguments that become texts, with their places."""
_Function = ast.FunctionDef | ast.AsyncFunctionDef
_Call = tuple[_Function | None, ast.Call]
"""A call and the function in which it stands."""


@dataclass(slots=True)
class Found:
    """Texts of a module, and expressions that are none of the forms above."""

    texts: list[tuple[str, int]] = field(default_factory=list)
    unsaid: list[tuple[ast.expr, str]] = field(default_factory=list)
    handed: list[tuple[_Function, str]] = field(default_factory=list)


def texts_of(trees: dict[Path, ast.Module]) -> dict[Path, Found]:
    """Texts of refusals by module; functions that hand texts on are followed to their callers."""
    sinks: Sinks = {
        "Problem": {name: place for place, name in enumerate(FIELDS) if name in TEXTS},
        "ResultWarning": {"text": 1},
        **{name: {"message": 0} for name in ERRORS},
    }
    calls = {path: list(_calls(tree)) for path, tree in trees.items()}
    while True:
        found = {path: _of_module(tree, calls[path], sinks) for path, tree in trees.items()}
        grown = _grown(sinks, (pair for one in found.values() for pair in one.handed))
        if grown == sinks:
            return found
        sinks = grown


def has_words(text: str) -> bool:
    """Whether a text says something in English beside keys, options, units and file names."""
    bare = re.sub(r"`[^`]*`|\[+[^\]]*\]+|\"[^\"]*\"|<[^>]*>|--?[\w-]+|\S*[_=/|.(]\S*", " ", text)
    return re.search(r"\b[a-z]{2,}\b", bare) is not None


def _grown(sinks: Sinks, handed: Iterator[tuple[_Function, str]]) -> Sinks:
    result = {name: dict(places) for name, places in sinks.items()}
    for function, argument in handed:
        names = [a.arg for a in (*function.args.posonlyargs, *function.args.args)]
        if names[:1] in (["self"], ["cls"]):
            names = names[1:]
        place = names.index(argument) if argument in names else -1
        result.setdefault(function.name, {})[argument] = place
    return result


def _of_module(tree: ast.Module, calls: list[_Call], sinks: Sinks) -> Found:
    found = Found()
    for function, call in calls:
        name = getattr(call.func, "id", getattr(call.func, "attr", ""))
        if name == "add" and len(call.args) + len(call.keywords) == 1:
            continue  # that of a set
        for argument, place in sinks.get(name, {}).items():
            for expression in _given(call, argument, place):
                _take(found, expression, (tree, function), set())
    return found


def _calls(tree: ast.Module) -> Iterator[_Call]:
    """Every call in the order of the source, and the function that it stands in."""
    waiting: list[tuple[_Function | None, ast.AST]] = [(None, tree)]
    while waiting:
        inside, node = waiting.pop()
        if isinstance(node, ast.Call):
            yield inside, node
        if isinstance(node, _Function):
            inside = node
        waiting += [(inside, child) for child in reversed(list(ast.iter_child_nodes(node)))]


def _given(call: ast.Call, argument: str, place: int) -> list[ast.expr]:
    plain = call.args[place : place + 1] if place >= 0 else []
    plain = [] if any(isinstance(item, ast.Starred) for item in call.args) else plain
    return [*plain, *(k.value for k in call.keywords if k.arg == argument)]


def _take(
    found: Found,
    expression: ast.expr,
    place: tuple[ast.Module, _Function | None],
    seen: set[str],
) -> None:
    """Take what an expression may be: texts, or branches of it."""
    if isinstance(expression, ast.Constant):
        if isinstance(expression.value, str) and expression.value:
            found.texts.append((expression.value, expression.lineno))
    elif isinstance(expression, ast.IfExp):
        for branch in (expression.body, expression.orelse):
            _take(found, branch, place, seen)
    elif isinstance(expression, ast.BoolOp):
        for branch in expression.values:
            _take(found, branch, place, seen)
    elif isinstance(expression, ast.Name):
        _take_name(found, expression, place, seen)
    elif isinstance(expression, ast.JoinedStr | ast.BinOp):
        found.unsaid.append((expression, ast.unparse(expression)))


def _take_name(
    found: Found, name: ast.Name, place: tuple[ast.Module, _Function | None], seen: set[str]
) -> None:
    if name.id in seen:
        return
    tree, function = place
    values = list(_set_to(function, name.id)) if function is not None else []
    if not values and function is not None and name.id in _arguments(function):
        if name.id in HANDED:
            found.handed.append((function, name.id))
        return
    for value in values or _set_to(tree, name.id):
        _take(found, value, place, seen | {name.id})


def _arguments(function: _Function) -> set[str]:
    given = function.args
    return {a.arg for a in (*given.posonlyargs, *given.args, *given.kwonlyargs)}


def _set_to(scope: ast.AST, name: str) -> Iterator[ast.expr]:
    """Expressions that a name is set to; of several names in one line each its own."""
    for node in ast.walk(scope):
        if isinstance(node, ast.AnnAssign) and node.value is not None:
            targets: list[ast.expr] = [node.target]
        elif isinstance(node, ast.Assign):
            targets = node.targets
        else:
            continue
        for target in targets:
            yield from _of_target(target, node.value, name)


def _of_target(target: ast.expr, value: ast.expr | None, name: str) -> Iterator[ast.expr]:
    if value is None:
        return
    if isinstance(target, ast.Name) and target.id == name:
        yield value
    elif isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
        for part, item in zip(target.elts, value.elts, strict=False):
            yield from _of_target(part, item, name)
