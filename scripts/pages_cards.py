"""Reference pages of the instrument cards, one a card, from the cards themselves."""

from __future__ import annotations

from pathlib import Path

from surveyapp.domain.instrument import InstrumentCard
from surveyapp.io.cards import installed_card_ids, read_card

GENERATED = "*This page is generated from the card; do not edit it.*"
MEANING = {
    "scale_value_arcsec": "one division of the gyro scale",
    "period.latitude_deg": "latitude at which the periods hold",
    "period.tracking_s": "swing period T1, tracking",
    "period.clamped_s": "swing period T2, clamped",
    "period.unspun_s": "swing period T0, rotor at rest",
    "torsion.lambda": "torsion ratio",
    "transit.c_arcsec_per_div_s": "constant of the transit method",
    "sigma.reversal_arcsec": "sigma of one turning point",
    "sigma.azimuth_arcsec": "sigma of one determination",
    "sigma.scale_div": "sigma of one scale reading",
    "sigma.time_s": "sigma of one timed passage",
    "tape_zero.limit_div": "largest tolerable tape zero",
    "tape_zero.div_per_arcsec_tilt": "change of the tape zero with tilt",
    "tape_zero.correction_arcsec_per_div": "added to gyro north per division of tape zero",
    "tape_zero.latitude_deg": "latitude at which that holds",
    "range.latitude_max_deg": "largest latitude",
    "range.temperature_min_c": "lowest temperature",
    "range.temperature_max_c": "highest temperature",
}

LEFT_OUT = """Looked for and left out, because no source that could be read states a figure for
them: AGT-5, ARK-2, BTJ-5, Fennel TK4 and TK5, MOM Gi-B21, Y/JTG-1. Whoever owns one writes a card
of his own from its data sheet or test certificate ([how](../project-folder.md#instrument-cards));
the program asks for what it needs at the step where it is missing."""


def pages() -> dict[str, str]:
    """Text of each page by its path below docs/."""
    cards = [read_card(name, base=Path(), override={}) for name in installed_card_ids()]
    result = {f"reference/instruments/{card.id}.md": page(card) for card in cards}
    head = ["# Instrument cards", "", GENERATED.replace("card", "cards", 1), ""]
    head += [
        "What a card does not state is not known to the program, and nothing stands in for it."
    ]
    head += ["", "| card | instrument | kind | known |", "|---|---|---|---|"]
    head += [
        f"| [`{card.id}`]({card.id}.md) | {card.title} | {card.kind} | "
        f"{', '.join(f'`{k}`' for k, v in card.known().items() if v is not None) or 'nothing'} |"
        for card in cards
    ]
    result["reference/instruments/index.md"] = "\n".join([*head, "", LEFT_OUT]) + "\n"
    return result


def page(card: InstrumentCard) -> str:
    """Text of one card's page."""
    lines = [f"# {card.title}", "", GENERATED, ""]
    lines += [f"Card `{card.id}`, {card.kind}.", ""]
    values = card.known()
    stated = {name: value for name, value in values.items() if value is not None}
    if stated:
        lines += ["| key | value | meaning |", "|---|---|---|"]
        lines += [f"| `{name}` | {v:g} | {MEANING.get(name, '')} |" for name, v in stated.items()]
        lines += [""]
    else:
        lines += ["The card states no value.", ""]
    absent = [f"`{name}`" for name in values if name not in stated]
    lines += [f"Absent: {', '.join(absent)}.", ""]
    lines += ["## Source", "", card.source, ""]
    if card.notes:
        lines += ["## Notes", ""]
        lines += [f"- {name.replace('_', ' ')}: {text}" for name, text in card.notes]
    lines += [""]
    lines += [
        "Override any key in the project's `[[instrument]]` table; a card of your own is named "
        "by its path."
    ]
    return "\n".join(lines).rstrip() + "\n"
