"""What scripts call: the same functions as the command line, on values instead of text.

Every function returns a frozen dataclass with ``to_dict()``, the JSON of the command of its name.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from surveyapp import __version__
from surveyapp.api_batch import batch as batch
from surveyapp.api_batch import batch_rows as batch_rows
from surveyapp.api_office import blank_form as blank_form
from surveyapp.api_office import close as close
from surveyapp.api_office import compare as compare
from surveyapp.api_office import export_csv as export_csv
from surveyapp.api_office import export_gkf as export_gkf
from surveyapp.api_office import export_json as export_json
from surveyapp.api_office import export_zip as export_zip
from surveyapp.api_office import reopen as reopen
from surveyapp.api_office import report as report
from surveyapp.api_office import report_text as report_text
from surveyapp.api_unfinished import unfinished as unfinished
from surveyapp.api_unfinished import without_unfinished as without_unfinished
from surveyapp.domain.adjustment import AdjustmentResult
from surveyapp.domain.instrument import InstrumentCard
from surveyapp.domain.project import Project
from surveyapp.domain.results import Check, OrientationResult
from surveyapp.domain.traverse import Network
from surveyapp.errors import Problem, SurveyError, nearest_names

if TYPE_CHECKING:
    import numpy as np

    from surveyapp.core.comparison import DemonstratedSample
    from surveyapp.core.network.bowditch import CompassResult
    from surveyapp.core.network.variance_components import VarianceComponent
    from surveyapp.core.orientation import Orientation
    from surveyapp.core.plan import StationPlan
    from surveyapp.io.simulated import SimulatedFiles
    from surveyapp.workflows.diagnosing import Diagnosed

Folder = str | os.PathLike[str]

SubjectKeyword = Literal["session", "campaign", "traverse"]

SOFTWARE = f"surveyapp {__version__}"


def open_project(folder: Folder) -> Project:
    """Read a project folder.

    Raises
    ------
    SurveyError
        With all problems of project.toml and of every book together.
    """
    from surveyapp.io.project import read_project

    return read_project(Path(folder))


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
    if not isinstance(project, Project):
        project = open_project(project)
    if session is not None:
        _require(session, [item.id for item in project.sessions], "session")
    kept = without_unfinished(project, keep=() if session is None else (session,))
    if not kept.sessions:
        kept = project
    return _oriented(kept, session=session, line=line, estimator=estimator)


def _oriented(
    project: Project,
    *,
    session: str | None = None,
    line: str | None = None,
    estimator: str | None = None,
) -> OrientationResult:
    """Orient every session of a project; it may have none."""
    from dataclasses import replace

    from surveyapp.core.outcome import outcome
    from surveyapp.io.project_checks import project_checks

    computed = _computed(project, estimator=estimator, only=session)
    checks = project_checks(project, computed)
    result = outcome(computed, software=SOFTWARE, only=session, more_checks=checks)
    if line is not None:
        names = {f"{item.station}-{item.target}": item for item in result.lines}
        told = [item.text for item in project.warnings if item.code == "session_unfinished"]
        _require(line, names, "line", "; ".join(told))
        if names[line].true_azimuth is None:
            raise SurveyError(
                Problem(
                    what=f"the azimuth of line {line} cannot be determined",
                    where=f"instrument {names[line].instrument}",
                    found="no instrument constant",
                    expected="calibration sessions on a known line, or a known constant",
                    hint="Add a calibration session, or constant = { arcsec, sigma_arcsec }.",
                )
            )
        result = replace(result, lines=(names[line],))
    return result


def _require(name: str, known: Iterable[str], kind: str, more: str = "") -> None:
    names = list(known)
    if name not in names:
        raise SurveyError(
            Problem(
                what=f"there is no {kind} of this name",
                where=f"--{kind}",
                found=name,
                expected=f"the name of a {kind} of the project",
                hint=". ".join(filter(None, [nearest_names(name, names), more])),
            )
        )


def check(project: Project | Folder) -> tuple[Check, ...]:
    """Apply every limit and test that the project's data can answer.

    Raises
    ------
    SurveyError
        If the project cannot be used; what was changed after its closing is among the problems.
    """
    from surveyapp.io.project_checks import changed_after_closing

    try:
        if not isinstance(project, Project):
            project = open_project(project)
        if project.tables.get("traverse"):
            return _with_traverses(project, _oriented(without_unfinished(project)).checks)
        return orient(project).checks
    except SurveyError as error:
        folder = project.path if isinstance(project, Project) else project
        raise SurveyError([*changed_after_closing(Path(folder)), *error.problems]) from None


def _with_traverses(project: Project, checks: tuple[Check, ...]) -> tuple[Check, ...]:
    """Checks of the orientation with those of the traverses."""
    from surveyapp.io.traverse_checks import traverse_checks
    from surveyapp.io.traverseheader import traverse_headers

    networks = [
        (header.traverse_class, network(project, traverse=header.name))
        for header in traverse_headers(project)
    ]
    return traverse_checks(project, networks, checks)


def adjust(
    source: Project | Folder, *, traverse: str | None = None, family_level: float = 0.05
) -> AdjustmentResult:
    """Adjust the traverses of a project, gyro sides included, or a GNU Gama file.

    Parameters
    ----------
    source : Project or path
        A project, its folder, or a ``.gkf`` file.
    traverse : str or None
        One traverse; all of them together without it.
    family_level : float
        Level of data snooping for all observations together.

    Raises
    ------
    SurveyError
        If something cannot be read, has no datum, is not determined or does not converge.
    """
    return adjust_network(network(source, traverse=traverse), family_level=family_level)


def adjust_network(network: Network, *, family_level: float = 0.05) -> AdjustmentResult:
    """Adjust a network as ``network`` returns it; see ``adjust``."""
    from surveyapp.core.network import adjust as adjusted

    return adjusted(network, family_level=family_level)


def compass_rule(network: Network) -> tuple[CompassResult, ...]:
    """Every route of a network by the compass (Bowditch) rule, for those who must file it."""
    from surveyapp.core.network.bowditch import compass_adjust

    return compass_adjust(network)


def variance_components(network: Network) -> tuple[VarianceComponent, ...]:
    """Factors of the stated sigmas of each group of observations (Helmert)."""
    from surveyapp.core.network.variance_components import variance_components as components

    return components(network)[0]


def network(source: Project | Folder, *, traverse: str | None = None) -> Network:
    """Network of a project's traverses or of a ``.gkf`` file, as ``adjust`` takes it."""
    from dataclasses import replace

    from surveyapp.core.network.oriented import oriented_lines
    from surveyapp.core.unfinished import waiting_sides
    from surveyapp.io.importers.gkf import read_gkf
    from surveyapp.io.traversebook import network_of

    if not isinstance(source, Project):
        path = Path(source)
        if path.suffix.lower() in (".gkf", ".xml") or path.is_file():
            return read_gkf(path)
        source = open_project(path)
    kept = without_unfinished(source)
    left_out = kept.warnings[len(source.warnings) :]
    lines, constants, warnings = oriented_lines(_oriented(kept).lines if kept.sessions else ())
    found = network_of(source, traverse, lines, constants, waiting_sides(source, kept))
    return replace(found, warnings=(*found.warnings, *warnings, *left_out))


