"""``python -m bench mutated``: mutated .gkf files and project folders never end in a fault.

Bytes, numbers, names, tags and lines of sound files are changed at random; every command answers
with 0, 1 or 2, without a traceback, within seconds. The suite runs a seeded part of it.
"""

from __future__ import annotations

import contextlib
import io
import random
import re
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

from surveyapp.cli.main import main as command
from tests.network.hostile_numbers import mutated

ROOT = Path(__file__).resolve().parents[1]
NETWORKS = ROOT.parent / "shared" / "data" / "networks"
LONGEST_S = 20.0


def run_one(path: Path) -> tuple[int, float, str]:
    """Exit code, seconds and what was said of ``adjust`` on a file."""
    out, err = io.StringIO(), io.StringIO()
    began = time.perf_counter()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = command(["adjust", str(path), "--json"])
    text = out.getvalue() + err.getvalue()
    if re.search(r"\bNaN\b|\bInfinity\b", out.getvalue()):
        code = 4
    return code, time.perf_counter() - began, text


def main(arguments: list[str]) -> int:
    """Run the campaign; an argument gives the number of files."""
    count = int(arguments[0]) if arguments else 1500
    sources = sorted(NETWORKS.rglob("*.gkf"))
    if not sources:
        print("no networks beside the project: nothing to mutate")
        return 0
    rng = random.Random(13)
    codes: Counter[int] = Counter()
    faults: Counter[str] = Counter()
    longest = 0.0
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mutated.gkf"
        for _ in range(count):
            path.write_bytes(mutated(rng.choice(sources).read_bytes(), rng))
            code, seconds, text = run_one(path)
            codes[code] += 1
            longest = max(longest, seconds)
            if code not in (0, 1, 2) or seconds > LONGEST_S:
                faults[text.strip()[:200]] += 1
    print(
        f"{count} mutated .gkf: exit codes {dict(sorted(codes.items()))}, longest {longest:.1f} s"
    )
    for text, number in faults.most_common(12):
        print(f"  {number} x {text}", file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
