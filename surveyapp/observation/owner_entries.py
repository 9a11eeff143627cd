"""Values of an instrument that its owner types when he adds it, as keys of ``[[instrument]]``."""

from __future__ import annotations

from dataclasses import dataclass

from surveyapp.errors import Problem, SurveyError
from surveyapp.io.decimals import typed_number, typed_words


@dataclass(frozen=True, slots=True)
class OwnerEntries:
    """Texts of the fields; empty ones are left to the card.

    Parameters
    ----------
    scale : str
        One division of the scale [arcsec].
    periods : str
        T1 and T2 [s] and the latitude [deg] at which they were measured; T2 may be left out.
    torsion : str
        lambda at that latitude.
    """

    scale: str = ""
    periods: str = ""
    torsion: str = ""

    def overrides(self) -> dict[str, object]:
        """Keys of the ``[[instrument]]`` table.

        Raises
        ------
        SurveyError
            If a text is not what its field asks for, all of them together.
        """
        problems: list[Problem] = []
        scale = _numbers(
            self.scale, (1,), "scale value", "arc-seconds, like 600", problems=problems
        )
        expected = "T1, T2 and latitude, like 425.4 388.3 47.0"
        periods = _numbers(self.periods, (2, 3), "periods", expected, problems=problems)
        torsion = _numbers(
            self.torsion, (1,), "torsion ratio", "lambda, like 0.2", problems=problems
        )
        if problems:
            raise SurveyError(problems)
        found: dict[str, object] = {}
        if scale:
            found["scale_value_arcsec"] = scale[0]
        if periods:
            clamped = {"clamped_s": periods[1]} if len(periods) == 3 else {}
            found["period"] = {"latitude_deg": periods[-1], "tracking_s": periods[0], **clamped}
        if torsion:
            found["torsion"] = {"lambda": torsion[0]}
        return found


def _numbers(
    text: str, counts: tuple[int, ...], where: str, expected: str, *, problems: list[Problem]
) -> list[float]:
    if not text.strip():
        return []
    try:
        values = [typed_number(part) for part in typed_words(text)]
    except ValueError:
        values = []
    if len(values) in counts:
        return values
    hint = "Numbers with blanks between them."
    problems.append(Problem("not the numbers that are asked for", where, text, expected, hint))
    return []
