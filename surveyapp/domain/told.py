"""Warnings of a result that say what they are about."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, ClassVar, Protocol, TypeVar

from surveyapp.domain.project import ResultWarning
from surveyapp.domain.subject import Subject


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
