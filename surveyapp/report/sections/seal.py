"""The closing in force: when, by whom, and the head of the hash chain."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from surveyapp.languages import said
from surveyapp.report.blocks import Block, Heading, KeyValues, Paragraph

if TYPE_CHECKING:
    from surveyapp.report.record import SealShown


def blocks(seals: Sequence[SealShown]) -> tuple[Block, ...]:
    """Blocks of the closings in force; none where there are none."""
    if not seals:
        return ()
    facts: list[tuple[str, str]] = []
    for shown in seals:
        facts += [
            (
                said("closed"),
                said("session {session}", session=shown.session)
                if shown.session
                else said("the project"),
            ),
            (said("closed at"), shown.at),
            (said("closed by"), shown.by or "-"),
            (said("seal"), shown.seal),
            (said("sha256 of the files"), shown.files or "-"),
        ]
    return (
        Heading(said("Closing")),
        KeyValues(tuple(facts)),
        Paragraph(
            said(
                "The seal is the head of the ledger's hash chain at this closing; the "
                "closing holds the sha256 of what it closes: project.toml or the session's "
                "table, books, own cards and rule books, logs; of a session also stations, "
                "instrument, settings and calibrations. surveyapp check DIR --seal {seal} "
                "tells whether all of it is as it was signed.",
                seal=seals[0].seal,
            ),
            "small",
        ),
    )
