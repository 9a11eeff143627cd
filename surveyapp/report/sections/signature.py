"""The block that is signed."""

from __future__ import annotations

from surveyapp.languages import said, said_each
from surveyapp.report.blocks import Block, Heading, Signature


def blocks() -> tuple[Block, ...]:
    """Heading and lines for the observer, whoever computed, and whoever checked."""
    return (Heading(said("Signatures")), Signature(said_each("Observed", "Computed", "Checked")))
