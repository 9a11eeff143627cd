"""``surveyapp models [ID]``: instrument cards and what is known of each."""

from __future__ import annotations

import argparse

from surveyapp.cli.output import heading, paragraph, print_json, table


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("id", nargs="?", metavar="ID", help="one instrument card")
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(options: argparse.Namespace) -> int:
    """List the cards, or show one."""
    from surveyapp import api

    cards = tuple(api.models()) if options.id is None else (api.model(options.id),)
    if options.json:
        rows = [card.to_dict() for card in cards]
        print_json({"schema": "surveyapp.models/1", "models": rows})
        return 0
    if options.id is None:
        print(table(["id", "kind", "title"], [[c.id, c.kind, c.title] for c in cards], indent=0))
        return 0
    card = cards[0]
    print(heading(f"{card.title} ({card.id}, {card.kind})"))
    values = card.known()
    facts = [[name, f"{value:g}"] for name, value in values.items() if value is not None]
    if facts:
        print(table(["quantity", "value"], facts))
    absent = ", ".join(name for name, value in values.items() if value is None)
    if absent:
        print(paragraph(f"not known: {absent}"))
    print("\n" + paragraph(f"Source: {card.source}", indent=0))
    for name, text in card.notes:
        print(paragraph(f"{name}: {text}", indent=0))
    return 0
