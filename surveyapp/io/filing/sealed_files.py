"""The files of a project folder that a closing seals and a hand-over packs.

Regular files inside the folder only: links, devices and pipes are passed over, and what a project
names outside of its folder is no part of it.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from surveyapp.errors import Problem, SurveyError
from surveyapp.io.files import shown
from surveyapp.io.filing.ledger import LEDGER_FILE
from surveyapp.io.guarded import (
    MAX_LOG_BYTES,
    is_regular,
    open_regular,
    outside_problem,
    place_inside,
)
from surveyapp.languages import said

WITNESS_FILE: Final = "closings.txt"
_LEFT_OUT: Final = frozenset({"results"})
_MOST_FILES: Final = 20_000


@dataclass(frozen=True, slots=True)
class SealedFile:
    """A file under a seal: its name as written, its size and its sha256."""

    name: str
    size: int
    sha256: str

    def to_dict(self) -> dict[str, Any]:
        """Plain values for the ledger."""
        return {"name": self.name, "bytes": self.size, "sha256": self.sha256}


def hash_inside(folder: Path, name: str) -> SealedFile:
    """Size and sha256 of a file of a project, read in pieces: a log may be large.

    Raises
    ------
    SurveyError
        If it cannot be read, is no regular file, is too large, or lies outside.
    """
    digest, size = hashlib.sha256(), 0
    path = place_inside(folder, name)
    if path is None:
        raise SurveyError(outside_problem(name, where=shown(name)))
    try:
        with os.fdopen(open_regular(path, os.O_RDONLY), "rb") as stream:
            if os.fstat(stream.fileno()).st_size > MAX_LOG_BYTES:
                raise OSError(f"it is larger than {MAX_LOG_BYTES // 1024**2} MB")
            while block := stream.read(1 << 20):
                digest.update(block)
                size += len(block)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise SurveyError(
            Problem(
                said("the file cannot be read ({reason})", reason=reason),
                shown(name),
                shown(str(path)),
            )
        ) from None
    return SealedFile(name, size, digest.hexdigest())


def project_file_names(folder: Path) -> tuple[str, ...]:
    """Names of everything that a closing seals, project.toml first, the others sorted."""
    names = sorted(_walk(folder), key=lambda name: (name != "project.toml", name))
    return tuple(name for name in names if name not in (LEDGER_FILE, WITNESS_FILE))


def _walk(folder: Path) -> Iterator[str]:
    count = 0
    for root, folders, files in os.walk(folder, followlinks=False):
        top = Path(root) == folder
        folders[:] = [
            name for name in folders if not name.startswith(".") and not (top and name in _LEFT_OUT)
        ]
        for name in files:
            path = Path(root) / name
            if not name.startswith(".") and is_regular(path):
                count += 1
                if count > _MOST_FILES:
                    raise SurveyError(
                        Problem(
                            "the project folder holds too many files",
                            shown(str(folder)),
                            said("more than {most_files}", most_files=_MOST_FILES),
                            "a folder of its own for each project",
                        )
                    )
                yield path.relative_to(folder).as_posix()
