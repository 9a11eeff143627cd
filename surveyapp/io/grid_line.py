"""A mine's own grid typed in one line: for ``surveyapp new`` and the form of a new project."""

from __future__ import annotations

from surveyapp.core.geodesy import open_mine_grid
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.decimals import typed_number, typed_words
from surveyapp.io.findings import Findings
from surveyapp.io.grid_tables import read_mine_grid
from surveyapp.io.tables import Table, parse_toml
from surveyapp.io.tomltext import toml_value
from surveyapp_models.angles import AngleUnit

EXPECTED = (
    "rotation, origin e n, then its base e n (lat lon without a crs), and a sigma in arc-seconds"
)
NUMBERS = (5, 6)


def mine_grid_line(text: str, *, crs: str | None, unit: AngleUnit) -> str:
    """The line of project.toml for a mine grid typed in one line.

    Parameters
    ----------
    text : str
        ``12-00-00 1000 2000 431000.0 3811000.0 5``: rotation, the origin in the mine's grid, the
        origin in the crs (without a crs its latitude and longitude in degrees), and, if it is
        known, the sigma of the rotation in arc-seconds.
    crs : str or None
        The base.
    unit : AngleUnit
        Of the rotation.

    Raises
    ------
    SurveyError
        If it is no mine grid.
    """
    parts = typed_words(text)
    try:
        numbers = [typed_number(part) for part in parts[1:]]
    except ValueError:
        numbers = []
    if len(parts) not in NUMBERS or len(numbers) != len(parts) - 1:
        raise SurveyError(
            Problem(
                "this is no mine grid",
                "mine grid",
                text,
                EXPECTED,
                "for example 12-00-00 1000 2000 47.0 8.0 5",
            )
        )
    names = ("e", "n", "base_e", "base_n") if crs is not None else ("e", "n", "lat", "lon")
    origin = ", ".join(f"{n} = {v!r}" for n, v in zip(names, numbers[:4], strict=True))
    pairs = [] if crs is None else [f"base = {toml_value(crs)}"]
    pairs += [f"rotation = {toml_value(parts[0])}", f"origin = {{ {origin} }}"]
    if len(numbers) > 4:
        pairs.append(f"rotation_sigma_arcsec = {numbers[4]!r}")
    line = f"grid = {{ {', '.join(pairs)} }}"
    findings = Findings()
    table = Table(parse_toml(line, where="mine grid"), "mine grid", findings)
    grid = read_mine_grid(table, unit, None)
    findings.raise_if_any()
    if grid is not None:
        open_mine_grid(grid)
    return line
