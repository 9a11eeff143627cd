"""Simulated projects written to disk, with the truth in a file that no other command reads."""

from __future__ import annotations

import json
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from surveyapp.errors import Problem, SurveyError
from surveyapp.io.tomltext import atomic_write, replace_held
from surveyapp.languages import said

TRUTH_FILE = "truth.json"


@dataclass(frozen=True, slots=True)
class SimulatedFiles:
    """What a simulation wrote.

    Parameters
    ----------
    folder, truth : str
    files : tuple of str
        Relative to the folder, the truth not among them.
    """

    folder: str
    truth: str
    files: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "schema": "surveyapp.simulate/1",
            "folder": self.folder,
            "truth": self.truth,
            "files": list(self.files),
        }


def write_simulated(
    folder: Path, files: Mapping[str, str], truth: Mapping[str, object]
) -> SimulatedFiles:
    """Write a simulated project into a folder of its own.

    Raises
    ------
    SurveyError
        If the folder holds anything, or cannot be written.
    """
    try:
        if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
            raise SurveyError(
                Problem(
                    what="a simulated project needs a folder of its own",
                    where=str(folder),
                    found="a folder that is not empty" if folder.is_dir() else "a file",
                    expected="a folder that does not exist or is empty",
                )
            )
        part = folder.with_name(f".{folder.name}.part")
        if part.is_dir() and not part.is_symlink():
            shutil.rmtree(part)  # of a simulation that was interrupted
        for name, text in files.items():
            path = part / name
            path.parent.mkdir(parents=True, exist_ok=True)
            atomic_write(path, text.encode())
        text = json.dumps(truth, indent=2, ensure_ascii=False) + "\n"
        atomic_write(part / TRUTH_FILE, text.encode())
        if folder.exists():
            folder.rmdir()
        replace_held(part, folder)
    except OSError as error:
        reason = error.strerror or str(error)
        raise SurveyError(
            Problem(said("the folder cannot be written ({reason})", reason=reason), str(folder))
        ) from None
    return SimulatedFiles(str(folder), str(folder / TRUTH_FILE), tuple(sorted(files)))
