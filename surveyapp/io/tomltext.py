"""TOML as text, and files that are replaced as a whole or not at all.

Nothing here knows what a project is.
"""

from __future__ import annotations

import datetime as dt
import json
import math
import os
import re
import tempfile
import time
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from surveyapp.errors import Problem, SurveyError
from surveyapp.io.files import shown, shown_path
from surveyapp.languages import said

_WAITS_S = (0.05, 0.1, 0.2, 0.4, 0.8)
_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
_TOKEN = re.compile(
    r'"""(?:\\.|[^\\])*?"{3,5}'
    r"|'''.*?'{3,5}"
    r'|"(?:\\.|[^"\\\n])*"'
    r"|'[^'\n]*'"
    r"|(?P<comment>#[^\n]*)",
    re.DOTALL,
)


def sync_folder(folder: Path) -> None:
    """Put the entry of a new file on the disk, where the system knows how."""
    try:
        handle = os.open(folder, os.O_RDONLY)
    except OSError:
        return
    try:
        os.fsync(handle)
    except OSError:
        pass
    finally:
        os.close(handle)


def atomic_write(path: Path, data: bytes | Iterable[bytes]) -> None:
    """Replace a file as a whole, or leave it as it was.

    Parameters
    ----------
    path : Path
    data : bytes or iterable of bytes
        Its content, or that in pieces.

    Raises
    ------
    SurveyError
        If the system refuses; the old file stands.
    """
    temporary: str | None = None
    try:
        handle, temporary = tempfile.mkstemp(
            dir=path.parent, prefix=f".{path.name}.", suffix=".tmp"
        )
        with os.fdopen(handle, "wb") as stream:
            for piece in (data,) if isinstance(data, bytes) else data:
                stream.write(piece)
            stream.flush()
            os.fsync(stream.fileno())
        mode = path.stat().st_mode & 0o777 if path.exists() else 0o644
        Path(temporary).chmod(mode)
        replace_held(Path(temporary), path)
        temporary = None
        sync_folder(path.parent)
    except OSError as error:
        raise SurveyError(
            Problem(
                said(
                    "the file could not be written ({strerror})", strerror=error.strerror or error
                ),
                path.name,
                shown_path(path),
                "a folder with room that may be written to",
                "the old file stands" if path.exists() else "nothing was written",
            )
        ) from None
    finally:
        if temporary is not None:
            Path(temporary).unlink(missing_ok=True)


def replace_held(temporary: Path, path: Path) -> None:
    """Put a file or folder in its place, a few times where another program holds it.

    A sync service, a virus scanner or a viewer lets go after a moment.

    Raises
    ------
    OSError
        If it is held for longer, or the system refuses otherwise.
    """
    for wait in (*_WAITS_S, None):
        try:
            temporary.replace(path)
        except PermissionError:
            if wait is None:
                raise
            time.sleep(wait)
        else:
            return


def comments(text: str) -> list[str]:
    """Every comment of a TOML text, in order, without what merely looks like one in a string."""
    return [m["comment"].rstrip() for m in _TOKEN.finditer(text) if m["comment"] is not None]


def toml_value(value: object) -> str:
    """Write a value as TOML on one line.

    Raises
    ------
    SurveyError
        For what TOML cannot hold, and for numbers that are not finite.
    """
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, int):
        return str(int(value))
    if isinstance(value, float) and math.isfinite(value):
        return repr(float(value))  # a subclass of numpy writes its own name
    if isinstance(value, dt.date | dt.datetime | dt.time):
        return value.isoformat()
    if isinstance(value, Mapping):
        inner = ", ".join(f"{toml_key(k)} = {toml_value(v)}" for k, v in present(value).items())
        return f"{{ {inner} }}" if inner else "{}"
    if isinstance(value, Sequence):
        return "[" + ", ".join(toml_value(item) for item in value) + "]"
    raise SurveyError(Problem("the value cannot be written to a project", "", shown(value)))


def toml_key(key: str) -> str:
    """A key, in quotes where it must be."""
    return key if _BARE_KEY.fullmatch(key) else toml_value(key)


def present(mapping: Mapping[str, object]) -> dict[str, object]:
    """The mapping without what is None: TOML has no word for it."""
    return {key: value for key, value in mapping.items() if value is not None}


def plain(value: object) -> object:
    """The value as a parser would return it."""
    if isinstance(value, Mapping):
        return {key: plain(item) for key, item in present(value).items()}
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [plain(item) for item in value]
    return value
