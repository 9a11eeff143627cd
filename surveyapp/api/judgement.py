"""Limits, tests and causes for scripts, re-exported by ``surveyapp.api``: check and diagnose."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from surveyapp.api.orientation import Source, oriented
from surveyapp.api.project import SOFTWARE, Folder, opened
from surveyapp.domain.advance import Advance, silent
from surveyapp.domain.project import Project
from surveyapp.domain.records import Listing
from surveyapp.domain.results import Check, Verdicts

if TYPE_CHECKING:
    from surveyapp.workflows.choosing import Diagnosable
    from surveyapp.workflows.diagnosing import Diagnosed


def check(
    source: Source,
    *,
    seal: str | None = None,
    key: Folder | None = None,
    signed: tuple[Folder, ...] = (),
    advance: Advance = silent,
) -> Verdicts:
    """Apply every limit and test that the project's data can answer.

    The same verdicts and warnings stand in the result of ``orient``, on the screens and in the
    record.

    Parameters
    ----------
    source : Project, path or Computed
    seal : str or None
        A head that a signed record prints: one check more tells whether the ledger holds it and
        what was sealed then is as it was.
    key : path or None
        Public key in the format of minisign: one check more for every closing in force, and for
        every file of ``signed``, tells whether it is signed by this key.
    signed : tuple of paths
        Files with a signature beside them, such as the record.

    Raises
    ------
    SurveyError
        If the project cannot be used; what was changed after its closing is among the problems.
    """
    from surveyapp.workflows.computing import judged
    from surveyapp.workflows.record_on_disk import record_warnings

    if not isinstance(source, Project | str | PathLike):
        found = source
    else:
        project = opened(source)
        made = oriented(project, even_unfinished=bool(project.traverses), advance=advance)
        found = judged(made, software=SOFTWARE)
    told = (*found.result.warnings, *record_warnings(found.project))
    checks = found.result.checks
    if seal is not None:
        from surveyapp.core.checks.filing_checks import seal_check
        from surveyapp.io.filing.seals import sealed_by

        folder = Path(found.project.path)
        checks = (*checks, seal_check(*sealed_by(folder, seal)))
    if key is not None:
        checks = (*checks, *_signature_checks(Path(found.project.path), key, signed))
    return Verdicts(checks, told)


def _signature_checks(folder: Path, key: Folder, signed: tuple[Folder, ...]) -> tuple[Check, ...]:
    from surveyapp.core.checks.filing_checks import signature_check
    from surveyapp.io.filing.signatures import closing_faults, file_faults
    from surveyapp.io.minisign import read_public_key

    public = read_public_key(Path(key))
    closings = [
        signature_check("closing.signature", name or "project", found, public.id)
        for name, found in closing_faults(folder, public).items()
    ]
    files = [
        signature_check("record.signature", Path(p).name, file_faults(Path(p), public), public.id)
        for p in signed
    ]
    return (*closings, *files)


def diagnose(
    source: Source,
    *,
    session: str | None = None,
    campaign: str | None = None,
    traverse: str | None = None,
    confirm: str | None = None,
    effects: Folder | None = None,
    adopt: bool = False,
    log: bool = True,
    save_shape: Folder | None = None,
) -> Diagnosed:
    """Find which effect the model lacks, how sure that is, and prove it.

    Parameters
    ----------
    source : Project, path or Computed
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
    save_shape : path or None
        Write a course of north that has no name into this file, as an effect for ``effects``.

    Raises
    ------
    SurveyError
        For an unknown subject, too few observations, or a project that cannot be written.
    """
    from surveyapp.io.user_effects.loading import load_effects
    from surveyapp.workflows.choosing import Request
    from surveyapp.workflows.diagnosing import diagnose_project

    own = () if effects is None else load_effects(Path(effects), only_known_columns=True)
    keep = tuple(name for name in (session, confirm) if name)
    if isinstance(source, Project | str | PathLike):
        found = oriented(source, keep=keep, judged=False)
    else:
        found = source.oriented
    return diagnose_project(
        found.orientation,
        Request(session, campaign, confirm, own, traverse),
        folder=Path(found.project.path) if found.project.path else None,
        adopt=adopt,
        software=SOFTWARE,
        log=log,
        networks=found.network,
        save_shape=None if save_shape is None else Path(save_shape),
    )


def subjects(source: Source) -> Listing[Diagnosable]:
    """What ``diagnose`` can take of a project: its keyword and the id."""
    from surveyapp.core.orientation.unfinished import without_unfinished
    from surveyapp.workflows.choosing import subjects_of

    kept = without_unfinished(opened(source))
    return Listing("surveyapp.subjects/1", "subjects", subjects_of(kept))
