"""The contracts of the layers see what they are meant to see: forbidden imports are put in."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FORBIDDEN = {
    "surveyapp/workflows/intruder.py": "textual",
    "surveyapp/core/leastsquares/intruder.py": "pyproj",
    "surveyapp/observation/intruder.py": "reportlab",
    "surveyapp/domain/intruder.py": "surveyapp.core.uncertain",
    "models/surveyapp_models/gyro/intruder.py": "scipy",
}
"""Where an import inside a function is put, and of what."""
BROKEN = (
    "Only tui imports textual BROKEN",
    "Only core.geodesy imports pyproj BROKEN",
    "Only report.pdf imports reportlab BROKEN",
    "Layers import downward only BROKEN",
    "Models need numpy and the standard library only BROKEN",
)


def verdict(folder: Path) -> str:
    command = Path(sys.executable).with_name("lint-imports")
    done = subprocess.run(
        [command, "--no-cache"],
        cwd=folder,
        env={"PYTHONPATH": f"{folder}:{folder / 'models'}", "PATH": "/usr/bin:/bin"},
        capture_output=True,
        text=True,
        check=False,
    )
    return done.stdout + done.stderr


def test_an_import_inside_a_function_of_any_room_is_seen(tmp_path: Path) -> None:
    ignored = shutil.ignore_patterns("__pycache__")
    for name in ("surveyapp", "models"):
        shutil.copytree(ROOT / name, tmp_path / name, ignore=ignored)
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    assert "0 broken" in verdict(tmp_path)
    for name, module in FORBIDDEN.items():
        code = f'"""Test."""\n\n\ndef late() -> None:\n    import {module}\n'
        (tmp_path / name).write_text(code, encoding="utf-8")
    found = verdict(tmp_path)
    for line in BROKEN:
        assert line in found, found
