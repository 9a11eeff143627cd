"""Orientation for scripts, re-exported by ``surveyapp.api``: plan it, reduce it, demonstrate it."""

from __future__ import annotations

from os import PathLike
from typing import TYPE_CHECKING, Union

from surveyapp.api.project import SOFTWARE, Folder, open_project, opened, require
from surveyapp.domain.advance import Advance, silent
from surveyapp.domain.project import Project
from surveyapp.domain.records import Listing
from surveyapp.domain.results import OrientationResult
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import joined, said

if TYPE_CHECKING:
    import numpy as np

    from surveyapp.core.comparison import DemonstratedSample
    from surveyapp.core.plan import StationPlan
    from surveyapp.workflows.computing import Computed, OrientedProject

Source = Union[Project, Folder, "Computed"]
"""What functions take: a project, its folder, or what ``compute`` made of it."""


def compute(
    source: Source,
    *,
    session: str | None = None,
    estimator: str | None = None,
    even_unfinished: bool = False,
    advance: Advance = silent,
) -> Computed:
    """Orient and judge a project, once: every other function takes what this returns.

    Parameters
    ----------
    source : Project, path or Computed
        What has been computed is returned as it is, unless a session or an estimator is asked for.
    session : str or None
        Show this session alone, and orient its lines from it alone; constants come from all
        calibration sessions.
    estimator : str or None
        ``least-squares``, ``schuler``, ``amplitude`` or ``transit``; None for the default.
    even_unfinished : bool
        Whether a project may have no finished session at all; it has no line then.
    advance : callable
        Told how far it is: what is done, how many, of how many.

    Raises
    ------
    SurveyError
        If the project cannot be used, there is no such session, or no session is finished.
    """
    from surveyapp.workflows.computing import judged

    if session is None and estimator is None and not isinstance(source, Project | str | PathLike):
        return source
    found = oriented(
        source,
        session=session,
        estimator=estimator,
        even_unfinished=even_unfinished,
        advance=advance,
    )
    advance("checks", 0, 0)
    return judged(found, software=SOFTWARE, session=session)


def generator_of(project: Project) -> np.random.Generator:
    """Random generator whose seed is the digest of the input: the same input, the same result."""
    from surveyapp.workflows.computing import generator_of as seeded

    return seeded(project)


def unfinished(source: Source) -> Listing[ResultWarning]:
    """What is left out of a project's results because it is still being observed."""
    from surveyapp.core.orientation.unfinished import without_unfinished

    project = opened(source)
    told = without_unfinished(project).warnings[len(project.warnings) :]
    return Listing("surveyapp.unfinished/1", "warnings", told)


def oriented(
    source: Source,
    *,
    session: str | None = None,
    estimator: str | None = None,
    keep: tuple[str, ...] = (),
    even_unfinished: bool = False,
    judged: bool = True,
    advance: Advance = silent,
) -> OrientedProject:
    """Orient a project without judging it yet.

    Parameters
    ----------
    keep : tuple of str
        Sessions that stay although they are not finished.
    even_unfinished : bool
        Whether a project may have no finished session at all; it has no line then.
    judged : bool
        Whether it will be judged.
    """
    from surveyapp.workflows.computing import oriented as oriented_project

    if not isinstance(source, Project | str | PathLike) and session is None and estimator is None:
        return source.oriented
    project = opened(source)
    if session is not None:
        require(session, [item.id for item in project.sessions], "session")
        keep = (*keep, session)
    return oriented_project(
        project,
        estimator=estimator,
        session=session,
        keep=keep,
        all_if_none=not even_unfinished,
        judged=judged,
        advance=advance,
    )


def orient(
    source: Source,
    *,
    session: str | None = None,
    line: str | tuple[str, str] | None = None,
    estimator: str | None = None,
    advance: Advance = silent,
) -> OrientationResult:
    """Reduce the sessions of a project and orient its lines.

    Parameters
    ----------
    source : Project, path or Computed
    session : str or None
        Show this session alone, and orient its lines from it alone; constants come from all
        calibration sessions.
    line : str, (str, str) or None
        Show this line alone, as every instrument oriented it: ``station-target``, or the two names.
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
    found = compute(source, session=session, estimator=estimator, advance=advance)
    return found.result if line is None else with_line(found, line)


def with_line(found: Computed, line: str | tuple[str, str]) -> OrientationResult:
    """The result with one line alone, as every instrument oriented it.

    Raises
    ------
    SurveyError
        If there is no such line, its name is ambiguous, or no azimuth of it can be determined.
    """
    from dataclasses import replace

    from surveyapp.core.orientation.line_names import resolve_line
    from surveyapp.domain.station_line import StationLine

    result = found.result
    stations = [item.name for item in found.project.stations]
    told = [item.text for item in result.warnings if item.code == "session_unfinished"]
    found_line = resolve_line(line, stations, result.lines, more=joined("; ", told))
    own = tuple(x for x in result.lines if StationLine(x.station, x.target) == found_line)
    if all(item.true_azimuth is None for item in own):
        raise SurveyError(
            Problem(
                what=said(
                    "the azimuth of line {found_line} cannot be determined", found_line=found_line
                ),
                where=", ".join(f"instrument {item.instrument}" for item in own),
                found="no instrument constant",
                expected="calibration sessions on a known line, or a known constant",
                hint="Add a calibration session, or constant = { arcsec, sigma_arcsec }.",
            )
        )
    ends = {found_line.station, found_line.target}
    sides = tuple(x for x in result.combined if {x.station, x.target} == ends)
    return replace(result, lines=own, combined=sides)


def plan(
    project: Project | Folder, *, station: str | None = None, interval_arcsec: float = 20.0
) -> Listing[StationPlan]:
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
            Problem(
                "the wanted interval is not positive", "interval_arcsec", found, "arc-seconds > 0"
            )
        )
    plans = plan_stations(project, names, wanted=interval_arcsec * ARCSEC)
    return Listing("surveyapp.plan/1", "plans", plans)


def demo() -> Listing[DemonstratedSample]:
    """Orient the measured samples and compare with what their sources printed."""
    from surveyapp.core.comparison import DemonstratedSample, compare_with_print
    from surveyapp.io.locations import read_expected, sample_names, samples_folder

    samples = []
    for name in sample_names():
        folder = samples_folder() / name
        expected = read_expected(folder)
        if not expected:
            continue  # a synthetic sample: nobody printed anything of it
        project = open_project(folder)
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
    return Listing("surveyapp.demo/1", "samples", tuple(samples))
