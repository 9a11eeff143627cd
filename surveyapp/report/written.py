"""What a written report is: its place, pages, sections and hash."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

from surveyapp.domain.warning import ResultWarning

_SHOWN: Final = 5


@dataclass(frozen=True, slots=True)
class SheetsResult:
    """Sheets that were written beside a record.

    Parameters
    ----------
    paths : tuple of str
    problems : tuple of str
        Why a traverse has no sheet.
    """

    paths: tuple[str, ...]
    problems: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """Keys that ``report --sheets`` adds to its JSON."""
        return {"sheets": list(self.paths), "without_sheet": list(self.problems)}


@dataclass(frozen=True, slots=True)
class ReportResult:
    """A report that was written.

    Parameters
    ----------
    path : str
    pages : int
    sections : tuple of str
        Ids in order.
    sha256 : str
        Of the file.
    missing : tuple of (str, str)
        Texts that hold letters no type face at hand has, and those letters: they are printed as
        their codes.
    signature : str
        File of the signature with a key; empty without a key.
    referred : tuple of str
        Faces that the pages refer to and that are not embedded.
    """

    path: str
    pages: int
    sections: tuple[str, ...]
    sha256: str
    missing: tuple[tuple[str, str], ...] = ()
    signature: str = ""
    referred: tuple[str, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON, schema ``surveyapp.report/1``."""
        return {
            "schema": "surveyapp.report/1",
            "path": self.path,
            "pages": self.pages,
            "sections": list(self.sections),
            "sha256": self.sha256,
            "signature": self.signature or None,
            "missing_glyphs": [
                {"text": text, "characters": [f"U+{ord(letter):04X}" for letter in letters]}
                for text, letters in self.missing
            ],
            "warnings": [warning.to_dict() for warning in self.warnings],
        }

    @property
    def warnings(self) -> tuple[ResultWarning, ...]:
        """Letters that are printed as their codes, and faces that are not in the file."""
        found = []
        if self.missing:
            found.append(ResultWarning("glyphs_missing", missing_text(self.missing)))
        if self.referred:
            found.append(ResultWarning("face_not_embedded", referred_text(self.referred)))
        return tuple(found)


def missing_text(missing: tuple[tuple[str, str], ...]) -> str:
    """Which texts cannot be printed as they are written."""
    letters = len(set("".join(found for _, found in missing)))
    shown = ", ".join(text[:40] for text, _ in missing[:_SHOWN])
    more = f" and {len(missing) - _SHOWN} more" if len(missing) > _SHOWN else ""
    return (
        f"No type face at hand has {letters} of the letters in: {shown}{more}. The record prints "
        "their codes in brackets. pip install 'surveyapp[glyphs]' brings Arabic, Hebrew and Thai; "
        "--font FILE.ttf, or a folder of faces, names what has the others."
    )


def referred_text(faces: tuple[str, ...]) -> str:
    """Which faces a viewer must have, and how they come into the file."""
    return (
        f"The record refers to the type face {', '.join(faces)} and does not contain it: a viewer "
        "without it shows no Chinese, Japanese or Korean. pip install 'surveyapp[glyphs]' brings a "
        "face that is embedded; --font FILE.ttf names one."
    )
