"""Which state of a project a record shows, in a form that can be read from the PDF again.

It stands among the properties of the file (keywords): the sha256 of the input and the heads of the
closings in force. A record whose stamp is another than the project's is out of date.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

_STAMP: Final = re.compile(rb"/Keywords \(surveyapp record ([0-9a-f]{64}(?: [0-9A-Z-]{23})*)\)")


def stamp_of(input_sha256: str, heads: Sequence[str]) -> str:
    """Stamp of a record: sha256 of the input and heads of the closings, in their order."""
    return " ".join(("surveyapp record", input_sha256, *heads))


def stamp_in(data: bytes) -> str | None:
    """Stamp that stands in a PDF, None where it has none."""
    match = _STAMP.search(data)
    return None if match is None else f"surveyapp record {match[1].decode('ascii')}"
