"""Faces registered for a page: which draws what, and how wide a text becomes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final
from xml.sax.saxutils import escape

from reportlab.pdfbase import pdfmetrics
from reportlab.pdfbase.cidfonts import UnicodeCIDFont
from reportlab.pdfbase.ttfonts import TTFError, TTFont

from surveyapp.errors import Problem, SurveyError
from surveyapp.report.faces import base_face, wide_face
from surveyapp.report.typeface import Face, is_wide, language_of, runs

BASE: Final = "SurveySans"
UNIT: Final = 1000.0
"""Size [points] at which widths are kept: those of a face are whole numbers there."""
_CID: Final = {"zh": "STSong-Light", "ja": "HeiseiKakuGo-W5", "ko": "HYGothic-Medium"}


@dataclass(frozen=True, slots=True)
class Faces:
    """Faces in order of preference; what a text needs is found once and kept.

    ``missing`` holds every text with letters that no face has, and those letters: they are drawn
    as their code in brackets, so that no two names look alike.
    """

    embedded: tuple[Face, ...]
    _splits: dict[str, list[tuple[str, str]]] = field(default_factory=dict, repr=False)
    _widths: dict[str, float] = field(default_factory=dict, repr=False)
    _base: set[str] = field(default_factory=set, repr=False)
    missing: dict[str, str] = field(default_factory=dict)

    def of(self, text: str) -> tuple[Face, ...]:
        """Faces for a text: the embedded ones, and a CID face where those lack a wide character."""
        if all(face_has(self.embedded, ord(c)) or not is_wide(ord(c)) for c in text):
            return self.embedded
        name = _CID[language_of(text)]
        if name not in pdfmetrics.getRegisteredFontNames():
            pdfmetrics.registerFont(UnicodeCIDFont(name))
        return (*self.embedded, Face(name, is_wide))

    def split(self, text: str) -> list[tuple[str, str]]:
        """Runs of a text, each with the name of the face that draws it."""
        known = self._splits.get(text)
        if known is None:
            base = self.is_base(text) and text.isprintable()
            known = [(BASE, text)] if base else self._runs(text)
            self._splits[text] = known
        return known

    def _runs(self, text: str) -> list[tuple[str, str]]:
        faces = self.of(text)
        lost = sorted({c for c in text if c.isprintable() and not face_has(faces, ord(c))})
        if not lost:
            return runs(text, faces)
        self.missing[text] = "".join(lost)
        codes = {ord(letter): f"[{ord(letter):04X}]" for letter in lost}
        return runs(text.translate(codes), faces)

    def markup(self, text: str) -> str:
        """Text with a font tag for every run that the base face cannot draw."""
        parts = []
        for name, run in self.split(text):
            safe = escape(run)
            parts.append(safe if name == BASE else f'<font name="{name}">{safe}</font>')
        return "".join(parts)

    def width(self, text: str, size: float) -> float:
        """Width of a text [points]."""
        known = self._widths.get(text)
        if known is None:
            parts = (pdfmetrics.stringWidth(run, name, UNIT) for name, run in self.split(text))
            known = self._widths[text] = float(sum(parts))
        return known * size / UNIT

    def is_base(self, text: str) -> bool:
        """Whether the base face alone draws a text."""
        letters = set(text)
        if not letters <= self._base:
            self._base.update(c for c in letters if self.embedded[0].has(ord(c)))
        return letters <= self._base


def undrawn(texts: Iterable[str]) -> tuple[tuple[str, str], ...]:
    """Texts with letters that no face at hand has, and those letters."""
    faces = register_faces(None)
    for text in texts:
        faces.split(text)
    return tuple(sorted(faces.missing.items()))


def face_has(faces: Sequence[Face], code: int) -> bool:
    """Whether any of the faces draws a code point."""
    return any(face.has(code) for face in faces)


def _register(name: str, path: Path) -> Face:
    try:
        font = TTFont(name, str(path))
    except (TTFError, OSError, ValueError, KeyError) as error:
        raise SurveyError(
            Problem(
                "this type face cannot be embedded",
                str(path),
                str(error),
                "a TrueType face (.ttf or .ttc) with glyf outlines",
                "OpenType faces with PostScript outlines (.otf) cannot be used",
            )
        ) from None
    pdfmetrics.registerFont(font)
    glyphs = font.face.charToGlyph
    return Face(name, glyphs.__contains__)


def register_faces(named: Path | None) -> Faces:
    """Register the faces: base, then the one named by the user, else the one found."""
    faces = [_register(BASE, base_face())]
    wide = named if named is not None else wide_face()
    if wide is not None:
        try:
            faces.append(_register(f"Wide-{wide.stem}", wide))
        except SurveyError:
            if named is not None:
                raise
    return Faces(tuple(faces))
