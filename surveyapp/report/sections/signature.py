"""The block that is signed."""

from __future__ import annotations

from surveyapp.report.blocks import Block, Heading, Signature


def blocks() -> tuple[Block, ...]:
    """Heading and lines for the observer, whoever computed, and whoever checked."""
    return (Heading("Signatures"), Signature(("Observed", "Computed", "Checked")))
