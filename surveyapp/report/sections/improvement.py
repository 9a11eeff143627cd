"""What would improve an azimuth most, in the trade's words."""

from __future__ import annotations

from typing import Final

from surveyapp.core.improvement import most_helpful
from surveyapp.domain.results import LineResult
from surveyapp.languages import said, term
from surveyapp.report.numbers import seconds

ADVICE: Final = {
    "adopted effect": said("observe again without the disturbance, or longer with it"),
    "adopted effect outside its range": said("measure what the effect needs within its range"),
    "centring": said("centre more exactly, or take a longer line"),
    "clamp reading": said("read the clamped circle several times"),
    "constant instability": said("calibrate near the survey, before and after it"),
    "constant: cause not known": said("calibrate again as the diagnosis advises"),
    "constant: scatter in the archive": said("determine the constant four times and more"),
    "constant: scatter of the determinations": said("calibrate more often"),
    "damping": said("read more turning points"),
    "deflection": said("have the deflection of the vertical determined there"),
    "eccentricity": said("measure the eccentric elements again, or set up on the mark"),
    "graduation": said("shift the circle between the rounds"),
    "known azimuth": said("calibrate on a line whose azimuth is known better"),
    "known constant": said("calibrate on a known line, before and after"),
    "lateral refraction": said("keep the sight off the wall, or observe it from both ends"),
    "latitude of the constant": said("calibrate at the latitude of the survey"),
    "levelling": said("level again, read the level, or take a flatter sight"),
    "linear form": said("clamp nearer to north, or state the torsion ratio"),
    "observer": said("exchange the observers between two runs"),
    "passages": said("time more passages"),
    "plan": said("determine the coordinates of the ends better"),
    "printed convergence": said("name the crs, or have the convergence printed to more digits"),
    "rotation of the mine grid": said("determine the rotation of the mine grid on a longer line"),
    "rounds": said("take more rounds"),
    "run-to-run scatter": said("repeat the session: runs differ by more than their readings tell"),
    "scale readings": said("read more turning points on the scale"),
    "scale readings and passages": said("time more passages and read more turning points"),
    "scatter of determinations": said("repeat the calibration"),
    "sights": said("sight the target more often in both faces"),
    "tape zero": said("read more turning points of the tape zero, before and after"),
    "tape zero change": said("observe the tape zero again; adjust it if it moves"),
    "temperature of the constant": said("calibrate at the temperature of the survey"),
    "torsion ratio": said("have the torsion ratio determined from T1 and T2"),
    "transit constant": said("determine the transit constant by two clampings"),
    "turning points": said("read more turning points"),
    "twist": said("sight the target again after the swing"),
    "unknown damping": said("read at least four turning points"),
}
"""What a surveyor does about a part of the budget, by its source."""


def most_helps(line: LineResult) -> str:
    """What would improve an azimuth most, and by how much; empty where nothing is known."""
    found = most_helpful(line.budget)
    if found is None:
        return ""
    advice = ADVICE.get(found.source, term(found.source))
    if found.at_calibration:
        advice = said("at the calibration, {advice}", advice=advice)
    if sum(item.sigma > 0.0 for item in line.budget) == 1:
        return said("Most helps: {advice}. Nothing else is in this sigma.", advice=advice)
    return said(
        'Most helps: {advice}. Without this part ±{without}" instead of ±{sigma}".',
        advice=advice,
        without=seconds(found.without),
        sigma=seconds(found.sigma),
    )
