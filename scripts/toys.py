"""Places to touch for a toy of each kind, performed in a copy of the program and tried there.

``python -m scripts.toys`` copies the sources, brings each toy in as a newcomer would, runs what
shows it to a surveyor, and prints how many files are new and in how many places of how many files
something stands more. A toy that does not come out at the other end is a fault.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).resolve().parents[1]
SAMPLE: Final = "projects/tongjin-2015"


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
from surveyapp.diagnosis.subjects.campaign import Determination, campaign
found = api.compute(SAMPLE).orientation
facts = facts_of(found.sessions, found.constants[0].instrument.id, found.positions)
assert all(fact.number("toy_rows") > 0 for fact in facts.values())
rng = np.random.default_rng(1)
rows = rng.uniform(3.0, 9.0, 24)
values = 5e-5 * rows + rng.normal(0.0, 1e-6, 24)
case = campaign([Determination(float(v), 1e-6, Circumstances.of({"toy_rows": float(r)}))
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
COMMAND: Final = Toy(
    "command",
    (
        (
            "surveyapp/cli/toy.py",
            '''"""``surveyapp toy DIR``."""

import argparse

from surveyapp.cli.output import print_json


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("folder")


def run(options: argparse.Namespace) -> int:
    """Count the stations."""
    from surveyapp import api

    stations = api.open_project(options.folder).stations
    print_json({"schema": "surveyapp.toy/1", "stations": len(stations)})
    return 0
''',
        ),
    ),
    (
        Place(
            "surveyapp/cli/main.py",
            '    Command("demo", "demo"',
            '    Command("toy", "toy", "a toy"),\n',
        ),
    ),
    (),
    """
assert '"stations": 10' in run("toy", SAMPLE)
assert "a toy" in run("--help")
""",
)
FIELD: Final = Toy(
    "result field",
    (),
    (
        Place(
            "surveyapp/domain/results.py",
            "    @property\n    def subject(self) -> Subject:\n        "
            '"""The line as a value: its two stations',
            "    toy_sessions: int = 0\n\n",
        ),
        Place(
            "surveyapp/domain/results.py",
            '            "existing_azimuth_deg": to_degrees(self.existing_azimuth),\n',
            '            "toy_sessions": self.toy_sessions,\n',
        ),
        Place(
            "surveyapp/core/orientation/lines.py",
            "        gyro_azimuth=angle_result(gyro, ",
            "        toy_sessions=len(rounds),\n",
        ),
        Place(
            "surveyapp/report/sections/azimuths.py",
            '    if line.distance_m is not None:\n        rows.append((said("length',
            '    rows.append(("toy sessions", str(line.toy_sessions), "", "", ""))\n',
        ),
        Place(
            "docs/reference/json.md",
            "| `existing_azimuth_deg`, `distance_m` |",
            "| `toy_sessions` | a toy |\n",
        ),
    ),
    (),
    """
assert '"toy_sessions": 1' in run("orient", SAMPLE, "--json")
assert "toy sessions" in run("orient", SAMPLE)
assert "toy sessions" in run("report", SAMPLE, "--text")
from surveyapp.tui.views.project import details_of
project = api.open_project(SAMPLE)
assert "toy sessions" in details_of(project, api.orient(project), "lines", 0, width=78).plain
""",
)
RECORD: Final = "surveyapp/report/record.py"
SECTION: Final = Toy(
    "section of the record",
    (
        (
            "surveyapp/report/sections/toy.py",
            '''"""A toy."""

from surveyapp.domain.project import Project
from surveyapp.report.blocks import Block, Heading, Paragraph


def blocks(project: Project) -> tuple[Block, ...]:
    """How many stations there are."""
    return (Heading("Toy heading"), Paragraph(f"{len(project.stations)} stations"))
''',
        ),
    ),
    (
        Place(
            RECORD,
            '    Section("seal", ',
            '    Section("toy", "a toy", lambda r: toy.blocks(r.project)),\n',
        ),
    ),
    (Place(RECORD, ")\nfrom surveyapp.report.stamp import", "    toy,\n"),),
    """
assert "Toy heading" in run("report", SAMPLE, "--text")
""",
)
OBSERVATIONS: Final = "surveyapp/domain/observations.py"
KIND: Final = Toy(
    "kind of observation of a traverse",
    (),
    (
        Place(OBSERVATIONS, '    AZIMUTH = "azimuth"\n', '    TOY_EAST = "toy_east"\n'),
        Place(
            OBSERVATIONS,
            ')\n"""Every kind once;',
            "    KindOfObservation(ObservationKind.TOY_EAST, "
            '"a toy: difference of east", book="value"),\n',
        ),
        Place(
            "surveyapp/core/network/linearise.py",
            ')\n"""One equation for every kind',
            '    Equation(K.TOY_EAST, difference, (("at", 0), ("to", 0))),\n',
        ),
    ),
    (),
    """
folder = FOLDER / "net"
(folder / "observations").mkdir(parents=True)
(folder / "project.toml").write_text('''format = 1
[[station]]
name = "A"
e = 1000.0
n = 1000.0
fixed = true
[[station]]
name = "B"
e = 1000.0
n = 1100.0
fixed = true
[[station]]
name = "C"
[[traverse]]
name = "t"
book = "observations/t.csv"
sigma_angle_arcsec = 7.0
sigma_distance = { mm = 2.0, ppm = 2.0 }
''')
(folder / "observations" / "t.csv").write_text('''kind,at,from,to,value,sigma
angle,A,B,C,90-00-00,
distance,A,,C,50.000,
toy_east,A,,C,50.010,2.0
''')
told = run("adjust", str(folder))
assert "toy_east" in told, told
east = next(p.e for p in api.adjust(folder).points if p.name == "C")
assert 1050.0 < east < 1050.01, east
""",
)
TOYS: Final = (EFFECT, CHECK, IMPORTER, EXPORTER, COMMAND, FIELD, SECTION, KIND)

