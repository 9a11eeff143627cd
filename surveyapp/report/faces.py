"""Where type faces are found: the embedded one, those of packages, those of the system.

Only looks for files. Which face draws which character is decided where the page is written.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from functools import lru_cache
from importlib.util import find_spec
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


WIDE_PACKAGE: Final = "paperang_p2_fonts_cjk"
"""Package of the extra ``glyphs`` with WenQuanYi Micro Hei, a face with all of GB 18030 in use."""
FURTHER_PACKAGES: Final = ("fontpkg_noto_sans_arabic", "fontpkg_heebo", "fontpkg_noto_sans_thai")
"""Packages of the extra ``glyphs``: Arabic, Hebrew, Thai (each under the Open Font License)."""
FURTHER_FACES: Final = (
    "NotoSansArabic-Regular.ttf",
    "NotoNaskhArabic-Regular.ttf",
    "NotoSansHebrew-Regular.ttf",
    "NotoSansThai-Regular.ttf",
    "NotoSansDevanagari-Regular.ttf",
    "NotoSansSymbols2-Regular.ttf",
    "NotoEmoji-Regular.ttf",
    "DejaVuSans.ttf",
    "FreeSans.ttf",
    "arial.ttf",
    "Arial.ttf",
    "tahoma.ttf",
    "leelawui.ttf",
    "Thonburi.ttc",
    "seguisym.ttf",
    "Symbola.ttf",
)
"""File names of TrueType faces with further writings, tried in turn where letters are missing."""


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
def _installed() -> dict[str, Path]:
    """Known faces on this system by the name of their file."""
    known = {*WIDE_FACES, *FURTHER_FACES}
    found: dict[str, Path] = {}
    for folder in _folders():
        try:
            paths = sorted(path for path in folder.rglob("*.tt?") if path.name in known)
        except OSError:
            continue
        for path in paths:
            found.setdefault(path.name, path)
    return found


def wide_face() -> Path | None:
    """A TrueType face with Chinese, Japanese or Korean: of the package, else of this system."""
    spec = find_spec(WIDE_PACKAGE)
    if spec is not None and spec.origin is not None:
        for path in sorted(Path(spec.origin).parent.rglob("*.ttc"))[:1]:
            return path
    return next((_installed()[name] for name in WIDE_FACES if name in _installed()), None)


def faces_of(path: Path) -> tuple[Path, ...]:
    """The face that is named; of a folder every TrueType face in it, by name."""
    if not path.is_dir():
        return (path,)
    return tuple(sorted(p for p in path.iterdir() if p.suffix.lower() in (".ttf", ".ttc")))


def further_faces() -> Iterator[Path]:
    """Faces with further writings: those of installed packages, then those of the system."""
    for package in FURTHER_PACKAGES:
        spec = find_spec(package)
        if spec is not None and spec.origin is not None:
            yield from sorted(Path(spec.origin).parent.rglob("*.ttf"))[:1]
    yield from (_installed()[name] for name in FURTHER_FACES if name in _installed())
