"""Breakthroughs for scripts, re-exported by ``surveyapp.api``: how far will two headings miss."""

from __future__ import annotations

from surveyapp.api.orientation import Source, oriented
from surveyapp.api.project import SOFTWARE
from surveyapp.domain.penetration_result import Prediction


def predict(source: Source, *, plan: int | None = None, monte_carlo: bool = True) -> Prediction:
    """Predict the miss at the meeting point of a project's headings.

    Parameters
    ----------
    source : Project, path or Computed
    plan : int or None
        Place this many further gyro sides as well; no Monte Carlo then.
    monte_carlo : bool
        Simulate surveys beside the covariance.

    Raises
    ------
    SurveyError
        If there is no ``[penetration]``, or with every reason why it cannot be predicted.
    """
    from surveyapp.core.penetration.prediction import prediction
    from surveyapp.workflows.predicting import ready_mine

    found = oriented(source, even_unfinished=True)
    kept = found.orientation.project
    ready = ready_mine(kept, found.result() if kept.sessions else None, plan_sides=plan)
    return prediction(
        ready.mine,
        ready.rule_book,
        project=kept.name,
        software=SOFTWARE,
        digest=kept.digest,
        warnings=ready.warnings,
    )
