"""What changed between two results: the input, the software, a card, the rule book, the numbers.

Compares values only; where they come from (a folder, a file of an earlier export) is known to
whoever made the snapshots.
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

from surveyapp.domain.filing import ComparisonResult, Difference, Part

_SAME: Final = 1e-12
"""Relative: numbers that differ by less came from another order of additions."""
_LINES: Final = 40
_NOT_RESULT: Final = ("schema", "software", "input_sha256", "project", "warnings")


@dataclass(frozen=True, slots=True)
class Snapshot:
    """A result with what it was made from.

    Parameters
    ----------
    name : str
    result : mapping
        The JSON of ``orient``.
    files : mapping of str to str
        sha256 by name; None where the source does not tell.
    texts : mapping of str to tuple of str
        Lines of text files, as far as they are at hand.
    cards : mapping of str to mapping
        Values of each instrument's card in force; None where the source does not tell.
    rule_book : mapping
        Its limits; empty: none; None: the source does not tell.
    """

    name: str
    result: Mapping[str, Any]
    files: Mapping[str, str] | None = None
    texts: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    cards: Mapping[str, Any] | None = None
    rule_book: Mapping[str, Any] | None = None

    def to_dict(self) -> dict[str, Any]:
        """Keys of the file, schema ``surveyapp.snapshot/1``; texts are not kept."""
        return {
            "schema": "surveyapp.snapshot/1",
            "name": self.name,
            "result": dict(self.result),
            "files": None if self.files is None else dict(self.files),
            "cards": None if self.cards is None else dict(self.cards),
            "rule_book": None if self.rule_book is None else dict(self.rule_book),
        }


def compare_snapshots(a: Snapshot, b: Snapshot) -> ComparisonResult:
    """Everything that differs between two snapshots."""
    found: list[Difference] = []
    unknown: list[str] = []
    if a.files is None or b.files is None:
        unknown.append("input")
        found += _pair("input", "sha256 of the input", a.result, b.result, key="input_sha256")
    else:
        found += _files(a, b)
    found += _pair("software", "software", a.result, b.result, key="software")
    parts: tuple[tuple[Part, object, object], ...] = (
        ("card", a.cards, b.cards),
        ("rule_book", a.rule_book, b.rule_book),
    )
    for part, left, right in parts:
        if left is None or right is None:
            unknown.append(part)
        else:
            found += _values(part, left, right)
    results = [
        {key: value for key, value in side.result.items() if key not in _NOT_RESULT}
        for side in (a, b)
    ]
    found += _values("result", *results)
    return ComparisonResult(a.name, b.name, tuple(found), tuple(unknown))


def _pair(
    part: Part, name: str, a: Mapping[str, Any], b: Mapping[str, Any], *, key: str
) -> list[Difference]:
    left, right = str(a.get(key, "")), str(b.get(key, ""))
    return [] if left == right else [Difference(part, name, left, right)]


def _files(a: Snapshot, b: Snapshot) -> list[Difference]:
    found: list[Difference] = []
    left, right = a.files or {}, b.files or {}
    for name in sorted({*left, *right}):
        if left.get(name) == right.get(name):
            continue
        if name in a.texts and name in b.texts:
            found += _lines(name, a.texts[name], b.texts[name])
        else:
            found.append(Difference("input", name, left.get(name, ""), right.get(name, "")))
    return found


def _lines(name: str, a: Sequence[str], b: Sequence[str]) -> list[Difference]:
    found = []
    matcher = difflib.SequenceMatcher(None, a, b, autojunk=False)
    for tag, i1, i2, j1, j2 in matcher.get_opcodes():
        if tag == "equal":
            continue
        for k in range(max(i2 - i1, j2 - j1)):
            old = a[i1 + k] if i1 + k < i2 else ""
            new = b[j1 + k] if j1 + k < j2 else ""
            line = i1 + k + 1 if i1 + k < i2 else j1 + k + 1
            found.append(Difference("input", f"{name}, line {line}", old, new))
    if len(found) > _LINES:
        rest = len(found) - _LINES
        found = [*found[:_LINES], Difference("input", name, "", f"and {rest} more lines")]
    return found or [Difference("input", name, "", "only line ends differ")]


def _values(part: Part, a: object, b: object) -> list[Difference]:
    left, right = dict(leaves(a)), dict(leaves(b))
    found = []
    for name in dict.fromkeys((*left, *right)):
        old, new = left.get(name), right.get(name)
        numbers = [_number(old), _number(new)]
        if numbers[0] is not None and numbers[1] is not None:
            change = numbers[1] - numbers[0]
            if abs(change) > _SAME * max(abs(numbers[0]), abs(numbers[1])):
                found.append(Difference(part, name, _text(old), _text(new), change))
        elif old != new or (name in left) != (name in right):
            found.append(Difference(part, name, _text(old), _text(new)))
    return found


def _number(value: object) -> float | None:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    return float(value) if math.isfinite(value) else None


def _text(value: object) -> str:
    if value is None:
        return ""
    return value if isinstance(value, str) else repr(value)


def leaves(value: object, path: str = "") -> Iterator[tuple[str, object]]:
    """Every value of nested mappings and lists by its path; items of lists by their names."""
    if isinstance(value, Mapping):
        for key, item in value.items():
            yield from leaves(item, f"{path}.{key}" if path else str(key))
    elif isinstance(value, list | tuple):
        names = [label(item) or str(index) for index, item in enumerate(value)]
        seen: dict[str, int] = {}
        for name, item in zip(names, value, strict=True):
            seen[name] = seen.get(name, 0) + 1
            unique = name if seen[name] == 1 else f"{name} ({seen[name]})"
            yield from leaves(item, f"{path}[{unique}]")
    else:
        yield path, value


def label(item: object) -> str:
    """What names an item of a list: its id, its line, its rule and place, its source."""
    if not isinstance(item, Mapping):
        return ""
    if "id" in item:
        return str(item["id"])
    if item.get("station") and item.get("target"):
        return f"{item['station']}-{item['target']}"
    if "rule" in item:
        return f"{item['rule']} {item.get('where', '')}".strip()
    for key in ("instrument", "source", "name", "target"):
        if isinstance(item.get(key), str):
            return str(item[key])
    return ""
