"""Warnings of a result: what its reader must know, and what each is about."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar, Protocol, TypeVar

from surveyapp.domain.subject import Subject
from surveyapp.languages import Said, term


@dataclass(frozen=True, slots=True)
class ResultWarning:
    """Something a reader of the result must know; data, not a log line.

    Parameters
    ----------
    code, text : str
    subject : Subject or None
        What it is about; None: the project or the file as a whole.
    """

    code: str
    text: str
    subject: Subject | None = None

    def __post_init__(self) -> None:
        """Make a plain text one of the catalogue."""
        if not isinstance(self.text, Said):
            object.__setattr__(self, "text", term(self.text))

    def about(self, subject: Subject) -> ResultWarning:
        """The same warning about this subject, where it does not say what it is about."""
        return self if self.subject is not None else replace(self, subject=subject)

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        subject = None if self.subject is None else self.subject.to_dict()
        return {"code": self.code, "text": self.text, "subject": subject}


class Warned(Protocol):
    """A frozen result with warnings."""

    __dataclass_fields__: ClassVar[dict[str, Any]]

    @property
    def warnings(self) -> tuple[ResultWarning, ...]:
        """What a reader must know."""


Result = TypeVar("Result", bound=Warned)


def told_about(result: Result, subject: Subject) -> Result:
    """The result with this subject on every warning that does not say what it is about."""
    return replace(result, warnings=tuple(item.about(subject) for item in result.warnings))
