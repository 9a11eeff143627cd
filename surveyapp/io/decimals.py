"""Numbers as a hand types them in a form: a decimal comma is as good as a point."""

from __future__ import annotations

import math
import re
from typing import Final

from surveyapp.languages import said

_NUMBER: Final = re.compile(r"[+-]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eE][+-]?\d{1,3})?")
_DECIMAL_COMMA: Final = re.compile(r"[+-]?\d+,\d+")


def typed_number(text: str) -> float:
    """A number with a decimal point or a decimal comma.

    Raises
    ------
    ValueError
        If it is none, with a text of the catalogue; infinity and nan are none.
    """
    plain = text.strip().replace("\u2212", "-")
    if _NUMBER.fullmatch(plain):
        value = float(plain.replace(",", "."))
        if math.isfinite(value):
            return value
    raise ValueError(said("{typed} is no number", typed=text.strip()))


def typed_words(text: str) -> list[str]:
    """Words of a line with numbers in it, decimal commas made points.

    Blanks and semicolons separate; commas do where they cannot be decimal signs in all words: where
    a word has two of them, or a point beside one.
    """
    words = [word.strip(",") for word in text.replace(";", " ").split()]
    if any(word.count(",") > 1 or ("," in word and "." in word) for word in words):
        return text.replace(";", " ").replace(",", " ").split()
    return [
        word.replace(",", ".") if _DECIMAL_COMMA.fullmatch(word) else word for word in words if word
    ]
