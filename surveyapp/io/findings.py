"""Everything that was found wrong or odd while reading, told once.

What one hand wrote into every table of a kind (a key that nobody knows, a word spelt wrongly) is
one mistake: from the fourth place on it is told with the first place and the number of the others.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Final, TypeVar

from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.io.files import shown
from surveyapp.languages import counted, said

_MOST_UNKNOWN: Final = 200
"""Keys beyond them are of a file of another kind; nobody reads about each."""
_MOST_PLACES: Final = 3
"""Places of one and the same mistake that are told one by one."""

T = TypeVar("T")


@dataclass(slots=True)
class _Unknown:
    """A key that nobody knows, with the names that stand to choice there."""

    key: str
    known: frozenset[str]
    places: list[str] = field(default_factory=list)


@dataclass(slots=True)
class Findings:
    """Problems, warnings and unknown keys of one reading.

    Parameters
    ----------
    problems : list of Problem
    warnings : list of ResultWarning
        What was found so far besides unknown keys; ``told`` gives all of them.
    """

    problems: list[Problem] = field(default_factory=list)
    warnings: list[ResultWarning] = field(default_factory=list)
    _unknown: dict[tuple[str, frozenset[str]], _Unknown] = field(default_factory=dict)
    _further: str = ""
    """Where the first of the unknown keys stood that are not told one by one."""

    def absorb(self, error: SurveyError) -> None:
        """Take over the problems of an error."""
        self.problems.extend(error.problems)

    def raise_if_any(self) -> None:
        """Raise one error with all problems, if there are any."""
        if self.problems:
            raise SurveyError(told_once(self.problems))

    def unknown_key(self, key: str, *, where: str, known: Iterable[str]) -> None:
        """Note a key that nobody has asked for: it is a warning, and names the nearest.

        Parameters
        ----------
        key : str
        where : str
            The table that holds it.
        known : iterable of str
            What may stand there.
        """
        names = frozenset(known)
        entry = self._unknown.get((key, names))
        if entry is None:
            if len(self._unknown) == _MOST_UNKNOWN:
                self._further = self._further or where
                return
            entry = self._unknown[key, names] = _Unknown(key, names)
        entry.places.append(where)

    def told(self) -> tuple[ResultWarning, ...]:
        """Every warning once, unknown keys first."""
        found = [text for entry in self._unknown.values() for text in _texts(entry)]
        if self._further:
            found.append(
                said(
                    "{where}: further keys from here on are not known and were not used",
                    where=self._further,
                )
            )
        unknown = [ResultWarning("unknown_key", text) for text in found]
        return tuple(dict.fromkeys([*unknown, *self.warnings]))


def _texts(entry: _Unknown) -> list[str]:
    nearest = nearest_names(entry.key, entry.known)
    return [
        said(
            "{where}: {key} is not known and was not used. {nearest}",
            where=where,
            key=shown(entry.key),
            nearest=nearest,
        )
        for where in _places(entry.places)
    ]


def _places(places: Sequence[str]) -> list[str]:
    """Places of one mistake: each, or the first and how many more there are."""
    if len(places) <= _MOST_PLACES:
        return list(places)
    first, count = places[0], len(places) - 1
    return [
        counted(
            "{where} and {count} further place",
            "{where} and {count} further places",
            where=first,
            count=count,
        )
    ]


def told_once(problems: Sequence[Problem]) -> list[Problem]:
    """Problems that differ in nothing but their place, together, where they are many."""
    groups = _grouped(problems, lambda item: (item.what, item.found, item.expected, item.hint))
    return [
        replace(group[0], where=where)
        for group in groups
        for where in _places([item.where for item in group])
    ]


def _grouped(items: Iterable[T], key: Callable[[T], Hashable]) -> list[list[T]]:
    """Items of one key together, in the order of the first of each."""
    groups: dict[Hashable, list[T]] = {}
    for item in items:
        groups.setdefault(key(item), []).append(item)
    return list(groups.values())
