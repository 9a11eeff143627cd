"""The terms of the budget: every source of error of an azimuth, and where its size comes from."""

from __future__ import annotations

from typing import Final

TERMS: Final[dict[str, str]] = {
    "turning points": "residuals of the run, else the card",
    "scale readings": "residuals of the run, else the card",
    "passages": "the card's time sigma",
    "scale readings and passages": "residuals of the run, else the card",
    "rounds": "scatter of the rounds, else the card",
    "clamp reading": "its last digit",
    "damping": "difference of the estimators",
    "tape zero": "residuals of the tape zero, else the card",
    "tape zero change": "after minus before, over sqrt(12)",
    "torsion ratio": "periods or torsion of the card",
    "transit constant": "transit of the card",
    "linear form": "(pi dt / 2 T2)^2 / 6",
    "sights": "residuals of all sights of the instrument, else the card",
    "eccentricity": "eccentric.sigma_m",
    "levelling": "sigma.level_arcsec of the card, else half a division of its level, times cot z",
    "graduation": "sigma.graduation_arcsec of the card",
    "twist": "sigma.twist_arcsec of the card, where no second sights tell it",
    "lateral refraction": "refraction_sigma_arcsec of the session, else the card's",
    "observer": "sigma.observer_arcsec of the card; remedy: exchange of observers",
    "scatter of determinations": "repeated sessions that state no sigma",
    "run-to-run scatter": "repeated sessions of one line",
    "centring": "centring_mm over the length of the line",
    "known azimuth": "azimuth_known_sigma_arcsec, else sigma_m of the stations (assumed 5 mm) over "
    "the length",
    "known constant": "constant.sigma_arcsec of the instrument",
    "constant instability": "lines or epochs that disagree",
    "temperature of the constant": "sigma.temperature_arcsec_per_c of the card",
    "latitude of the constant": "sigma.latitude_arcsec of the card, times sec(latitude)",
    "adopted effect": "covariance of the adopted effect",
    "deflection": 'deflection of the stations or the region (assumed 5" and 20 km, values of '
    "reason)",
    "printed convergence": "convergence_sigma_arcsec, else the last printed digit",
    "rotation of the mine grid": "grid.rotation_sigma_arcsec",
}
"""By name of the source."""
ALWAYS: Final = (
    "levelling",
    "graduation",
    "twist",
    "lateral refraction",
    "observer",
    "temperature of the constant",
    "latitude of the constant",
    "centring",
    "known azimuth",
    "deflection",
)
"""Terms that stand on every budget, zero or not."""
