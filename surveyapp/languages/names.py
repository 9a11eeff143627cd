"""Names of sensor parameters, noise terms and effects, in words that can be said in a language.

A name is an id of JSON and cards, ``soft_iron_xx``: a quantity, then what it is of. The quantity
and the words behind it stand in the catalogues once, axes and numbers stay as they are. Which
quantities there are, ``scripts/extract_texts.py`` reads here.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Final, Self

from surveyapp.languages.said import Said, Translate, joined, term

QUANTITIES: Final = (
    "acceleration ramp",
    "acceleration random walk",
    "accelerometer bias",
    "accelerometer misalignment",
    "accelerometer scale factor",
    "angle random walk",
    "ar1",
    "bandwidth",
    "bias",
    "bias instability",
    "bias ramp",
    "bias scale",
    "capacitance",
    "capacitance difference over mean",
    "capacitance difference over sum",
    "centre",
    "collimation",
    "constant mm",
    "cross",
    "cyclic amplitude mm",
    "cyclic cosine mm",
    "cyclic sine mm",
    "deviation",
    "elevation",
    "field",
    "field gradient",
    "full",
    "g sensitivity",
    "gross error",
    "gyro north",
    "hard iron",
    "instrument constant",
    "interference line",
    "interference step",
    "linearity",
    "magnetic sensitivity",
    "misalignment",
    "none",
    "quantization noise",
    "random walk",
    "rate ramp",
    "rate random walk",
    "rest rate",
    "scale",
    "scale asymmetry",
    "scale factor",
    "scales",
    "sensitivity",
    "soft iron",
    "temperature",
    "three scales",
    "tilt reversal",
    "transverse direction",
    "transverse seven position",
    "transverse sinusoid",
    "unit length m",
    "velocity random walk",
    "zero",
    "zero and scale",
    "zero stability",
    "zero stability detrended",
    "all terms",
    "as read",
    "atmosphere",
    "constant",
    "cyclic",
    "reduced",
    "flip error",
    "quadratic",
    "quadratic drag",
    "scale nonlinearity",
    "cross axis",
    "smooth",
    "periodic",
    "pulse",
    "long oscillation",
    "amplitude smooth",
    "amplitude step",
    "amplitude walk",
    "outlier",
)
OF: Final = ("along", "across", "upper", "lower", "small angle", "arcsine")
"""What a quantity is of, behind its name, where that is a word."""
WORDS: Final = (
    "stationary",
    "steady",
    "accelerating",
    "braking",
    "turning",
    "linear",
    "inertial",
    "odometer",
    "loop",
    "connecting",
    "ASTRONOMIC",
    "MAGNETIC",
    "GRID",
    "height",
    "resolved",
    "ambiguous",
    "undetermined",
    "heading of the sensor",
    "sudden step",
    "good",
    "restricted",
    "explained",
    "not determined",
    "unit",
    "record too short",
    "no power",
    "no power law",
    "not separable",
    "not significant",
    "compass",
    "swing",
    "tilt",
    "dividing-head",
    "edm",
    "fog-station",
    "six-position",
    "multi-position",
    "indexing",
    "rotation",
)
"""Verdicts, reasons and kinds of the results of sensors."""
_OTHERWISE: Final = {"heading": "heading of the sensor", "step": "sudden step"}
"""Ids that are another word of the trade where they stand alone."""
_LONGEST_FIRST: Final = tuple(sorted(QUANTITIES, key=len, reverse=True))


class _Id(Said):
    """A text whose English is the id itself: it is said in words in the other languages."""

    __slots__ = ()

    def __new__(cls, template: str, fields: dict[str, Any], plural: str | None = None) -> Self:
        """The id stands in the field ``id``, its words in ``words``."""
        made = str.__new__(cls, fields["id"])
        made.template, made.fields, made.plural = template, fields, plural
        return made

    def told(self, translate: Translate) -> str:
        """The words in a language; the id where that has no other words than English."""
        words = self.fields["words"]
        text = words.told(translate) if isinstance(words, Said) else str(words)
        return str(self) if text == words else text


def named(name: str) -> str:
    """A name in words, ``hard iron x``; what is no name of the tables is itself a text.

    Parameters
    ----------
    name : str
        As in the JSON: ``hard_iron_x``.
    """
    if isinstance(name, Said):
        return name
    if name in _OTHERWISE:
        return _Id("{words}", {"id": name, "words": term(_OTHERWISE[name])})
    words = name.replace("_", " ")
    for quantity in _LONGEST_FIRST:
        if words == quantity:
            return term(words)
        if words.startswith(f"{quantity} "):
            return joined(" ", (term(quantity), *_behind(words[len(quantity) + 1 :])))
    whole, _, number = words.rpartition(" ")
    if whole and number.isdigit():
        return joined(" ", (named(whole), number))
    return term(words)


def _behind(words: str) -> Iterable[str]:
    """Axes and numbers as they are, a word as a text."""
    for word in OF:
        if words == word:
            return (term(word),)
        if words.endswith(f" {word}"):
            return (words.removesuffix(f" {word}"), term(word))
    return (words,)


def by_id(name: str) -> str:
    """A name where English prints the id: ``hard_iron_x``, in German ``Hard-Iron x``.

    Several effects together are told each by itself: ``warm_up + midpoint_step``.
    """
    if isinstance(name, Said):
        return name
    words = joined(" + ", [named(part) for part in name.split(" + ")])
    return _Id("{words}", {"id": name, "words": words})


def spoken(identity: str, words: str) -> str:
    """A word that English prints as it is, and other languages by the text that it stands for."""
    return _Id("{words}", {"id": identity, "words": words})


def ids(names: Iterable[str]) -> str:
    """Several of them in a row."""
    return joined(", ", [by_id(name) for name in names])
