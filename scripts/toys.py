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
from pathlib import Path
from typing import Final

from scripts.toys_of_data import CHECK, EFFECT, EXPORTER, IMPORTER, Place, Toy

ROOT: Final = Path(__file__).resolve().parents[1]
SAMPLE: Final = "projects/tongjin-2015"


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
from surveyapp.tui.views.blocks import blocks_as_text
from surveyapp.tui.views.project import details_of
project = api.open_project(SAMPLE)
shown = details_of(project, api.orient(project), "lines", 0)
assert "toy sessions" in blocks_as_text(shown, 78).plain
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
