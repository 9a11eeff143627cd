"""Reference pages of what comes in kinds: formats, checks, sections, observations of traverses."""

from __future__ import annotations

from collections.abc import Sequence

from surveyapp.core.checks.verdicts import CHECKS
from surveyapp.domain.observations import KINDS
from surveyapp.io.exporters.catalogue import EXPORTERS
from surveyapp.io.importers.fieldfiles.catalogue import IMPORTERS
from surveyapp.report.record import SECTIONS

NOTE = "*This page is generated from {source}; do not edit it.*"


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """A table of the page."""
    lines = ["| " + " | ".join(cells) + " |" for cells in (head, *rows)]
    return [lines[0], "|" + "---|" * len(head), *lines[1:]]


def page(title: str, source: str, body: Sequence[str]) -> str:
    """Text of a page."""
    return "\n".join([f"# {title}", "", NOTE.format(source=source), "", *body]) + "\n"


def formats() -> str:
    """Formats in and out."""
    read = [
        (
            f"`{item.id}`",
            item.title,
            ", ".join(f"`{ending}`" for ending in item.endings),
            "pointings" if item.azimuths is None else "azimuths",
        )
        for item in IMPORTERS
    ]
    written = [(f"`{item.id}`", str(item.title), f"`{item.ending}`") for item in EXPORTERS]
    return page(
        "Formats of other programs",
        "`IMPORTERS` and `EXPORTERS`",
        [
            "`surveyapp import FORMAT FILE DIR` reads, `surveyapp export FORMAT DIR FILE` writes;",
            "`surveyapp adjust FILE.gkf` takes a network of GNU Gama as it is. What a format",
            "cannot say is told, and never left out in silence.",
            "",
            "## Read",
            "",
            *table(("format", "what it is", "endings", "holds"), read),
            "",
            "## Written",
            "",
            *table(("format", "what it is", "ending"), written),
        ],
    )


def checks() -> str:
    """The groups of checks."""
    rows = [(item.id, item.title) for item in CHECKS]
    return page(
        "Checks",
        "`CHECKS` of `surveyapp/core/checks/verdicts.py`",
        [
            "Every command, screen and record shows the verdicts of this one list, in this order.",
            "A limit that no source confirms only warns; the limits themselves stand in the",
            "[rule books](rule-books/index.md).",
            "",
            *table(("group", "what is looked at"), rows),
        ],
    )


def sections() -> str:
    """The sections of the record."""
    return page(
        "Sections of the record",
        "`SECTIONS` of `surveyapp/report/record.py`",
        [
            "A section for which a project has nothing is left out.",
            "",
            *table(("section", "what it holds"), [(f"`{s.id}`", s.title) for s in SECTIONS]),
        ],
    )


def observations() -> str:
    """The kinds of observation of a traverse book."""
    rows = [
        (
            f"`{item.kind}`",
            item.title,
            "none: it is that of the session" if item.book == "none" else "",
            "" if item.book == "none" else "dms, gon or deg" if item.angular else "m",
            "arcsec, mgon" if item.angular else "mm, mm+ppm",
        )
        for item in KINDS
        if item.book
    ]
    return page(
        "Observations of a traverse book",
        "`KINDS` of `surveyapp/domain/observations.py`",
        [
            "What `kind` in a row of [a traverse book](project-folder.md) may be.",
            "",
            *table(("kind", "what it is", "value", "unit", "unit of sigma"), rows),
        ],
    )


def pages() -> dict[str, str]:
    """Text of each page by its path below docs/."""
    return {
        "reference/formats.md": formats(),
        "reference/checks.md": checks(),
        "reference/record-sections.md": sections(),
        "reference/traverse-observations.md": observations(),
    }
