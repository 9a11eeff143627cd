"""Annex: every number of the result unrounded, as ``orient --json`` prints it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from surveyapp.domain.results import OrientationResult
from surveyapp.languages import said
from surveyapp.report.blocks import Block, Heading, PageBreak, Paragraph, Table

_NUMBERS_A_ROW = 24
_TEXTS = frozenset({"schema", "project", "software", "input_sha256", "warnings", "text"})


def blocks(result: OrientationResult) -> tuple[Block, ...]:
    """One row a group of numbers, named as in the JSON."""
    rows: list[tuple[str, str]] = []
    data = result.to_dict()
    for part in ("sessions", "constants", "lines", "checks"):
        for index, item in enumerate(data[part]):
            name = item.get("id") or item.get("rule") or item.get("instrument") or ""
            if part == "lines":
                name = f"{item['station']}-{item['target']}"
            numbers = list(_numbers(item, ""))
            if numbers:
                for start in range(0, len(numbers), _NUMBERS_A_ROW):
                    few = numbers[start : start + _NUMBERS_A_ROW]
                    text = "; ".join(f"{key} {value}" for key, value in few)
                    rows.append((f"{part}[{index}] {name}".strip(), text))
    if not rows:
        return ()
    return (
        PageBreak(),
        Heading(said("Annex: the result in full precision")),
        Paragraph(
            said(
                "Every number of the result, unrounded, under the names of the JSON that "
                "the command orient prints: angles in decimal degrees, small quantities in "
                "arc-seconds."
            ),
            "small",
        ),
        Table((said("result"), said("numbers")), tuple(rows), "ll"),
    )


def _numbers(value: Any, path: str) -> Iterator[tuple[str, str]]:
    if isinstance(value, Mapping):
        for key, item in value.items():
            if key not in _TEXTS:
                yield from _numbers(item, f"{path}.{key}" if path else str(key))
    elif isinstance(value, list | tuple):
        for index, item in enumerate(value):
            name = _label(item)
            yield from _numbers(item, f"{path}[{name or index}]")
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield path, repr(value)


def _label(item: Any) -> str:
    if not isinstance(item, Mapping):
        return ""
    return str(item.get("source") or item.get("name") or item.get("target") or "")
