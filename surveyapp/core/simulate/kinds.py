"""The kinds of record that can be simulated, by the name they have on the command line."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from surveyapp.core.simulate.campaign import CAMPAIGN_EFFECTS, CampaignSpec, simulate_campaign
from surveyapp.core.simulate.campaign_project import campaign_files, campaign_truth
from surveyapp.core.simulate.project import (
    project_files,
    project_truth,
    simulate_reversal_project,
)
from surveyapp.core.simulate.rate import recipes as rate_recipes
from surveyapp.core.simulate.sensors import (
    COMPASS_EFFECTS,
    TILT_EFFECTS,
    parse_coefficients,
    simulate_compass,
    simulate_noise,
    simulate_tilt,
)
from surveyapp.core.simulate.specification import (
    RUN_EFFECTS,
    Effect,
    EffectKind,
    SessionSpec,
    parse_effect,
)
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.languages import said

KINDS: Final[dict[str, tuple[EffectKind, ...]]] = {
    "reversal-run": RUN_EFFECTS,
    "campaign": CAMPAIGN_EFFECTS,
    "compass": COMPASS_EFFECTS,
    "tilt": TILT_EFFECTS,
    "noise": (),
    **{kind: rate_recipes.effects_of(kind, None) for kind in rate_recipes.PROGRAMMES},
}
"""Kind to the effects that it knows."""

RUN_POINTS: Final = 20
TEMPERATURE_SPAN_C: Final = 1.0


def simulate_kind(
    kind: str,
    *,
    effects: Sequence[str],
    seed: int,
    programme: str | None = None,
    coefficients: Sequence[str] = (),
) -> tuple[dict[str, str], dict[str, Any]]:
    """Simulate a whole project.

    Parameters
    ----------
    kind : str
        A key of ``KINDS``.
    effects : sequence of str
        ``ID=VALUE[,option=value]`` each, in the units of the command line.
    seed : int
        The same seed gives the same project.
    programme : str, optional
        Of a rate sensor; default its first.
    coefficients : sequence of str
        Of noise: ``SYMBOL=VALUE`` each.

    Returns
    -------
    files : dict
        Relative path to text: a project that the program reads.
    truth : dict
        For truth.json; no other command reads it.

    Raises
    ------
    SurveyError
        Unknown kind or effects, all problems together.
    """
    if kind not in KINDS:
        hint = nearest_names(kind, KINDS)
        raise SurveyError(Problem("unknown kind of simulation", "simulate", kind, hint=hint))
    known = KINDS[kind]
    if kind in rate_recipes.PROGRAMMES:
        known = rate_recipes.effects_of(kind, programme)
    elif programme is not None:
        raise SurveyError(Problem("this kind has no programmes", "programme", programme))
    if coefficients and kind != "noise":
        found, expected = said("a simulation of {kind}", kind=kind), "simulate noise"
        raise SurveyError(Problem("coefficients belong to noise", "coefficient", found, expected))
    parsed: list[Effect] = []
    problems: list[Problem] = []
    for text in effects:
        try:
            parsed.append(parse_effect(text, known))
        except SurveyError as error:
            problems += error.problems
    if problems:
        raise SurveyError(problems)
    rng = np.random.default_rng(seed)
    if kind in rate_recipes.PROGRAMMES:
        files, truth = rate_recipes.simulate_rate(kind, programme, effects=parsed, rng=rng)
        return files, truth | {"seed": seed}
    if kind == "noise":
        files, truth = simulate_noise(parse_coefficients(coefficients), rng)
        return files, truth | {"seed": seed}
    if kind in ("compass", "tilt"):
        make = simulate_compass if kind == "compass" else simulate_tilt
        files, truth = make(parsed, rng)
        return files, truth | {"seed": seed}
    if kind == "campaign":
        campaign = simulate_campaign(CampaignSpec(effects=tuple(parsed)), rng)
        return campaign_files(campaign), campaign_truth(campaign) | {"seed": seed}
    spec = SessionSpec(
        points=RUN_POINTS, effects=tuple(parsed), temperature_span_c=TEMPERATURE_SPAN_C
    )
    project = simulate_reversal_project(spec, rng)
    return project_files(project), project_truth(project) | {"seed": seed}
