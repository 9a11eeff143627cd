"""Changing a project file without losing a word of its owner.

New tables go to the end as text, values are edited in place. Before anything replaces the file the
new text is parsed: its data must be the intention exactly, and every comment must still be there.
Writing is to a temporary file in the same folder, fsync, replace, fsync of the folder.
"""

from __future__ import annotations

import copy
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

from surveyapp.errors import Problem, SurveyError
from surveyapp.io.files import read_text, shown
from surveyapp.io.tables import parse_toml
from surveyapp.io.template import create_project
from surveyapp.io.tomltext import atomic_write, comments, plain, present, toml_key, toml_value
from surveyapp.languages import said

__all__ = [
    "append_subtable",
    "append_below",
    "append_subtables",
    "append_table",
    "append_tables",
    "atomic_write",
    "comments",
    "create_project",
    "set_value",
    "set_values",
    "toml_value",
]

Key = str | int
_REFUSED_HINT: Final = "the file was left as it is; make this change with a text editor"


def _table_text(header: str, mapping: Mapping[str, object]) -> str:
    lines = [header]
    lines += [f"{toml_key(key)} = {toml_value(item)}" for key, item in present(mapping).items()]
    return "\n".join(lines) + "\n"


def append_table(project_toml: Path, table_name: str, mapping: Mapping[str, object]) -> None:
    """Append ``[[table_name]]`` as text at the end of project.toml.

    Parameters
    ----------
    project_toml : Path
    table_name : str
        station, instrument, orientation, traverse, shaft, sensor_log ...
    mapping : mapping
        Its keys; None is left out.

    Raises
    ------
    SurveyError
        If the result would not parse to the intention; the file is untouched then.
    """
    append_tables(project_toml, [(table_name, mapping)])


def append_tables(project_toml: Path, tables: Sequence[tuple[str, Mapping[str, object]]]) -> None:
    """Append several tables, each as ``append_table`` does, in one writing.

    Parameters
    ----------
    project_toml : Path
    tables : sequence of (str, mapping)
        Kind and keys of each; none changes nothing.

    Raises
    ------
    SurveyError
        If the result would not parse to the intention; the file is untouched then.
    """
    if not tables:
        return
    text, data = _read(project_toml)
    expected = copy.deepcopy(data)
    added = []
    for name, mapping in tables:
        found = expected.setdefault(name, [])
        if not isinstance(found, list):
            raise _refused(project_toml, said("{name} is no list of tables", name=name))
        found.append(plain(mapping))
        added.append(_table_text(f"[[{toml_key(name)}]]", mapping))
    gap = "" if not text else "\n" if text.endswith("\n") else "\n\n"
    _write_checked(project_toml, text, text + gap + "\n".join(added), expected)


def append_below(project_toml: Path, parent: str, name: str, mapping: Mapping[str, object]) -> None:
    """Append ``[[parent.name]]`` of a single ``[parent]`` as text at the end of project.toml.

    Raises
    ------
    SurveyError
        If there is no such table, or if the result would not parse to the intention.
    """
    text, data = _read(project_toml)
    expected = copy.deepcopy(data)
    holder = expected.get(parent)
    if not isinstance(holder, dict):
        raise _refused(project_toml, said("there is no [{parent}]", parent=parent))
    found = holder.setdefault(name, [])
    if not isinstance(found, list):
        raise _refused(
            project_toml, said("{parent}.{name} is no list of tables", parent=parent, name=name)
        )
    found.append(plain(mapping))
    added = _table_text(f"[[{toml_key(parent)}.{toml_key(name)}]]", mapping)
    gap = "\n" if text.endswith("\n") else "\n\n"
    _write_checked(project_toml, text, text + gap + added, expected)


def append_subtable(
    project_toml: Path, parent: tuple[str, str], name: str, mapping: Mapping[str, object]
) -> None:
    """Append ``[[parent.name]]`` to one table of a list, as text behind that table.

    Parameters
    ----------
    project_toml : Path
    parent : tuple of str
        Kind and id (or name) of the table, such as ``("orientation", "ramp3-r1")``.
    name : str
        ``effect``.
    mapping : mapping
        Its keys; None is left out.

    Raises
    ------
    SurveyError
        If there is no such table, or if the result would not parse to the intention.
    """
    append_subtables(project_toml, parent, name, [mapping])


def append_subtables(
    project_toml: Path,
    parent: tuple[str, str],
    name: str,
    mappings: Sequence[Mapping[str, object]],
) -> None:
    """Append several ``[[parent.name]]`` in one writing, all or none; as ``append_subtable``."""
    atomic_write(project_toml, with_subtables(project_toml, parent, name, mappings))


