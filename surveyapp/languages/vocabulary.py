"""Names that stand in results as ids or plain words, and that a reader sees in words.

They are no texts where they arise: JSON and scripts compare them. Who shows one asks for its
translation (``term``, ``translated``); tables elsewhere that hold such names are read by
``scripts/extract_texts.py`` itself.
"""

from __future__ import annotations

from typing import Final

VERDICTS: Final = (
    "met",
    "NOT MET",
    "warning",
    "open",
    "adequate",
    "explained",
    "not separable",
    "unattributed",
    "consistent",
    "adopted",
    "rejected",
    "candidate",
    "not significant",
    "implausible",
    "not applicable",
)
UNITS: Final = (
    "arcsec",
    "arcmin",
    "deg",
    "div",
    "gon",
    "dms",
    "times sigma",
    "rounds",
    "observers",
)
CHOICES: Final = (
    "pooled",
    "nearest",
    "interpolated",
    "predicted",
    "known",
)
ESTIMATORS: Final = ("least-squares", "schuler", "amplitude", "transit", "mean", "median")
SIGMA_SOURCES: Final = ("residuals", "card", "rounds")
REFERENCES: Final = ("astronomic", "true", "grid", "gyro")
PARTS: Final = (
    "lateral",
    "longitudinal",
    "vertical",
    "before",
    "after",
    "between",
    "surface",
    "underground",
)
ROUTES: Final = ("loop", "connecting", "height")
CARD_KINDS: Final = ("suspended", "automatic")
SHAFT_BUDGET: Final = (
    "surface angles",
    "surface distances",
    "surface azimuths",
    "underground angles",
    "underground distances",
    "underground azimuths",
    "plumbing",
)
QUANTITIES: Final = (
    "clamp reading",
    "middle of the swing",
    "torsion ratio",
    "scale value",
    "transit constant",
    "centre of the swing",
)
KINDS_OF_NAMES: Final = ("campaign", "instrument", "sensor", "session", "station", "traverse")
VOCABULARY: Final = (
    *VERDICTS,
    *UNITS,
    *CHOICES,
    *ESTIMATORS,
    *SIGMA_SOURCES,
    *REFERENCES,
    *PARTS,
    *ROUTES,
    *CARD_KINDS,
    *KINDS_OF_NAMES,
    *SHAFT_BUDGET,
    *QUANTITIES,
)
