"""A project as one zip file for hand-over: the same project, the same bytes.

Everything that a closing would seal, the ledger, and a manifest with the sha256 of each file.
Links and what lies outside of the folder are never packed.
"""

from __future__ import annotations

import io
import os
import shutil
import zipfile
from pathlib import Path
from typing import Final

from surveyapp.errors import Problem, SurveyError
from surveyapp.io.filing.ledger import LEDGER_FILE
from surveyapp.io.filing.sealed_files import WITNESS_FILE, hash_inside, project_file_names
from surveyapp.io.guarded import is_regular, open_regular
from surveyapp.io.project import check_project_folder

MANIFEST: Final = "MANIFEST.sha256"
_MOMENT: Final = (1980, 1, 1, 0, 0, 0)
"""The earliest moment that a zip can hold: files carry no date, so that bytes do not change."""


def stored_name(name: str, number: int) -> str:
    """Name inside of the archive: never absolute, never above the folder."""
    parts = name.replace("\\", "/").split("/")
    if name.startswith("/") or ":" in parts[0] or ".." in parts:
        return f"outside/{number:03d}-{parts[-1]}"
    return "/".join(part for part in parts if part not in ("", "."))


def archive(folder: Path) -> tuple[bytes, int]:
    """Zip of a project folder and the number of files in it.

    Raises
    ------
    SurveyError
        If the folder is no project folder, or a file cannot be read.
    """
    check_project_folder(folder)
    names = list(project_file_names(folder))
    names += [name for name in (LEDGER_FILE, WITNESS_FILE) if is_regular(folder / name)]
    stream = io.BytesIO()
    manifest = []
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED, compresslevel=6) as packed:
        for number, name in enumerate(names, start=1):
            stored = stored_name(name, number)
            item = hash_inside(folder, name)
            remark = "" if stored == name else f"  (named {name})"
            manifest.append(f"{item.sha256}  {stored}{remark}")
            _store(packed, folder / name, f"{folder.resolve().name}/{stored}")
        text = "\n".join(manifest) + "\n"
        packed.writestr(_info(f"{folder.resolve().name}/{MANIFEST}"), text)
    return stream.getvalue(), len(names)


def _info(name: str) -> zipfile.ZipInfo:
    info = zipfile.ZipInfo(name, _MOMENT)
    info.compress_type = zipfile.ZIP_DEFLATED
    info.external_attr = 0o644 << 16
    return info


def _store(packed: zipfile.ZipFile, path: Path, name: str) -> None:
    try:
        source = os.fdopen(open_regular(path, os.O_RDONLY), "rb")
        with source, packed.open(_info(name), "w") as target:
            shutil.copyfileobj(source, target, 1 << 20)
    except OSError as error:
        raise SurveyError(
            Problem(f"the file cannot be read ({error.strerror or error})", str(path))
        ) from None