def with_subtables(
    project_toml: Path,
    parent: tuple[str, str],
    name: str,
    mappings: Sequence[Mapping[str, object]],
) -> bytes:
    """What project.toml will be with several ``[[parent.name]]`` more.

    Raises
    ------
    SurveyError
        As ``append_subtable``.
    """
    kind, identity = parent
    text, data = _read(project_toml)
    expected = copy.deepcopy(data)
    index, table = _element(project_toml, expected.get(kind), identity)
    if not isinstance(table, dict) or not isinstance(table.setdefault(name, []), list):
        raise _refused(
            project_toml,
            said("{name} of {identity} is no list of tables", name=name, identity=identity),
        )
    table[name] += [plain(mapping) for mapping in mappings]
    headers = list(
        re.finditer(rf"^[ \t]*\[\[[ \t]*{re.escape(kind)}[ \t]*\]\]", text, re.MULTILINE)
    )
    if index >= len(headers):
        raise _refused(
            project_toml, said("the header of {identity} was not found", identity=identity)
        )
    place = _end_of_table(text, headers[index].end(), kind)
    header = f"[[{toml_key(kind)}.{toml_key(name)}]]"
    added = "\n".join(_table_text(header, mapping) for mapping in mappings)
    before = text[:place].rstrip("\n")
    after = text[place:]
    new = f"{before}\n\n{added}" + (f"\n{after}" if after else "")
    _check(project_toml, text, new, expected)
    return new.encode("utf-8")


def _end_of_table(text: str, start: int, kind: str) -> int:
    """Where the next table begins that is not part of this one; its comment goes with it."""
    header = re.compile(r"^[ \t]*\[\[?[ \t]*([^\]\n]+?)[ \t]*\]", re.MULTILINE)
    for match in header.finditer(text, start):
        if not match[1].startswith(f"{kind}."):
            lines = text[: match.start()].split("\n")
            while len(lines) > 1 and lines[-2].lstrip().startswith("#"):
                del lines[-2]
            return len("\n".join(lines))
    return len(text)


def set_value(project_toml: Path, path: Sequence[Key], value: object) -> None:
    """Set one value in place; None removes it.

    Parameters
    ----------
    project_toml : Path
    path : sequence of str or int
        Keys from the top; in a list of tables the id, the name or the index of one:
        ``("orientation", "ramp3-r1", "target")``.
    value : object
        Text, number, date, list or mapping.

    Raises
    ------
    SurveyError
        If the place does not exist, or if data or comments would not survive; the file is
        untouched then.
    """
    set_values(project_toml, [(path, value)])


def set_values(project_toml: Path, changes: Sequence[tuple[Sequence[Key], object]]) -> None:
    """Set several values in place in one writing, each as ``set_value`` does; all or none."""
    import tomlkit
    from tomlkit.exceptions import TOMLKitError

    text, data = _read(project_toml)
    expected = copy.deepcopy(data)
    try:
        document = tomlkit.parse(text)
        for path, value in changes:
            for root in (expected, document):
                holder: object = root
                for key in path[:-1]:
                    holder = _step(project_toml, holder, key)
                new_value = _inline(value) if root is document else value
                _assign(project_toml, holder, path[-1], new_value)
        new = tomlkit.dumps(document)
    except (TOMLKitError, ValueError, TypeError) as error:
        raise _refused(project_toml, shown(str(error))) from None
    _write_checked(project_toml, text, new, expected)


def _inline(value: object) -> object:
    """A mapping as ``{ key = value }``, as surveyors write it."""
    import tomlkit

    if not isinstance(value, Mapping):
        return value
    table = tomlkit.inline_table()
    table.update(present(value))
    return table


def _step(path: Path, holder: object, key: Key) -> object:
    if isinstance(holder, list):
        return _element(path, holder, key)[1]
    if isinstance(holder, Mapping) and isinstance(key, str) and key in holder:
        return holder[key]
    raise _refused(path, said("there is no {key}", key=key))


def _element(path: Path, tables: object, key: Key) -> tuple[int, object]:
    for index, table in enumerate(tables if isinstance(tables, list) else ()):
        if index == key or (
            isinstance(table, Mapping) and key in (table.get("id"), table.get("name"))
        ):
            return index, table
    raise _refused(path, said("there is no table {key}", key=key))


def _assign(path: Path, holder: object, key: Key, value: object) -> None:
    if not isinstance(holder, dict) or not isinstance(key, str):
        raise _refused(path, said("{key} cannot be set here", key=key))
    if value is None:
        holder.pop(key, None)
    else:
        toml_value(value)
        holder[key] = value if hasattr(value, "as_string") else plain(value)


def _read(path: Path) -> tuple[str, dict[str, object]]:
    text = read_text(path, where=path.name)
    return text, parse_toml(text, where=path.name)


def _write_checked(path: Path, old: str, new: str, expected: Mapping[str, object]) -> None:
    """Write the new text if it says what was meant and still says what its owner wrote."""
    _check(path, old, new, expected)
    atomic_write(path, new.encode("utf-8"))


def _check(path: Path, old: str, new: str, expected: Mapping[str, object]) -> None:
    if parse_toml(new, where=path.name) != expected:
        raise _refused(path, "the new text does not hold the intended data")
    lost = Counter(comments(old)) - Counter(comments(new))
    if lost:
        raise _refused(
            path, said("a comment would be lost: {value}", value=shown(next(iter(lost))))
        )


def _refused(path: Path, why: str) -> SurveyError:
    return SurveyError(Problem("the change was refused", path.name, why, "", _REFUSED_HINT))
