"""How the program says that an input is wrong: what, where, found, expected, hint.

Every problem of a file is collected before anything is raised, so that a surveyor mends a book
once and not once per line.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from dataclasses import asdict, dataclass, replace

from surveyapp.languages.said import Said, counted, either, joined, said, term


@dataclass(frozen=True, slots=True)
class Problem:
    """One thing that is wrong.

    Parameters
    ----------
    what : str
        What is wrong, one sentence in the trade's words.
    where : str
        File and line, session and reading, or an argument of the API. Within a text an argument
        stands between backticks; the command line shows the option that gave it.
    found : str
        What stands there.
    expected : str
        What should stand there.
    hint : str
        What to do about it; may be empty.
    """

    what: str
    where: str = ""
    found: str = ""
    expected: str = ""
    hint: str = ""

    def __post_init__(self) -> None:
        """Make plain texts texts of the catalogue; what was found and where is as it is."""
        for name in ("what", "expected", "hint"):
            text = getattr(self, name)
            if not isinstance(text, Said):
                object.__setattr__(self, name, term(text))

    def within(self, place: str) -> Problem:
        """The same problem, with the file or table that holds its place before it."""
        return replace(self, where=joined(", ", (place, self.where)))

    def to_dict(self) -> dict[str, str]:
        """The five keys of the JSON error, in English."""
        return asdict(self)

    @property
    def text(self) -> str:
        """All in one line; ``languages.shown`` says it in the language in use."""
        text = joined(": ", (self.where, self.what)) if self.where else self.what
        if self.found:
            text = said("{text}; found {found}", text=text, found=self.found)
        if self.expected:
            text = said("{text}; expected {expected}", text=text, expected=self.expected)
        return joined(". ", (text, self.hint)) if self.hint else text

    def __str__(self) -> str:
        return str(self.text)


class SurveyError(Exception):
    """Input that cannot be used, with all its problems together.

    Parameters
    ----------
    problems : Problem or iterable of Problem
        At least one.
    """

    def __init__(self, problems: Problem | Iterable[Problem]) -> None:
        self.problems: tuple[Problem, ...] = _listed(
            (problems,) if isinstance(problems, Problem) else tuple(problems)
        )
        super().__init__("\n".join(str(problem) for problem in self.problems))

    @property
    def text(self) -> str:
        """Every problem in a line of its own; ``languages.shown`` says it."""
        return joined("\n", (problem.text for problem in self.problems))


_MOST_PROBLEMS = 200
_MOST_NAMES = 60
"""More names are counted: comparing and listing thousands helps nobody."""


def _listed(problems: tuple[Problem, ...]) -> tuple[Problem, ...]:
    """The first problems; of a file of another kind every line would be one."""
    if len(problems) <= _MOST_PROBLEMS:
        return problems
    rest = sum(_stands_for(problem) for problem in problems[_MOST_PROBLEMS:])
    return (*problems[:_MOST_PROBLEMS], Problem(_further(rest)))


def _further(count: int) -> str:
    return counted("{count} further problem", "{count} further problems", count=count)


def _stands_for(problem: Problem) -> int:
    """How many a problem is: one, or as many as an earlier listing has counted."""
    what = problem.what
    count = what.fields.get("count") if isinstance(what, Said) else None
    return count if isinstance(count, int) and what == _further(count) else 1


def nearest_names(name: str, known: Iterable[str]) -> str:
    """Name the nearest known names, then all of them: the hint for an unknown name."""
    names = sorted(set(known))
    if len(names) > _MOST_NAMES:
        close = [n for n in names if n.casefold() == name.casefold()][:2]
        names = [*names[:_MOST_NAMES], f"{len(names) - _MOST_NAMES} more"]
    else:
        close = difflib.get_close_matches(name[:80], names, n=2, cutoff=0.5)
    listing = ", ".join(names) if names else said("none")
    if close:
        return said("Did you mean {close}? Known: {names}", close=either(close), names=listing)
    return said("Known: {names}", names=listing)
