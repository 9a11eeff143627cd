"""``surveyapp models [ID]``: instrument cards and what is known of each."""

from __future__ import annotations

import argparse
import math

from surveyapp.cli.output import heading, paragraph, print_json, table
from surveyapp.domain.instrument import InstrumentCard
from surveyapp_models.angles import RHO_ARCSEC


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("id", nargs="?", metavar="ID", help="one instrument card")
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(options: argparse.Namespace) -> int:
    """List the cards, or show one."""
    from surveyapp import api

    cards = api.models() if options.id is None else (api.model(options.id),)
    if options.json:
        rows = [{"id": c.id, "title": c.title, "kind": c.kind, "known": known(c)} for c in cards]
        print_json({"schema": "surveyapp.models/1", "models": rows})
        return 0
    if options.id is None:
        print(table(["id", "kind", "title"], [[c.id, c.kind, c.title] for c in cards], indent=0))
        return 0
    card = cards[0]
    print(heading(f"{card.title} ({card.id}, {card.kind})"))
    values = known(card)
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


def known(card: InstrumentCard) -> dict[str, float | None]:
    """Every quantity of a card in the units of its file, None where it is absent."""
    periods, zero, valid = card.periods, card.tape_zero, card.valid

    def seconds(value: float | None) -> float | None:
        return None if value is None else value * RHO_ARCSEC

    def degrees(value: float | None) -> float | None:
        return None if value is None else math.degrees(value)

    cold, hot = valid.temperature_c or (None, None)
    return {
        "scale_value_arcsec": seconds(card.scale_value),
        "period.latitude_deg": degrees(periods.latitude) if periods else None,
        "period.tracking_s": periods.tracking_s if periods else None,
        "period.clamped_s": periods.clamped_s if periods else None,
        "period.unspun_s": periods.unspun_s if periods else None,
        "period.sigma_s": periods.sigma_s if periods else None,
        "torsion.lambda": card.torsion_lambda,
        "transit.c_arcsec_per_div_s": seconds(card.transit_c),
        "sigma.reversal_arcsec": seconds(card.sigma.reversal),
        "sigma.azimuth_arcsec": seconds(card.sigma.azimuth),
        "sigma.scale_div": card.sigma.scale_div,
        "sigma.time_s": card.sigma.time_s,
        "tape_zero.limit_div": zero.limit_div,
        "tape_zero.div_per_arcsec_tilt": None
        if zero.div_per_tilt is None
        else zero.div_per_tilt / RHO_ARCSEC,
        "tape_zero.correction_arcsec_per_div": seconds(zero.correction_per_div),
        "tape_zero.latitude_deg": degrees(zero.latitude),
        "range.latitude_max_deg": degrees(valid.latitude_max),
        "range.temperature_min_c": cold,
        "range.temperature_max_c": hot,
    }
