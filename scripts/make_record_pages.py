"""Pictures of the survey records of the samples, for the documentation.

Writes docs/images/record-SAMPLE-N.png. Needs pdftoppm (poppler-utils); the pictures are committed,
so that whoever reads the documentation needs nothing.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "models")]

SAMPLES = ("johannesburg-1966", "gi-b1-1966", "tongjin-2015")
DOTS_PER_INCH = 80
FOLDER = ROOT / "docs" / "images"


def main() -> int:
    from surveyapp import api

    program = shutil.which("pdftoppm")
    if program is None:
        print("pdftoppm is missing (poppler-utils)", file=sys.stderr)
        return 1
    FOLDER.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        for name in SAMPLES:
            for old in FOLDER.glob(f"record-{name}-*.png"):
                old.unlink()
            pdf = Path(folder) / f"{name}.pdf"
            result = api.report(ROOT / "projects" / name, pdf)
            command = [program, "-r", str(DOTS_PER_INCH), "-png", "-gray", str(pdf)]
            subprocess.run([*command, str(FOLDER / f"record-{name}")], check=True)
            print(f"{name}: {result.pages} pages, sha256 {result.sha256}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
