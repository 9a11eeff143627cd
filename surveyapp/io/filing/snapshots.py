"""Snapshots of results: made from a project folder, or read from a file of an earlier export."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from surveyapp.core.differences import Snapshot
from surveyapp.domain.project import Project
from surveyapp.domain.results import OrientationResult
from surveyapp.domain.rulebook import RuleBook
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.files import decode, read_inside, read_text, shown
from surveyapp.io.filing.sealed_files import hash_inside, project_file_names
from surveyapp.languages import either

_SCHEMAS = ("surveyapp.snapshot/1", "surveyapp.orient/1")


def folder_snapshot(
    project: Project, result: OrientationResult, rule_book: RuleBook | None
) -> Snapshot:
    """Snapshot of a project folder: files, effective cards, rule book, result."""
    folder = Path(project.path)
    files, texts = {}, {}
    for name in project_file_names(folder):
        files[name] = hash_inside(folder, name).sha256
        try:
            data = decode(read_inside(folder, name, where=name), where=name)
        except SurveyError:
            continue
        texts[name] = tuple(data.splitlines())
    return Snapshot(
        name=str(folder),
        result=result.to_dict(),
        files=files,
        texts=texts,
        cards={item.id: _plain(asdict(item.card)) for item in project.instruments},
        rule_book={} if rule_book is None else _plain(asdict(rule_book)),
    )


def _plain(value: Any) -> Any:
    """Tuples as lists, so that a snapshot from a file and one from a folder are alike."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    return [_plain(item) for item in value] if isinstance(value, list | tuple) else value


def read_snapshot(path: Path) -> Snapshot:
    """Read a snapshot (``export json``) or the JSON of ``orient``.

    Raises
    ------
    SurveyError
        If the file is neither.
    """
    where = shown(str(path))
    try:
        data = json.loads(read_text(path, where=where))
    except (ValueError, RecursionError):
        raise SurveyError(
            Problem("this is no JSON", where, "", "a project folder, or a JSON file of a result")
        ) from None
    schema = data.get("schema") if isinstance(data, Mapping) else None
    if not isinstance(data, Mapping) or schema not in _SCHEMAS:
        raise SurveyError(
            Problem(
                "this is no result",
                where,
                shown(schema),
                either(_SCHEMAS),
                "surveyapp orient --json and surveyapp export json write such files",
            )
        )
    if schema == _SCHEMAS[1]:
        return Snapshot(str(path), data)
    return Snapshot(
        name=str(path),
        result=_mapping(data.get("result")) or {},
        files=_mapping(data.get("files")),
        cards=_mapping(data.get("cards")),
        rule_book=_mapping(data.get("rule_book")),
    )


def _mapping(value: object) -> dict[str, Any] | None:
    return dict(value) if isinstance(value, Mapping) else None
