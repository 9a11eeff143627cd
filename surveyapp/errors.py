"""How the program says that an input is wrong: what, where, found, expected, hint.

Every problem of a file is collected before anything is raised, so that a surveyor mends a book
once and not once per line.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from dataclasses import asdict, dataclass


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

    def to_dict(self) -> dict[str, str]:
        """The five keys of the JSON error."""
        return asdict(self)

    def __str__(self) -> str:
        text = f"{self.where}: {self.what}" if self.where else self.what
        if self.found:
            text += f"; found {self.found}"
        if self.expected:
            text += f"; expected {self.expected}"
        return f"{text}. {self.hint}" if self.hint else text


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


_MOST_PROBLEMS = 200
_MOST_NAMES = 60
"""More names are counted: comparing and listing thousands helps nobody."""


def _listed(problems: tuple[Problem, ...]) -> tuple[Problem, ...]:
    """The first problems; of a file of another kind every line would be one."""
    if len(problems) <= _MOST_PROBLEMS:
        return problems
    rest = len(problems) - _MOST_PROBLEMS
    return (*problems[:_MOST_PROBLEMS], Problem(f"{rest} further problems"))


def nearest_names(name: str, known: Iterable[str]) -> str:
    """Name the nearest known names, then all of them: the hint for an unknown name."""
    names = sorted(set(known))
    if len(names) > _MOST_NAMES:
        close = [n for n in names if n.casefold() == name.casefold()][:2]
        names = [*names[:_MOST_NAMES], f"{len(names) - _MOST_NAMES} more"]
    else:
        close = difflib.get_close_matches(name[:80], names, n=2, cutoff=0.5)
    listing = ", ".join(names) if names else "none"
    if close:
        return f"Did you mean {' or '.join(close)}? Known: {listing}"
    return f"Known: {listing}"
