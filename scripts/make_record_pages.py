"""Pictures of the survey records of the samples, for the documentation.

Writes docs/images/record-SAMPLE-N.png, and record-names-N.png: a made-up session with names in
three scripts, a struck reading and a closed project. Needs pdftoppm (poppler-utils); the pictures
are committed, so that whoever reads the documentation needs nothing.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from datetime import UTC, datetime
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "models")]

from surveyapp import api  # noqa: E402

SAMPLES = ("johannesburg-1966", "gi-b1-1966", "tongjin-2015")
DOTS_PER_INCH = 80
FOLDER = ROOT / "docs" / "images"


PROJECT = """# Made up: shows names and a struck reading, not a survey.
format = 1
name = "潼金矿 (made up)"
[[instrument]]
id = "G1"
card = "wild-gak1"
scale_value_arcsec = 600.0
period = { latitude_deg = 34.5, tracking_s = 430.0, clamped_s = 392.0 }
[[station]]
name = "甲"
lat = 34.5
lon = 111.2
[[station]]
name = "Шахта 2"
[[orientation]]
id = "run-1"
station = "甲"
target = "Шахта 2"
instrument = "G1"
method = "tracking"
observer = "Иванов, Γεωργίου"
date = 2026-03-01
book = "observations/run-1.csv"
"""
BOOK = """seq,kind,value,unit,face,note
1,backsight,040-00-00.0,dms,L,
2,backsight,220-00-04.0,dms,R,
3,tape_zero,2.25,div,,
4,tape_zero,-1.70,div,,
5,tape_zero,2.19,div,,
6,reversal,179-48-02.0,dms,,
7,reversal,182-10-52.0,dms,,
8,reversal,179-50-09.0,dms,,
9,reversal,182-18-45.0,dms,,сбой
10,strike,9,,,Γεωργίου: misread 潼
11,reversal,182-08-45.0,dms,,
12,reversal,179-52-11.0,dms,,
13,reversal,182-06-40.0,dms,,
14,reversal,179-54-15.0,dms,,
15,backsight,040-00-01.0,dms,L,
16,backsight,220-00-05.0,dms,R,
"""


def named_project(folder: Path) -> Path:
    (folder / "observations").mkdir(parents=True)
    (folder / "project.toml").write_text(PROJECT, encoding="utf-8")
    (folder / "observations" / "run-1.csv").write_text(BOOK, encoding="utf-8")
    moment = datetime(2026, 3, 2, 9, tzinfo=UTC)
    api.close(folder, by="王 Иванов", now=lambda: moment)
    return folder


def main() -> int:
    program = shutil.which("pdftoppm")
    if program is None:
        print("pdftoppm is missing (poppler-utils)", file=sys.stderr)
        return 1
    FOLDER.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        projects = {name: ROOT / "projects" / name for name in SAMPLES}
        projects["names"] = named_project(Path(folder) / "names")
        for name, project in projects.items():
            for old in FOLDER.glob(f"record-{name}-*.png"):
                old.unlink()
            pdf = Path(folder) / f"{name}.pdf"
            result = api.report(project, pdf)
            command = [program, "-r", str(DOTS_PER_INCH), "-png", "-gray", str(pdf)]
            subprocess.run([*command, str(FOLDER / f"record-{name}")], check=True)
            print(f"{name}: {result.pages} pages, sha256 {result.sha256}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
