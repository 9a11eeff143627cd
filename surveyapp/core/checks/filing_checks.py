"""Whether the ledger is whole and what was closed is as it was: judged from what was read."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from surveyapp.domain.closing import Closing, Filing
from surveyapp.domain.results import Check
from surveyapp.domain.subject import Subject
from surveyapp.languages import joined, said

LEDGER: Final = "ledger.jsonl"
_CLAUSE: Final = said("closing of the project")
_SHOWN: Final = 5
"""More changes are counted and not listed."""


def filing_checks(filing: Filing) -> tuple[Check, ...]:
    """Checks of the ledger and of every closing in force.

    None without a ledger, and none for a whole one in which nothing was ever closed.
    """
    ledger = Subject.of("ledger", LEDGER)
    checks = []
    if filing.faults or filing.closed_once:
        good = said("{entries} entries, the chain is whole", entries=filing.entries)
        checks.append(_check("ledger.chain", filing.faults, ledger, good=good))
    if filing.unfinished_tail:
        text = said("the last line of the ledger was never finished and does not count")
        checks.append(_check("ledger.tail", [text], ledger, confirmed=False))
    checks += [
        _check(
            "closing.unchanged",
            closing.changed,
            _subject(closing),
            where=closing.session or "project",
            good=said("as closed at {at}", at=closing.at),
        )
        for closing in filing.closings
    ]
    return tuple(checks)


def seal_check(head: str, found: Sequence[str], good: str) -> Check:
    """Whether the head that a signed record prints stands in the ledger, and holds.

    Parameters
    ----------
    head : str
    found : sequence of str
        What is not as it was then; empty where everything is.
    good : str
        What it seals, in words.
    """
    return _check("closing.seal", found, Subject.of("ledger", LEDGER), where=head, good=good)


def signature_check(rule: str, where: str, found: Sequence[str], key: str) -> Check:
    """Whether a closing or a file is signed by a key.

    Parameters
    ----------
    rule : str
        ``closing.signature`` or ``record.signature``.
    where : str
        The session, ``project``, or the name of the file.
    found : sequence of str
        Why it is not; empty where it is.
    key : str
        Number of the public key.
    """
    good = said("signed by the key {key}", key=key)
    return _check(rule, found, Subject.of("ledger", LEDGER), where=where, good=good)


def _subject(closing: Closing) -> Subject:
    return Subject.session(closing.session) if closing.session else Subject.project()


def _check(
    rule: str,
    found: Sequence[str],
    subject: Subject,
    *,
    where: str = "",
    good: str = "",
    confirmed: bool = True,
) -> Check:
    more = said(" and {number} more", number=len(found) - _SHOWN) if len(found) > _SHOWN else ""
    return Check(
        rule=rule,
        clause=_CLAUSE,
        value=float(len(found)),
        limit=0.0,
        confirmed=confirmed,
        passed=not found,
        unit="changes",
        where=where or subject.text,
        text=joined("; ", found[:_SHOWN]) + more if found else good,
        subject=subject,
    )