def models() -> tuple[InstrumentCard, ...]:
    """Every installed instrument card."""
    from surveyapp.io.cards import installed_card_ids

    return tuple(model(identity) for identity in installed_card_ids())


def model(identity: str) -> InstrumentCard:
    """One instrument card by id, or by the path of a file.

    Raises
    ------
    SurveyError
        If there is none; the nearest id is named.
    """
    from surveyapp.io.cards import read_card

    return read_card(identity, base=Path(), override={})


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


def new_project(
    folder: Folder, *, name: str | None = None, crs: str | None = None, angle_unit: str = "dms"
) -> Path:
    """Make a new project folder with a commented project.toml.

    Raises
    ------
    SurveyError
        If the folder holds anything already, or if the crs is no projected grid.
    """
    from surveyapp.core.geodesy import open_grid
    from surveyapp.io.template import create_project
    from surveyapp_models.angles import AngleUnit

    path = Path(folder)
    if crs is not None:
        open_grid(crs)
    title = name if name is not None else path.resolve().name
    create_project(path, name=title, crs=crs, angle_unit=AngleUnit(angle_unit))
    return path


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

    if not isinstance(project, Project):
        project = open_project(project)
    names = [item.name for item in project.stations]
    if station is not None:
        _require(station, names, "station")
        names = [station]
    elif project.sessions:
        names = list(dict.fromkeys(item.station for item in project.sessions))
    if not math.isfinite(interval_arcsec) or interval_arcsec <= 0.0:
        found = f"{interval_arcsec:g}"
        raise SurveyError(
            Problem("the wanted interval is not positive", "--interval", found, "arc-seconds > 0")
        )
    return plan_stations(project, names, wanted=interval_arcsec * ARCSEC)


