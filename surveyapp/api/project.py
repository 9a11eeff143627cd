"""Projects and cards for scripts, re-exported by ``surveyapp.api``: open, make, look up."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from surveyapp import __version__
from surveyapp.domain.filing import MadeProject
from surveyapp.domain.instrument import InstrumentCard
from surveyapp.domain.project import Project
from surveyapp.domain.records import Listing
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.languages import joined, said, term

if TYPE_CHECKING:
    from surveyapp.io.simulated import SimulatedFiles
    from surveyapp.workflows.computing import Computed

Folder = str | os.PathLike[str]

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


def opened(source: Project | Folder | Computed) -> Project:
    """The project itself, read if it is given by its folder."""
    if isinstance(source, Project):
        return source
    return open_project(source) if isinstance(source, str | os.PathLike) else source.project


def require(name: str, known: Iterable[str], kind: str, more: str = "") -> None:
    """Refuse a name that is not among the known ones; ``more`` is added to the hint."""
    names = list(known)
    if name not in names:
        raise SurveyError(
            Problem(
                what=said("there is no {kind} of this name", kind=term(kind)),
                where=kind,
                found=name,
                expected=said("the name of a {kind} of the project", kind=term(kind)),
                hint=joined(". ", filter(None, [nearest_names(name, names), more])),
            )
        )


def new_project(
    folder: Folder,
    *,
    name: str | None = None,
    crs: str | None = None,
    angle_unit: str = "dms",
    mine_grid: str | None = None,
    card: str | None = None,
) -> MadeProject:
    """Make a new project folder with a commented project.toml.

    What it returns is a path as well: ``open_project`` and ``Path`` take it. With a ``card`` it has
    the instrument G1, and ``to_enter`` tells what only its owner knows.

    Raises
    ------
    SurveyError
        If the folder holds anything already, or if the crs is no projected grid, or the mine grid
        (``ROTATION E N BASE_E BASE_N [SIGMA]``, without a crs ``LAT LON``) is none.
    """
    from surveyapp.core.geodesy import open_grid
    from surveyapp.core.observing.owner_values import missing_values
    from surveyapp.io.grid_line import mine_grid_line
    from surveyapp.io.template import create_project
    from surveyapp_models.angles import AngleUnit

    path = Path(folder)
    if crs is not None:
        open_grid(crs)
    title = name if name is not None else path.resolve().name
    unit = AngleUnit(angle_unit)
    line = None if mine_grid is None else mine_grid_line(mine_grid, crs=crs, unit=unit)
    found = None if card is None else _installed(card)
    create_project(path, name=title, crs=crs, angle_unit=unit, grid_line=line, card=card)
    return MadeProject(str(path), () if found is None else missing_values(found))


def simulate(
    kind: str,
    out: Folder,
    *,
    effects: Sequence[str] = (),
    seed: int = 1,
    programme: str | None = None,
    coefficients: Sequence[str] = (),
) -> SimulatedFiles:
    """Write a simulated project, and its truth beside it.

    Parameters
    ----------
    kind : str
        ``reversal-run``, ``campaign``, ``rate``, ``fog-station`` ...
    out : path
        A folder that does not exist or is empty.
    effects : sequence of str
        ``ID=VALUE[,option=value]`` each.
    seed : int
        The same seed, the same files.
    coefficients : sequence of str
        Of noise: ``SYMBOL=VALUE`` each, Q N B K R in the units of IEEE 952.
    programme : str, optional
        Of a rate sensor: ``six-position``, ``temperature`` ...

    Raises
    ------
    SurveyError
        For an unknown kind or effect, or a folder that cannot be used.
    """
    from surveyapp.core.simulate.kinds import simulate_kind
    from surveyapp.io.simulated import write_simulated

    if seed < 0:
        raise SurveyError(Problem("the seed is negative", "seed", str(seed), "0 or more"))
    files, truth = simulate_kind(
        kind, effects=effects, seed=seed, programme=programme, coefficients=coefficients
    )
    return write_simulated(Path(out), files, truth)


def _installed(card: str) -> InstrumentCard:
    """An installed card; one of one's own is copied into the folder that does not exist yet."""
    from surveyapp.io.cards import installed_card_ids

    known = installed_card_ids()
    if card not in known:
        hint = said(
            "{names}; a card of your own is copied in and named there",
            names=nearest_names(card, known),
        )
        raise SurveyError(
            Problem("there is no such instrument card", "card", card, "the id of one", hint)
        )
    return model(card)


def models() -> Listing[InstrumentCard]:
    """Every installed instrument card."""
    from surveyapp.io.cards import installed_card_ids

    cards = tuple(model(identity) for identity in installed_card_ids())
    return Listing("surveyapp.models/1", "models", cards)


def model(identity: str) -> InstrumentCard:
    """One instrument card by id, or by the path of a file.

    Raises
    ------
    SurveyError
        If there is none; the nearest id is named.
    """
    from surveyapp.io.cards import read_card

    return read_card(identity, base=Path(), override={})
