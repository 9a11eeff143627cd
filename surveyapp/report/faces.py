"""Where type faces are found: the embedded one, and one with Chinese, Japanese and Korean.

Only looks for files. Which face draws which character is decided where the page is written.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import Final

WIDE_FACES: Final = (
    "NotoSansSC[wght].ttf",
    "NotoSansSC-Regular.ttf",
    "NotoSansCJKsc-Regular.ttf",
    "NotoSansJP[wght].ttf",
    "NotoSansKR[wght].ttf",
    "wqy-microhei.ttc",
    "wqy-zenhei.ttc",
    "DroidSansFallbackFull.ttf",
    "DroidSansFallback.ttf",
    "msyh.ttc",
    "simhei.ttf",
    "simsun.ttc",
    "msgothic.ttc",
    "malgun.ttf",
    "Arial Unicode.ttf",
    "ARIALUNI.TTF",
    "STHeiti Light.ttc",
    "AppleGothic.ttf",
)
"""File names of TrueType faces with Chinese, Japanese or Korean, the first found is taken."""


def base_face() -> Path:
    """File of the face that every record embeds: Noto Sans (Latin, Greek, Cyrillic)."""
    import fontpkg_noto_sans

    folder = Path(fontpkg_noto_sans.__file__).parent
    faces = sorted(path for path in folder.rglob("*.ttf") if "Italic" not in path.name)
    return faces[0]


def _folders() -> Iterator[Path]:
    home = Path.home()
    yield from (home / ".fonts", home / ".local" / "share" / "fonts")
    if sys.platform == "win32":
        yield Path(os.environ.get("WINDIR", "C:/Windows")) / "Fonts"
    elif sys.platform == "darwin":
        yield from (home / "Library/Fonts", Path("/Library/Fonts"), Path("/System/Library/Fonts"))
    else:
        yield from (Path("/usr/local/share/fonts"), Path("/usr/share/fonts"))


@lru_cache(maxsize=1)
def wide_face() -> Path | None:
    """First known TrueType face with Chinese, Japanese or Korean on this system, else None."""
    found: dict[str, Path] = {}
    for folder in _folders():
        try:
            paths = sorted(path for path in folder.rglob("*.tt?") if path.name in WIDE_FACES)
        except OSError:
            continue
        for path in paths:
            found.setdefault(path.name, path)
    return next((found[name] for name in WIDE_FACES if name in found), None)
