"""Curves in the terminal: several series over one axis, both logarithmic."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

WIDTH: Final = 64
HEIGHT: Final = 18


def log_plot(
    curves: Sequence[tuple[str, str, Sequence[float], Sequence[float]]], *, x: str, y: str
) -> str:
    """A plot of curves, each (letter, name, x values, y values); empty where nothing is positive.

    Where curves meet the last one is seen.
    """
    points = [
        (math.log10(a), math.log10(b), letter)
        for letter, _, xs, ys in curves
        for a, b in zip(xs, ys, strict=True)
        if a > 0.0 and b > 0.0
    ]
    if not points:
        return ""
    left, right = min(p[0] for p in points), max(p[0] for p in points)
    low, high = min(p[1] for p in points), max(p[1] for p in points)
    right, high = max(right, left + 1e-9), max(high, low + 1e-9)
    grid = [[" "] * WIDTH for _ in range(HEIGHT)]
    for a, b, letter in points:
        column = round((a - left) / (right - left) * (WIDTH - 1))
        row = round((high - b) / (high - low) * (HEIGHT - 1))
        grid[row][column] = letter
    labels = [f"{10**high:9.2e}", *[" " * 9] * (HEIGHT - 2), f"{10**low:9.2e}"]
    lines = [f"  {y}"]
    lines += [
        f"  {label} |{''.join(row).rstrip()}" for label, row in zip(labels, grid, strict=True)
    ]
    lines.append(f"  {'':9} +{'-' * WIDTH}")
    ends = f"{10**left:.3g}", f"{10**right:.3g} {x}"
    lines.append(f"  {'':10} {ends[0]}{ends[1]:>{WIDTH - len(ends[0])}}")
    lines.append("  " + "   ".join(f"{letter} {name}" for letter, name, _, _ in curves))
    return "\n".join(lines)
