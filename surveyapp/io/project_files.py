"""The files of a project folder, each read once; what was read is what the digest is of."""

from __future__ import annotations

import hashlib
import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import SurveyError
from surveyapp.io.files import read_inside, shown
from surveyapp.io.findings import Findings
from surveyapp.io.guarded import MAX_LOG_BYTES, open_regular, place_inside
from surveyapp.io.tables import Table
from surveyapp.languages import said

PROJECT_FILE: Final = "project.toml"


@dataclass(slots=True)
class ProjectFiles:
    """The files of a project, each read once.

    Parameters
    ----------
    path : Path
        The folder.
    findings : Findings
    contents : dict of str to bytes or None
        Every file that is part of the digest by its name as written; None where it is absent.
    observing : bool
        Whether the folder is read for observing a session: then what a session does not need (the
        rule book, traverses) is told as a warning where it cannot be used, and holds nothing up.
    """

    path: Path
    findings: Findings
    contents: dict[str, bytes | None] = field(default_factory=dict)
    observing: bool = False

    def read(self, name: str, where: str) -> bytes | None:
        """Bytes of a file, None with a problem noted."""
        if name not in self.contents:
            try:
                self.contents[name] = read_inside(self.path, name, where=where)
            except SurveyError as error:
                self.findings.absorb(error)
                self.contents[name] = None
        return self.contents[name]

    def read_log(self, name: str, table: Table) -> None:
        """Take a sensor log into the digest that nobody pinned; a missing one is a warning."""
        digest = hashlib.sha256()
        why = said("cannot be read")
        try:
            path = place_inside(self.path, name)
            if path is None:
                why = said("lies outside of the project folder: only --allow-outside reads it")
                raise FileNotFoundError(name)
            if path.stat().st_size > MAX_LOG_BYTES:
                why = said(
                    "is larger than {size} MB and was not read", size=MAX_LOG_BYTES // 1024**2
                )
                raise OSError(name)
            with os.fdopen(open_regular(path, os.O_RDONLY), "rb") as stream:
                while block := stream.read(1 << 20):
                    digest.update(block)
        except (OSError, ValueError):
            self.contents[name] = None
            text = said(
                "{where}: the file {name} {why}", where=table.where, name=shown(name), why=why
            )
            self.findings.warnings.append(ResultWarning("missing_file", text))
            return
        self.contents[name] = digest.digest()

    def digest(self) -> str:
        """sha256 of names, lengths and contents, ordered by name, project.toml first."""
        total = hashlib.sha256()
        for name in sorted(self.contents, key=lambda n: (n != PROJECT_FILE, n)):
            data = self.contents[name]
            size = "absent" if data is None else str(len(data))
            total.update(f"{name}\0{size}\0".encode("utf-8", errors="replace"))
            total.update(data or b"")
        return total.hexdigest()


def inside(name: str, table: Table) -> bool:
    """Whether a path stays in the project folder; notes a problem where it does not."""
    path = os.path.normpath(name.replace("\\", "/"))
    if Path(path).is_absolute() or ":" in path[:2] or path == ".." or path.startswith("../"):
        table.problem(
            said("the book lies outside of the project folder"),
            name,
            said("a path below the project folder"),
            said("copy it into observations/"),
        )
        return False
    return True
