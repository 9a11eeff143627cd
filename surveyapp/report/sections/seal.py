"""The closing in force: when, by whom, and the head of the hash chain."""

from __future__ import annotations

from typing import TYPE_CHECKING

from surveyapp.report.blocks import Block, Heading, KeyValues, Paragraph

if TYPE_CHECKING:
    from surveyapp.report.record import SealShown


def blocks(shown: SealShown) -> tuple[Block, ...]:
    """Blocks of the closing."""
    return (
        Heading("Closing"),
        KeyValues(
            (
                ("closed at", shown.at),
                ("closed by", shown.by or "-"),
                ("seal", shown.seal),
                ("sha256 of the files", shown.files or "-"),
            )
        ),
        Paragraph(
            "The seal is the head of the ledger's hash chain at this closing; the closing holds "
            "the sha256 of project.toml, books, own cards and rule books and logs. "
            f"surveyapp check DIR --seal {shown.seal} tells whether all of it is as it was signed.",
            "small",
        ),
    )
