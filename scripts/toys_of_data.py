"""Toys of what is brought in by data or by formats: effect, check, importer, exporter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True, slots=True)
class Place:
    """A line or an entry that is put before another one of a file.

    Parameters
    ----------
    file : str
    before : str
        Text that stands once in the file.
    entry : str
        What is put there.
    """

    file: str
    before: str
    entry: str


@dataclass(frozen=True, slots=True)
class Toy:
    """Something new.

    Parameters
    ----------
    name : str
    files : tuple of (str, str)
        New files with their text.
    places : tuple of Place
        Import lines of a new file are not counted: they go with its entry.
    imports : tuple of Place
    proof : str
        Code that fails unless the toy comes out at the other end; ``run`` calls the command line
        and returns what it printed.
    """

    name: str
    files: tuple[tuple[str, str], ...]
    places: tuple[Place, ...]
    imports: tuple[Place, ...]
    proof: str

    @property
    def touched(self) -> int:
        """Files that are changed."""
        return len({place.file for place in self.places})


EFFECTS: Final = "models/surveyapp_models/effects/__init__.py"
EFFECT: Final = Toy(
    "effect with a new campaign column",
    (
        (
            "models/surveyapp_models/effects/campaign/toy_tide.py",
            '''"""The constant follows the number of readings."""

from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Coefficient, Column, Columns, Effect


def basis(columns: Columns, /, **grid: float) -> Floats:
    """The column about its mean."""
    value = columns["toy_rows"]
    return (value - value.mean())[:, None]


EFFECT = Effect(
    id="toy_tide",
    title="Toy tide",
    subject="campaign",
    needs=(Column("toy_rows", "rows"),),
    coefficients=(Coefficient("rate", "arcsec/row", ARCSEC, -9.0, 9.0, "per row"),),
    basis=basis,
    datum="the mean number of rows",
    source="a toy",
    remedy="none",
    symptom="the constant follows the rows",
    separate_by="sessions of unlike length",
)
''',
        ),
    ),
    (
        Place(EFFECTS, "    _c_latitude.EFFECT,\n", "    _c_toy_tide.EFFECT,\n"),
        Place(
            "surveyapp/core/orientation/campaign_columns.py",
            ')\n"""Every column, in the order',
            '    CampaignColumn("toy_rows", "rows", "readings of the session",\n'
            "        each(lambda at: float(len(at.session.book.rows))), _within(3.0, 9.0)),\n",
        ),
    ),
    (
        Place(
            EFFECTS,
            "from surveyapp_models.effects.campaign import latitude as",
            "from surveyapp_models.effects.campaign import toy_tide as _c_toy_tide\n",
        ),
    ),
    """
import numpy as np
from surveyapp.core.orientation.circumstances import Circumstances, facts_of
from surveyapp.diagnosis import diagnose
from surveyapp.diagnosis.subjects.campaign import CampaignDetermination, campaign
found = api.compute(SAMPLE).orientation
facts = facts_of(found.sessions, found.constants[0].instrument.id, found.positions)
assert all(fact.number("toy_rows") > 0 for fact in facts.values())
rng = np.random.default_rng(1)
rows = rng.uniform(3.0, 9.0, 24)
values = 5e-5 * rows + rng.normal(0.0, 1e-6, 24)
case = campaign([CampaignDetermination(float(v), 1e-6, Circumstances.of({"toy_rows": float(r)}))
                 for v, r in zip(values, rows)])
result = diagnose(case, draws=200, advise=False)
assert "toy_tide" in str(result.to_dict()["candidates"]), result.to_dict()
""",
)
CHECK: Final = Toy(
    "check",
    (
        (
            "surveyapp/core/checks/toy_check.py",
            '''"""A toy."""

from surveyapp.core.checks.evidence import Evidence
from surveyapp.domain.results import Check
from surveyapp.domain.subject import Subject


def toy_checks(evidence: Evidence) -> list[Check]:
    """How many stations there are."""
    count = float(len(evidence.project.stations))
    subject = Subject.project()
    return [Check("toy.stations", "a toy", count, 99.0, True, True, subject=subject, text="toy")]
''',
        ),
    ),
    (
        Place(
            "surveyapp/core/checks/verdicts.py",
            '    CheckGroup("limits", "every limit',
            '    CheckGroup("toy", "a toy", toy_checks),\n',
        ),
    ),
    (
        Place(
            "surveyapp/core/checks/verdicts.py",
            "from surveyapp.core.checks.traverse_checks import",
            "from surveyapp.core.checks.toy_check import toy_checks\n",
        ),
    ),
    """
for command in (["check", SAMPLE], ["orient", SAMPLE], ["report", SAMPLE, "--text"]):
    assert "toy" in run(*command), command
""",
)
IMPORTS: Final = "surveyapp/io/importers/fieldfiles/catalogue.py"
IMPORTER: Final = Toy(
    "importer",
    (
        (
            "surveyapp/io/importers/fieldfiles/toyformat.py",
            '''"""A toy: comma-separated pointings without a head."""

from pathlib import Path

from surveyapp.domain.fieldfile import FieldFile
from surveyapp.io.importers.fieldfiles.gathering import ReadOptions
from surveyapp.io.importers.fieldfiles.tablecsv import read_csv


def read_toy(path: Path, options: ReadOptions) -> FieldFile:
    """Read a toy."""
    columns = {"at": "at", "to": "to", "hz": "hz", "v": "v", "sd": "d"}
    units = {"hz": "deg", "v": "deg", "sd": "m"}
    own = ReadOptions(options.skip_damaged, None, columns, units, None, None)
    return read_csv(path, own)
''',
        ),
    ),
    (
        Place(
            IMPORTS,
            '    Importer("jobxml", "Trimble JobXML"',
            '    Importer("toy", "a toy format", (".toy",), read_toy),\n',
        ),
    ),
    (
        Place(
            IMPORTS,
            "\n\n@dataclass(frozen=True, slots=True)\nclass Importer:",
            "from surveyapp.io.importers.fieldfiles.toyformat import read_toy\n",
        ),
    ),
    """
assert "toy: a toy format" in " ".join(run("import", "--help").split())
field = FOLDER / "field.toy"
field.write_text("at,to,hz,v,d\\nA,B,10.0,90.0,50.0\\nA,C,100.0,90.0,60.0\\n")
run("new", str(FOLDER / "own"))
told = run("import", "toy", str(field), str(FOLDER / "own"), "--preview")
assert "2 readings" in told, told
from surveyapp.observation.exchange import entries
assert [e.format for e in entries(str(FOLDER)) if e.name == "field.toy"] == ["toy"]
""",
)
EXPORTS: Final = "surveyapp/io/exporters/catalogue.py"
EXPORTER: Final = Toy(
    "exporter",
    (
        (
            "surveyapp/io/exporters/toy.py",
            '''"""A toy."""

from surveyapp.domain.exported import ExportedSurvey, Written


def toy_text(survey: ExportedSurvey) -> Written:
    """Names of the points."""
    names = [point.name for point in survey.points]
    return Written("\\n".join(names), len(names), ())
''',
        ),
    ),
    (
        Place(
            EXPORTS,
            '    Exporter("dxf",',
            '    Exporter("toy", said("a toy"), ".toy", lambda survey, _: toy_text(survey)),\n',
        ),
    ),
    (
        Place(
            EXPORTS,
            "from surveyapp.languages import said",
            "from surveyapp.io.exporters.toy import toy_text\n",
        ),
    ),
    """
run("export", "toy", SAMPLE, str(FOLDER / "out.toy"))
assert "G3007" in (FOLDER / "out.toy").read_text()
from surveyapp.observation.exchange import export_formats
assert "toy" in export_formats()
""",
)
