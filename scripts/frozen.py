"""What differs in the JSON of every command between two checkouts.

``python -m scripts.frozen A B [FOLDER...]``: each checkout runs the commands on the sample projects
of A, and on the projects and networks of the folders that are named behind (copies: nothing is
written there). Numbers are alike within ``ALIKE``; what is left is printed by command and key, with
how often and where first. Exit code 1 where anything differs.
"""

from __future__ import annotations

import argparse
import json
import math
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

ALIKE: Final = 1e-12
PASSED_OVER: Final = ("software", "seconds", "written")
"""Keys that belong to the moment or the version and not to the result."""

WORKER: Final = """
import contextlib, io, json, pathlib, shutil, sys, tempfile, tomllib
from surveyapp.cli.main import main

def told(*arguments):
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            code = main([*arguments, "--json"])
        except SystemExit as leaving:
            code = leaving.code
    try:
        return [code, json.loads(out.getvalue())]
    except ValueError:
        return [code, "no JSON"]

def commands(place):
    if place.suffix == ".gkf":
        return [["adjust"]]
    try:
        tables = tomllib.loads((place / "project.toml").read_text("utf-8-sig"))
    except (OSError, ValueError):
        return [["orient"], ["check"]]
    found = [["orient"], ["check"], ["plan"], ["diagnose"]]
    sessions = [t.get("id") for t in tables.get("orientation", []) if isinstance(t, dict)]
    found += [["orient", "--session", str(name)] for name in sessions[:1]]
    if tables.get("traverse"):
        found += [["adjust"], ["adjust", "--compass-rule"]]
    if tables.get("penetration"):
        found += [["predict"]]
    if tables.get("shaft"):
        found += [["shaft"]]
    return found

result = {"models": told("models"), "demo": told("demo")}
for name in sys.argv[1:]:
    given = pathlib.Path(name)
    with tempfile.TemporaryDirectory() as folder:
        place = pathlib.Path(folder) / given.name
        (shutil.copytree if given.is_dir() else shutil.copy)(given, place)
        for command, *options in commands(place):
            key = " ".join([command, *options[:1], given.name])
            result[key] = told(command, str(place), *options)
            text = json.dumps(result[key]).replace(folder, "FOLDER")
            result[key] = json.loads(text)
json.dump(result, sys.stdout)
"""


def told_by(root: Path, places: list[Path]) -> dict[str, Any]:
    """JSON of every command in a checkout."""
    done = subprocess.run(
        [sys.executable, "-c", WORKER, *map(str, places)],
        cwd=root,
        env={
            "PYTHONPATH": f"{root}:{root / 'models'}",
            "PATH": "/usr/bin:/bin",
            "HOME": "/nowhere",
        },
        capture_output=True,
        text=True,
        check=True,
    )
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def differences(a: object, b: object, key: str = "") -> Iterator[str]:
    """Keys at which two values differ; places in lists are not told."""
    if isinstance(a, dict) and isinstance(b, dict):
        for name in sorted({*a, *b} - {*PASSED_OVER}):
            inner = f"{key}.{name}"
            if name in a and name in b:
                yield from differences(a[name], b[name], inner)
            else:
                yield f"{inner} is {'new' if name in b else 'gone'}"
    elif isinstance(a, list) and isinstance(b, list):
        if len(a) != len(b):
            yield f"{key}[] has another length"
        for one, other in zip(a, b, strict=False):
            yield from differences(one, other, f"{key}[]")
    elif isinstance(a, float | int) and isinstance(b, float | int):
        if not math.isclose(a, b, rel_tol=ALIKE, abs_tol=ALIKE):
            yield f"{key} is another number"
    elif a != b:
        yield f"{key} is another {'text' if isinstance(a, str) else 'value'}"


def places_of(root: Path, folders: list[Path]) -> list[Path]:
    """Projects and networks: the samples of a checkout, and what lies in other folders."""
    found = sorted((root / "projects").iterdir())
    for folder in folders:
        found += [p for p in sorted(folder.iterdir()) if p.is_dir() or p.suffix == ".gkf"]
    return found


def main() -> int:
    """Compare two checkouts."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("before", type=Path)
    parser.add_argument("after", type=Path)
    parser.add_argument("folders", type=Path, nargs="*", help="with more projects")
    options = parser.parse_args()
    places = places_of(options.before.resolve(), [f.resolve() for f in options.folders])
    before, after = (told_by(r.resolve(), places) for r in (options.before, options.after))
    seen: dict[str, list[str]] = {}
    for name in before:
        for text in dict.fromkeys(differences(before[name], after.get(name))):
            seen.setdefault(f"{name.split()[0]}: {text}", []).append(name)
    print(f"{len(before)} answers of {len(places)} projects and networks")
    for text, names in sorted(seen.items()):
        print(f"  {text} ({len(names)}, first {names[0]})")
    return 1 if seen else 0


if __name__ == "__main__":
    sys.exit(main())
