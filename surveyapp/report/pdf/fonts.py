"""Faces registered for a page: which draws what, and how wide a text becomes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import lru_cache, partial
from pathlib import Path
from typing import Final
from xml.sax.saxutils import escape

from reportlab.pdfbase import pdfmetrics
from reportlab.pdfbase.cidfonts import UnicodeCIDFont
from reportlab.pdfbase.ttfonts import TTFError, TTFont

from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp.report.faces import base_face, faces_of, further_faces, wide_face
from surveyapp.report.pdf.bidi import can_order, drawn_order, is_right_to_left
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
    further: list[Path] = field(default_factory=list, repr=False)
    _splits: dict[str, list[tuple[str, str]]] = field(default_factory=dict, repr=False)
    _widths: dict[str, float] = field(default_factory=dict, repr=False)
    _base: set[str] = field(default_factory=set, repr=False)
    _taken: list[Face] = field(default_factory=list, repr=False)
    missing: dict[str, str] = field(default_factory=dict)
    referred: set[str] = field(default_factory=set)
    """CID faces that a page refers to and that are not embedded."""

    def of(self, text: str) -> tuple[Face, ...]:
        """Faces for a text: the embedded ones, and a CID face where those lack a wide character."""
        if all(face_has(self.embedded, ord(c)) or not is_wide(ord(c)) for c in text):
            return (*self.embedded, *self._for_the_rest(text))
        name = _CID[language_of(text)]
        if name not in pdfmetrics.getRegisteredFontNames():
            pdfmetrics.registerFont(UnicodeCIDFont(name))
        self.referred.add(name)
        return (*self.embedded, Face(name, is_wide), *self._for_the_rest(text))

    def _for_the_rest(self, text: str) -> tuple[Face, ...]:
        """Further faces, opened only when a text has letters that all faces so far lack."""
        rest = {ord(c) for c in text if c.isprintable() and not is_wide(ord(c))}
        while self.further and not all(face_has((*self.embedded, *self._taken), c) for c in rest):
            path = self.further.pop(0)
            with suppress(SurveyError):
                self._taken.append(_register(f"Further-{path.stem}", path))
        return tuple(self._taken)

    def split(self, text: str) -> list[tuple[str, str]]:
        """Runs of a text, each with the name of the face that draws it."""
        known = self._splits.get(text)
        if known is None:
            base = self.is_base(text) and text.isprintable()
            known = [(BASE, text)] if base else self._runs(text)
            self._splits[text] = known
        return known

    def _runs(self, text: str) -> list[tuple[str, str]]:
        drawn = drawn_order(text)
        faces = self.of(drawn)
        lost = {c for c in drawn if c.isprintable() and not face_has(faces, ord(c))}
        if not can_order():  # letters in the wrong order would be another name
            lost |= {c for c in drawn if is_right_to_left(c)}
        if not lost:
            return runs(drawn, faces)
        if lost <= set(text):
            self.missing[text] = "".join(sorted(lost))
        else:  # a joined form that no face has: the letters as they were written are told
            lost = {c for c in text if is_right_to_left(c)} | (lost & set(text))
            self.missing[text] = "".join(sorted(lost))
            drawn = text
        codes = {ord(letter): f"[{ord(letter):04X}]" for letter in lost}
        return runs(drawn.translate(codes), faces)

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


class _Measured(TTFont):
    """A face that measures a text once: a cell is asked for its width four times."""

    def __init__(self, name: str, path: str) -> None:
        super().__init__(name, path)
        self._unit_width = lru_cache(maxsize=8192)(partial(super().stringWidth, size=UNIT))

    def stringWidth(self, text: str | bytes, size: float, encoding: str = "utf8") -> float:
        """Width of a text [points]."""
        if isinstance(text, bytes):
            text = text.decode(encoding)
        return float(self._unit_width(text)) * size / UNIT


def _register(name: str, path: Path) -> Face:
    try:
        font = _Measured(name, str(path))
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
    """Register the faces: base, then those named by the user, else one found for wide letters.

    Parameters
    ----------
    named : Path or None
        A TrueType face, or a folder of them.
    """
    faces = [_register(BASE, base_face())]
    if named is not None:
        own = faces_of(named)
        many = named.is_dir()  # of a folder, what cannot be embedded is passed over
        for path in own:
            with suppress(*((SurveyError,) if many else ())):
                faces.append(_register(f"Named-{path.stem}", path))
        if len(faces) == 1:
            raise SurveyError(
                Problem(
                    "there is no face that can be embedded",
                    str(named),
                    said("{size} files", size=len(own)),
                    "a TrueType face (.ttf or .ttc) with glyf outlines, or a folder of them",
                )
            )
    wide = wide_face() if named is None else None
    if wide is not None:
        with suppress(SurveyError):
            faces.append(_register(f"Wide-{wide.stem}", wide))
    return Faces(tuple(faces), list(further_faces()))
