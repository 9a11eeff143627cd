"""A project as one zip file for hand-over: the same project, the same bytes.

Everything that a closing would seal, the ledger, and a manifest with the sha256 of each file.
Links and what lies outside of the folder are not packed; sensor logs outside only where that is
asked for, and only as the bytes that project.toml pins by their sha256.
"""

from __future__ import annotations

import hashlib
import io
import os
import shutil
import zipfile
from pathlib import Path
from typing import Final

from surveyapp.errors import Problem, SurveyError
from surveyapp.io.files import shown
from surveyapp.io.filing.dependencies import project_data, rows_of
from surveyapp.io.filing.ledger import LEDGER_FILE
from surveyapp.io.filing.sealed_files import WITNESS_FILE, hash_inside, project_file_names
from surveyapp.io.guarded import MAX_LOG_BYTES, is_regular, open_regular, place_inside
from surveyapp.io.project import check_project_folder
from surveyapp.languages import said

MANIFEST: Final = "MANIFEST.sha256"
_MOMENT: Final = (1980, 1, 1, 0, 0, 0)
"""The earliest moment that a zip can hold: files carry no date, so that bytes do not change."""


def stored_name(name: str, number: int) -> str:
    """Name inside of the archive: never absolute, never above the folder."""
    parts = name.replace("\\", "/").split("/")
    if name.startswith("/") or ":" in parts[0] or ".." in parts:
        return f"outside/{number:03d}-{parts[-1]}"
    return "/".join(part for part in parts if part not in ("", "."))


def logs_outside(folder: Path) -> tuple[tuple[str, str], ...]:
    """Sensor logs that a project names outside of its folder: name as written, pinned sha256."""
    return tuple(
        (str(row["file"]), str(row.get("sha256", "")))
        for row in rows_of(project_data(folder), "sensor_log")
        if row.get("file") and place_inside(folder, str(row["file"])) is None
    )


def _bytes_outside(folder: Path, name: str, sha256: str) -> bytes:
    """A log outside, if it is the one that project.toml pins.

    Raises
    ------
    SurveyError
        If nothing pins it, if it is another file, or if it cannot be read.
    """
    if not sha256:
        raise SurveyError(
            Problem(
                "a log outside is packed only where its sha256 stands in project.toml",
                shown(name),
                "no sha256",
                'sha256 = "..." in its [[sensor_log]]',
            )
        )
    try:
        handle = open_regular(folder / name, os.O_RDONLY, follow=True)
        with os.fdopen(handle, "rb") as stream:
            data = stream.read(MAX_LOG_BYTES + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise SurveyError(
            Problem(said("the file cannot be read ({reason})", reason=reason), shown(name))
        ) from None
    found = hashlib.sha256(data).hexdigest()
    if len(data) > MAX_LOG_BYTES or found != sha256.lower():
        raise SurveyError(
            Problem("this is not the log that project.toml pins", shown(name), found, sha256)
        )
    return data


def archive(folder: Path, *, allow_outside: bool = False) -> tuple[bytes, int]:
    """Zip of a project folder and the number of files in it.

    Parameters
    ----------
    folder : Path
    allow_outside : bool
        Whether sensor logs outside of the folder are packed too.

    Raises
    ------
    SurveyError
        If the folder is no project folder, or a file cannot be read.
    """
    check_project_folder(folder)
    outside = [
        (name, _bytes_outside(folder, name, sha256))
        for name, sha256 in (logs_outside(folder) if allow_outside else ())
    ]
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
        for number, (name, data) in enumerate(outside, start=len(names) + 1):
            stored = f"outside/{number:03d}-{Path(name.replace(chr(92), '/')).name}"
            manifest.append(f"{hashlib.sha256(data).hexdigest()}  {stored}  (named {name})")
            packed.writestr(_info(f"{folder.resolve().name}/{stored}"), data)
        text = "\n".join(manifest) + "\n"
        packed.writestr(_info(f"{folder.resolve().name}/{MANIFEST}"), text)
    return stream.getvalue(), len(names) + len(outside)


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
            Problem(
                said("the file cannot be read ({strerror})", strerror=error.strerror or error),
                str(path),
            )
        ) from None
