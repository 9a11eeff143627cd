"""Orientation for scripts, re-exported by ``surveyapp.api``: plan it, reduce it, demonstrate it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from surveyapp.api.project import SOFTWARE, Folder, open_project, opened, require
from surveyapp.api.unfinished import without_unfinished
from surveyapp.domain.project import Project
from surveyapp.domain.results import OrientationResult
from surveyapp.errors import Problem, SurveyError

if TYPE_CHECKING:
    import numpy as np

    from surveyapp.core.comparison import DemonstratedSample
    from surveyapp.core.orientation.whole_project import Orientation
    from surveyapp.core.plan import StationPlan


def generator_of(project: Project) -> np.random.Generator:
    """Random generator whose seed is the digest of the input: the same input, the same result."""
    import numpy as np

    return np.random.default_rng(int(project.digest[:16] or "0", 16))


def orient(
    project: Project | Folder,
    *,
    session: str | None = None,
    line: str | None = None,
    estimator: str | None = None,
) -> OrientationResult:
    """Reduce the sessions of a project and orient its lines.

    Parameters
    ----------
    project : Project or path
    session : str or None
        Show this session alone, and orient its lines from it alone; constants come from all
        calibration sessions.
    line : str or None
        Show this line (``station-target``) alone.
    estimator : str or None
        ``least-squares``, ``schuler``, ``amplitude`` or ``transit``; None for the default.

    Raises
    ------
    SurveyError
        If the project cannot be used, if a session or line of that name does not exist, if a line
        asked for has no azimuth, or if no session of the project is finished.

    Notes
    -----
    Sessions that are still being observed are left out, with a warning ``session_unfinished``.
    """
    project = opened(project)
    if session is not None:
        require(session, [item.id for item in project.sessions], "session")
    kept = without_unfinished(project, keep=() if session is None else (session,))
    if not kept.sessions:
        kept = project
    return oriented(kept, session=session, line=line, estimator=estimator)


def oriented(
    project: Project,
    *,
    session: str | None = None,
    line: str | None = None,
    estimator: str | None = None,
) -> OrientationResult:
    """Orient every session of a project; it may have none."""
    from surveyapp.core.orientation.outcome import outcome
    from surveyapp.io.project_checks import project_checks

    found = computed(project, estimator=estimator, only=session)
    checks = project_checks(project, found)
    result = outcome(found, software=SOFTWARE, only=session, more_checks=checks)
    return result if line is None else _with_line(result, line, project)


def _with_line(result: OrientationResult, name: str, project: Project) -> OrientationResult:
    """The result with one line alone; refused where there is none, or no azimuth of it."""
    from dataclasses import replace

    lines = {f"{item.station}-{item.target}": item for item in result.lines}
    told = [item.text for item in project.warnings if item.code == "session_unfinished"]
    require(name, lines, "line", "; ".join(told))
    if lines[name].true_azimuth is None:
        raise SurveyError(
            Problem(
                what=f"the azimuth of line {name} cannot be determined",
                where=f"instrument {lines[name].instrument}",
                found="no instrument constant",
                expected="calibration sessions on a known line, or a known constant",
                hint="Add a calibration session, or constant = { arcsec, sigma_arcsec }.",
            )
        )
    return replace(result, lines=(lines[name],))


def computed(
    project: Project, *, estimator: str | None = None, only: str | None = None
) -> Orientation:
    """Orient a project; runs with adopted effects are estimated with them in the model."""
    from surveyapp.core.orientation.whole_project import orient_project

    run_model = None
    if any(session.effects for session in project.sessions):
        from surveyapp.diagnosis.subjects.choice import modelled_run

        run_model = modelled_run
    return orient_project(
        project, generator_of(project), estimator=estimator, only=only, run_model=run_model
    )


def plan(
    project: Project | Folder, *, station: str | None = None, interval_arcsec: float = 20.0
) -> tuple[StationPlan, ...]:
    """Plan orientations: method, points and minutes for a wanted interval at each station.

    Parameters
    ----------
    project : Project or path
    station : str or None
        This station alone; None for every station that can be placed (occupied ones if there are
        sessions).
    interval_arcsec : float
        Wanted half-width of the 95 % interval of gyro north.

    Raises
    ------
    SurveyError
        If there is no such station, no instrument, or the interval is not positive.
    """
    import math

    from surveyapp.core.plan import plan_stations
    from surveyapp_models.angles import ARCSEC

    project = opened(project)
    names = [item.name for item in project.stations]
    if station is not None:
        require(station, names, "station")
        names = [station]
    elif project.sessions:
        names = list(dict.fromkeys(item.station for item in project.sessions))
    if not math.isfinite(interval_arcsec) or interval_arcsec <= 0.0:
        found = f"{interval_arcsec:g}"
        raise SurveyError(
            Problem("the wanted interval is not positive", "--interval", found, "arc-seconds > 0")
        )
    return plan_stations(project, names, wanted=interval_arcsec * ARCSEC)


def demo() -> tuple[DemonstratedSample, ...]:
    """Orient the measured samples and compare with what their sources printed."""
    from surveyapp.core.comparison import DemonstratedSample, compare_with_print
    from surveyapp.io.locations import read_expected, sample_names, samples_folder

    samples = []
    for name in sample_names():
        folder = samples_folder() / name
        project = open_project(folder)
        expected = read_expected(folder)
        estimators = {str(entry.get("estimator")) for entry in expected.get("sessions", [])}
        default = orient(project)
        result = orient(project, estimator=estimators.pop()) if estimators else default
        samples.append(
            DemonstratedSample(
                name=name,
                folder=str(folder),
                source=str(expected.get("source", "")),
                result=result,
                default=default,
                comparisons=compare_with_print(expected, result),
            )
        )
    return tuple(samples)
