"""What a project's ledger says of its closings, read once: what is sealed, and what was changed."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Closing:
    """A closing that no reopening has ended.

    Parameters
    ----------
    session : str
        Its id; empty: the project as a whole.
    at, by, seal : str
        When and by whom it was closed; head of the hash chain.
    head : str
        Of the ledger's chain at this closing, 20 characters: what the signed record prints.
    changed : tuple of str
        What is no longer as it was then, in words; empty where nothing is.
    """

    session: str
    at: str
    by: str
    seal: str
    head: str = ""
    changed: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Filing:
    """The state of the ledger.

    Parameters
    ----------
    entries : int
        Entries that are whole.
    faults : tuple of str
        What is wrong with the ledger itself.
    unfinished_tail : bool
        Whether a last line was never finished.
    closed_once : bool
        Whether anything was ever closed.
    closings : tuple of Closing
        In force.
    """

    entries: int = 0
    faults: tuple[str, ...] = ()
    unfinished_tail: bool = False
    closed_once: bool = False
    closings: tuple[Closing, ...] = ()

    @property
    def project_closing(self) -> Closing | None:
        """The closing of the project as a whole, None while it is open."""
        return next((item for item in self.closings if not item.session), None)

    def is_closed(self, session: str) -> bool:
        """Whether a session may no longer be written to: it or the project is closed."""
        return any(item.session in ("", session) for item in self.closings)
