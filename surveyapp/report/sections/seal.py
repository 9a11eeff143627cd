"""The closing in force: when, by whom, and the head of the hash chain."""

from __future__ import annotations

from surveyapp.report.blocks import Block, Heading, KeyValues, Paragraph


def blocks(at: str, by: str, seal: str) -> tuple[Block, ...]:
    """Blocks of the closing."""
    return (
        Heading("Closing"),
        KeyValues((("closed at", at), ("closed by", by or "-"), ("seal", seal))),
        Paragraph(
            "The seal is the head of a hash chain over project.toml, books, own cards and rule "
            "books, sensor logs and the ledger; a changed byte is found by the command check.",
            "small",
        ),
    )
