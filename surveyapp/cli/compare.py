"""``surveyapp compare A B``: what changed between two results, and because of what."""

from __future__ import annotations

import argparse

from surveyapp.cli.output import print_json
from surveyapp.domain.filing import ComparisonResult, Difference

_TITLES = {
    "input": "Input",
    "software": "Software",
    "card": "Instrument cards",
    "rule_book": "Rule book",
    "result": "Result",
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    what = "project folder, or a file of export json or orient --json"
    parser.add_argument("a", metavar="A", help=what)
    parser.add_argument("b", metavar="B", help=what)
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(options: argparse.Namespace) -> int:
    """Compare and print; 0 whether anything changed or not."""
    from surveyapp import api

    result = api.compare(options.a, options.b)
    if options.json:
        print_json(result.to_dict())
    else:
        print(comparison_text(result))
    return 0


def comparison_text(result: ComparisonResult) -> str:
    """The differences, by what differs."""
    parts = [f"A: {result.a}\nB: {result.b}"]
    for part, title in _TITLES.items():
        found = [item for item in result.differences if item.part == part]
        if found:
            parts.append("\n".join([title, *(f"  {_line(item)}" for item in found)]))
        elif part in result.unknown:
            parts.append(f"{title}: one of the two does not tell")
        else:
            parts.append(f"{title}: the same")
    return "\n\n".join(parts)


def _line(item: Difference) -> str:
    if item.change is not None:
        return f"{item.name}: {_number(item.a)} -> {_number(item.b)} ({item.change:+.6g})"
    if not item.a or not item.b:
        return f"{item.name}: only in {'B' if item.b else 'A'}: {item.a or item.b}"
    return f"{item.name}:\n    A  {item.a}\n    B  {item.b}"


def _number(text: str) -> str:
    return f"{float(text):.10g}"
