"""The formula of a limit: arithmetic of n and L, and nothing else.

A rule book comes from strangers. Its formulas are parsed into a tree of which only numbers, the
two names, the four operations, powers, comparisons and sqrt, min, max are known; no name is looked
up and nothing is called that does not stand in this file.
"""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable, Mapping
from typing import Final

from surveyapp.languages import said

MAX_LENGTH: Final = 120
_LARGEST_EXPONENT: Final = 4.0
_OPERATIONS: Final[Mapping[type[ast.operator], Callable[[float, float], float]]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}
_COMPARISONS: Final[Mapping[type[ast.cmpop], Callable[[float, float], bool]]] = {
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Eq: operator.eq,
}
_FUNCTIONS: Final[Mapping[str, Callable[..., float]]] = {
    "sqrt": math.sqrt,
    "min": min,
    "max": max,
}
VARIABLES: Final = ("n", "L")


class FormulaError(ValueError):
    """A formula that cannot be read or has no value; the message says why."""


def parse(text: str) -> ast.expr:
    """Read a formula and refuse whatever is not arithmetic of n and L.

    Raises
    ------
    FormulaError
    """
    if len(text) > MAX_LENGTH:
        raise FormulaError(said("longer than {max_length} characters", max_length=MAX_LENGTH))
    try:
        tree = ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise FormulaError("no arithmetic expression") from None
    _check(tree)
    return tree


def _check(node: ast.expr) -> None:
    match node:
        case ast.Constant(value=int() | float()) if not isinstance(node.value, bool):
            return
        case ast.Name(id=name):
            if name not in VARIABLES:
                raise FormulaError(
                    said(
                        "{name} is not known; known are {names}",
                        name=name,
                        names=", ".join(VARIABLES),
                    )
                )
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATIONS:
            _check(left)
            _check(right)
        case ast.UnaryOp(op=ast.USub() | ast.UAdd(), operand=operand):
            _check(operand)
        case ast.Compare(left=left, ops=ops, comparators=others) if all(
            type(op) in _COMPARISONS for op in ops
        ):
            for part in (left, *others):
                _check(part)
        case ast.BoolOp(op=ast.And(), values=values):
            for part in values:
                _check(part)
        case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]) if (
            name in _FUNCTIONS and arguments
        ):
            for part in arguments:
                _check(part)
        case _:
            raise FormulaError("only numbers, n, L, + - * / **, < <=, sqrt, min and max are known")


def evaluate(formula: float | str, variables: Mapping[str, float]) -> float:
    """Value of a limit.

    Parameters
    ----------
    formula : float or str
    variables : mapping
        n (a count) and L (kilometres), as far as they are known.

    Raises
    ------
    FormulaError
        If a variable is not known here, or the value is no finite number.
    """
    if not isinstance(formula, str):
        return float(formula)
    try:
        value = float(_value(parse(formula), variables))
    except (ArithmeticError, TypeError, ValueError) as error:
        if isinstance(error, FormulaError):
            raise
        raise FormulaError(said("{formula} has no value here", formula=formula)) from None
    if not math.isfinite(value):
        raise FormulaError(said("{formula} has no finite value here", formula=formula))
    return value


def holds(condition: str, variables: Mapping[str, float]) -> bool:
    """Whether a condition on n and L holds; an empty one always does.

    Raises
    ------
    FormulaError
        If a variable is not known here.
    """
    return not condition or bool(evaluate(condition, variables))


def _value(node: ast.expr, variables: Mapping[str, float]) -> float:
    match node:
        case ast.Constant(value=int() | float() as number):
            return float(number)
        case ast.Name(id=name):
            if name not in variables:
                raise FormulaError(said("{name} is not known here", name=name))
            return variables[name]
        case ast.BinOp(left=left, op=op, right=right):
            a, b = _value(left, variables), _value(right, variables)
            if isinstance(op, ast.Pow) and abs(b) > _LARGEST_EXPONENT:
                raise FormulaError(
                    said(
                        "an exponent beyond {largest_exponent:g}",
                        largest_exponent=_LARGEST_EXPONENT,
                    )
                )
            return _OPERATIONS[type(op)](a, b)
        case ast.UnaryOp(op=op, operand=operand):
            value = _value(operand, variables)
            return -value if isinstance(op, ast.USub) else value
        case ast.Compare(left=left, ops=ops, comparators=others):
            values = [_value(part, variables) for part in (left, *others)]
            pairs = zip(ops, values[:-1], values[1:], strict=True)
            return float(all(_COMPARISONS[type(op)](a, b) for op, a, b in pairs))
        case ast.BoolOp(values=parts):
            return float(all(_value(part, variables) for part in parts))
        case ast.Call(func=ast.Name(id=name), args=arguments):
            return float(_FUNCTIONS[name](*(_value(part, variables) for part in arguments)))
    raise FormulaError("no arithmetic expression")