PROOF: Final = """
import contextlib, io, pathlib, sys
from surveyapp import api
from surveyapp.cli.main import main
SAMPLE, FOLDER = sys.argv[1], pathlib.Path(sys.argv[2])

def run(*arguments):
    out = io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
        try:
            code = main(list(arguments))
        except SystemExit as leaving:
            code = leaving.code or 0
    assert code in (0, 1), (arguments, code, out.getvalue())
    return out.getvalue()
"""


def bring_in(root: Path, toy: Toy) -> None:
    """Put a toy into a copy of the sources.

    Raises
    ------
    ValueError
        If a place is not there, or not once.
    """
    for name, text in toy.files:
        (root / name).write_text(text, encoding="utf-8")
    for place in (*toy.places, *toy.imports):
        path = root / place.file
        text = path.read_text(encoding="utf-8")
        if text.count(place.before) != 1:
            raise ValueError(f"{toy.name}: {place.file} has {place.before!r} not once")
        changed = text.replace(place.before, place.entry + place.before)
        path.write_text(changed, encoding="utf-8")


def perform(root: Path) -> None:
    """Bring all toys into a copy below ``root``, and try each of them in one process."""
    for name in ("surveyapp", "models", SAMPLE, "docs/reference"):
        shutil.copytree(ROOT / name, root / name, ignore=shutil.ignore_patterns("__pycache__"))
    for toy in TOYS:
        bring_in(root, toy)
    scratch = root / "scratch"
    scratch.mkdir()
    script = PROOF + "".join(toy.proof for toy in TOYS)
    subprocess.run(
        [sys.executable, "-c", script, str(root / SAMPLE), str(scratch)],
        cwd=root,
        env={"PYTHONPATH": f"{root}:{root / 'models'}", "PATH": "/usr/bin:/bin"},
        check=True,
        text=True,
        capture_output=True,
    )


def counts() -> str:
    """The table of places."""
    lines = [f"{'toy':36}{'new files':>10}{'places':>8}{'in files':>10}"]
    lines += [f"{t.name:36}{len(t.files):10}{len(t.places):8}{t.touched:10}" for t in TOYS]
    return "\n".join(lines)


def main() -> int:
    """Perform the toys and print the places."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            perform(Path(folder))
        except subprocess.CalledProcessError as failed:
            print(failed.stderr, file=sys.stderr)
            return 1
    print(counts())
    return 0


if __name__ == "__main__":
    sys.exit(main())
