"""Headless modules import no screen and no PDF writer; the command line starts with neither."""

import json
import pkgutil
import subprocess
import sys
from pathlib import Path

import pytest

import surveyapp
import surveyapp_models

ROOT = Path(__file__).resolve().parents[2]
SCREENS = ("surveyapp.tui",)
WRITERS = ("surveyapp.report.pdf",)
ENV = {"PYTHONPATH": f"{ROOT}:{ROOT / 'models'}", "PATH": "/usr/bin:/bin"}


def modules() -> list[str]:
    names = []
    for package in (surveyapp, surveyapp_models):
        names.append(package.__name__)
        walk = pkgutil.walk_packages(package.__path__, f"{package.__name__}.")
        names.extend(info.name for info in walk)
    return sorted(name for name in names if not name.startswith((*SCREENS, *WRITERS)))


def loaded_after(code: str) -> set[str]:
    script = f"import sys, json\n{code}\njson.dump(sorted(sys.modules), sys.stdout)"
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True, env=ENV
    )
    return set(json.loads(done.stdout))


def test_headless_modules_import_neither_screens_nor_what_is_heavy() -> None:
    """Textual and reportlab never; scipy, pyproj and the like on first use only."""
    names = [name for name in modules() if not name.endswith("__main__")]
    assert len(names) > 60
    loaded = loaded_after("import importlib\n" + f"for n in {names!r}: importlib.import_module(n)")
    assert not {"textual", "reportlab", "rich"} & loaded
    assert not {"scipy", "pyproj", "tomlkit", "filelock", "defusedxml", "platformdirs"} & loaded


def test_help_imports_nothing_heavy() -> None:
    loaded = loaded_after(
        "import io, contextlib\nfrom surveyapp.cli.main import main\n"
        "with contextlib.redirect_stdout(io.StringIO()): main(['--help'])"
    )
    heavy = {"numpy", "scipy", "pyproj", "textual", "reportlab", "tomlkit"}
    assert not heavy & loaded


def test_orient_needs_no_scipy() -> None:
    sample = ROOT / "projects" / "tongjin-2015"
    loaded = loaded_after(
        "import io, contextlib\nfrom surveyapp.cli.main import main\n"
        f"with contextlib.redirect_stdout(io.StringIO()): main(['orient', {str(sample)!r}])"
    )
    assert "pyproj" in loaded
    assert not {"scipy", "textual", "reportlab"} & loaded


@pytest.mark.parametrize("word", ["time.time", "datetime.now", "print(", "open(", "random.seed"])
def test_core_has_no_clock_file_or_global_randomness(word: str) -> None:
    places = [
        ROOT / "models" / "surveyapp_models",
        *(ROOT / "surveyapp" / part for part in ("domain", "core", "diagnosis")),
    ]
    found = []
    for place in places:
        for path in place.rglob("*.py"):
            for number, line in enumerate(path.read_text().splitlines(), 1):
                code = line.split("#")[0]
                if word in code and f"_{word}" not in code and f".{word}" not in code:
                    found.append(f"{path.relative_to(ROOT)}:{number}: {line.strip()}")
    assert found == []