def simulate(
    kind: str, out: Folder, *, effects: Sequence[str] = (), seed: int = 1
) -> SimulatedFiles:
    """Write a simulated project, and its truth beside it.

    Parameters
    ----------
    kind : str
        ``reversal-run`` or ``campaign``.
    out : path
        A folder that does not exist or is empty.
    effects : sequence of str
        ``ID=VALUE[,option=value]`` each.
    seed : int
        The same seed, the same files.

    Raises
    ------
    SurveyError
        For an unknown kind or effect, or a folder that cannot be used.
    """
    from surveyapp.core.simulate.kinds import simulate_kind
    from surveyapp.io.simulated import write_simulated

    if seed < 0:
        raise SurveyError(Problem("the seed is negative", "--seed", str(seed), "0 or more"))
    files, truth = simulate_kind(kind, effects=effects, seed=seed)
    return write_simulated(Path(out), files, truth)


def diagnose(
    project: Project | Folder,
    *,
    session: str | None = None,
    campaign: str | None = None,
    traverse: str | None = None,
    confirm: str | None = None,
    effects: Folder | None = None,
    adopt: bool = False,
    log: bool = True,
) -> Diagnosed:
    """Find which effect the model lacks, how sure that is, and prove it.

    Parameters
    ----------
    project : Project or path
    session : str or None
        Diagnose the turning points of this session.
    campaign : str or None
        Diagnose the determinations of this instrument.
    traverse : str or None
        Diagnose the conditions of this traverse.
    confirm : str or None
        A second session or traverse that chose nothing; for a campaign the session from which on
        the determinations only confirm.
    effects : path or None
        A Python file with a tuple ``EFFECTS`` of the user's own effects.
    adopt : bool
        Write the effects that the engine names into the project; the next ``orient`` uses them.
    log : bool
        Append the diagnosis to the project's ledger where it can be written.

    Raises
    ------
    SurveyError
        For an unknown subject, too few observations, or a project that cannot be written.
    """
    from surveyapp.io.effects import load_effects
    from surveyapp.workflows.choosing import Request
    from surveyapp.workflows.diagnosing import diagnose_project

    if not isinstance(project, Project):
        project = open_project(project)
    own = () if effects is None else load_effects(Path(effects))
    kept = without_unfinished(project, keep=[name for name in (session, confirm) if name])
    return diagnose_project(
        _computed(kept if kept.sessions else project),
        Request(session, campaign, confirm, own, traverse),
        folder=Path(project.path) if project.path else None,
        adopt=adopt,
        software=SOFTWARE,
        log=log,
        networks=lambda name: network(project, traverse=name),
    )


def subjects(project: Project | Folder) -> tuple[tuple[SubjectKeyword, str], ...]:
    """What ``diagnose`` can take of a project: its keyword and the id."""
    from surveyapp.workflows.choosing import subjects_of

    if not isinstance(project, Project):
        project = open_project(project)
    keywords: dict[str, SubjectKeyword] = {
        "--session": "session",
        "--campaign": "campaign",
        "--traverse": "traverse",
    }
    kept = without_unfinished(project)
    return tuple((keywords[item.option], item.id) for item in subjects_of(kept))


def _computed(
    project: Project, *, estimator: str | None = None, only: str | None = None
) -> Orientation:
    """Orient a project; runs with adopted effects are estimated with them in the model."""
    from surveyapp.core.orientation import orient_project

    run_model = None
    if any(session.effects for session in project.sessions):
        from surveyapp.diagnosis.subjects import modelled_run

        run_model = modelled_run
    return orient_project(
        project, generator_of(project), estimator=estimator, only=only, run_model=run_model
    )
