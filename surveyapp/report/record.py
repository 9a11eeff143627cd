"""The survey record: which sections it has, in which order, and what goes into its margins.

A section is a function from the results to blocks. Other parts of the program hand in blocks of
their own (a diagnosis, an adjustment), which stand before the checks.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

from surveyapp.domain.project import Project
from surveyapp.domain.results import OrientationResult
from surveyapp.domain.rulebook import RuleBook
from surveyapp.languages import said
from surveyapp.report.blocks import Block, Document
from surveyapp.report.sections import (
    azimuths,
    checks,
    constants,
    fieldbook,
    full_numbers,
    head,
    reduction,
    seal,
    signature,
)
from surveyapp.report.stamp import stamp_of


@dataclass(frozen=True, slots=True)
class SealShown:
    """The closing in force, as the record shows it.

    Parameters
    ----------
    at, by : str
        When and by whom it was closed.
    seal : str
        Head of the ledger's chain, 20 characters.
    files : str
        Head of the chain over the sealed files.
    session : str
        The session that was closed; empty: the project.
    """

    at: str
    by: str
    seal: str
    files: str = ""
    session: str = ""


@dataclass(frozen=True, slots=True)
class Extra:
    """A section from elsewhere: its id and its blocks, the heading among them.

    ``verdict`` is what the first page says of it; empty: nothing.
    """

    id: str
    blocks: tuple[Block, ...]
    verdict: str = ""


@dataclass(frozen=True, slots=True)
class Record:
    """Everything that a record shows.

    Parameters
    ----------
    project : Project
    result : OrientationResult
    rule_book : RuleBook or None
    seals : tuple of SealShown
        Closings in force; none while everything is open.
    extras : tuple of Extra
    """

    project: Project
    result: OrientationResult
    rule_book: RuleBook | None = None
    seals: tuple[SealShown, ...] = ()
    extras: tuple[Extra, ...] = ()


@dataclass(frozen=True, slots=True)
class Section:
    """One section: its id, what it holds, and what makes its blocks; no blocks, no section."""

    id: str
    title: str
    blocks: Callable[[Record], tuple[Block, ...]]


def _signed(seals: Sequence[SealShown]) -> tuple[tuple[str, str], ...]:
    """What the first page says of the closings."""
    facts: list[tuple[str, str]] = []
    if not any(not item.session for item in seals):
        facts.append((said("signed"), said("the project is open and not signed as a whole")))
    for item in seals:
        what = said("signed, {session}", session=item.session) if item.session else said("signed")
        facts += [(what, f"{item.by or '-'}, {item.at}"), (said("seal"), item.seal)]
    return tuple(facts)


def _told(extras: Sequence[Extra]) -> tuple[tuple[str, str], ...]:
    """What the first page says of sections from elsewhere."""
    return tuple((item.id, item.verdict) for item in extras if item.verdict)


def _extras(record: Record) -> tuple[Block, ...]:
    return tuple(block for extra in record.extras for block in extra.blocks)


SECTIONS: Final[tuple[Section, ...]] = (
    Section(
        "head",
        "project, verdict, instruments, stations, closings",
        lambda r: head.blocks(
            r.project, r.result, r.rule_book, (*_told(r.extras), *_signed(r.seals))
        ),
    ),
    Section(
        "azimuths",
        "oriented lines: every step to the grid azimuth, and the budget of errors",
        lambda r: azimuths.blocks(r.project, r.result),
    ),
    Section(
        "constants",
        "instrument constants with their determinations",
        lambda r: constants.blocks(r.result),
    ),
    Section(
        "reduction",
        "each session from readings to gyro north",
        lambda r: reduction.blocks(r.project, r.result),
    ),
    Section(
        "fieldbook",
        "the readings as they were taken, struck ones too",
        lambda r: fieldbook.blocks(r.project),
    ),
    Section("extras", "diagnosis, traverse, breakthrough, sensors: what was asked for", _extras),
    Section(
        "checks",
        "every verdict with value and limit",
        lambda r: checks.blocks(r.result.checks, r.result.warnings),
    ),
    Section("seal", "closings in force", lambda r: seal.blocks(r.seals)),
    Section("signature", "room for signatures", lambda _: signature.blocks()),
    Section(
        "full_numbers",
        "the numbers of the result with all digits",
        lambda r: full_numbers.blocks(r.result),
    ),
)


def record_document(record: Record) -> tuple[Document, tuple[str, ...]]:
    """The record as a document, and the ids of the sections that it has."""
    made = [(section.id, section.blocks(record)) for section in SECTIONS]
    names: list[str] = []
    for name, blocks in made:
        if name == "extras":
            names += [extra.id for extra in record.extras]
        elif blocks:
            names.append(name)
    document = Document(
        title=said("Survey record: {name}", name=record.project.name),
        running_head=said("Survey record: {name}", name=record.project.name),
        foot=(
            record.result.software,
            said("sha256 of the input {input_sha256}", input_sha256=record.result.input_sha256),
        ),
        blocks=tuple(block for _, blocks in made for block in blocks),
        stamp=stamp_of(record.result.input_sha256, [item.seal for item in record.seals]),
    )
    return document, tuple(names)
