"""Traverses and networks for scripts, re-exported by ``surveyapp.api``."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from surveyapp.api.orientation import Source, oriented
from surveyapp.domain.adjustment import AdjustmentResult
from surveyapp.domain.project import Project
from surveyapp.domain.records import Listing
from surveyapp.domain.traverse import Network
from surveyapp.errors import Problem, SurveyError

if TYPE_CHECKING:
    from surveyapp.core.network.bowditch import CompassResult
    from surveyapp.core.network.snooping import SnoopingResult
    from surveyapp.core.network.variance_components import VarianceComponent


def adjust(
    source: Source, *, traverse: str | None = None, family_level: float = 0.05
) -> AdjustmentResult:
    """Adjust the traverses of a project, gyro sides included, or a GNU Gama file.

    Parameters
    ----------
    source : Project, path or Computed
        A project, its folder, what ``compute`` made of it, or a ``.gkf`` file.
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
    from numpy.linalg import LinAlgError

    from surveyapp.core.network import adjust as adjusted
    from surveyapp.core.network.gaussnewton import UnsettledError
    from surveyapp.core.network.removals import unsettled, with_removals

    try:
        return with_removals(network, adjusted(network, family_level=family_level))
    except UnsettledError as error:
        raise unsettled(network, error) from None
    except (LinAlgError, OverflowError, FloatingPointError, ZeroDivisionError) as error:
        raise SurveyError(
            Problem(
                "the network cannot be computed",
                "adjust",
                str(error),
                "coordinates, distances and sigmas of one survey",
                "Is a number in another unit, or a standard deviation far too small or large?",
            )
        ) from None


def compass_rule(network: Network) -> Listing[CompassResult]:
    """Every route of a network by the compass (Bowditch) rule, for those who must file it."""
    from surveyapp.core.network.bowditch import compass_adjust

    return Listing("surveyapp.compass_rule/1", "compass_rule", compass_adjust(network))


def variance_components(network: Network) -> Listing[VarianceComponent]:
    """Factors of the stated sigmas of each group of observations (Helmert)."""
    from surveyapp.core.network.variance_components import variance_components as components

    found = components(network)[0]
    return Listing("surveyapp.variance_components/1", "variance_components", found)


def data_snooping(network: Network) -> SnoopingResult:
    """Gross errors taken out one after another, and the adjustment without them."""
    from surveyapp.core.network.snooping import data_snooping as snooping

    return snooping(network)


def network(source: Source, *, traverse: str | None = None) -> Network:
    """Network of a project's traverses or of a ``.gkf`` file, as ``adjust`` takes it."""
    from surveyapp.core.checks.grid_checks import refuse_unfit_grid
    from surveyapp.io.importers.gkf import read_gkf

    if not isinstance(source, Project | str | PathLike):
        return source.network(traverse)
    if not isinstance(source, Project):
        path = Path(source)
        if path.suffix.lower() in (".gkf", ".xml") or path.is_file():
            return read_gkf(path)
    found = oriented(source, even_unfinished=True, judged=False)
    if found.orientation.sessions:
        refuse_unfit_grid(found.orientation.project)
    return found.network(traverse)
