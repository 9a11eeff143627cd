"""Import of a GSI-16 file of 100,000 blocks: seconds of processor, megabytes, against its bounds.

The file is simulated (200 stations that are occupied again and again would be the same work); the
bounds are those of the task, 5 s and 300 MB on one core.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from tests.formats.field_writers import gsi, simulated

BLOCKS = 100_000
_CHILD = """
import resource, sys
from surveyapp import api
api.import_file("gsi", sys.argv[1], sys.argv[2])
usage = resource.getrusage(resource.RUSAGE_SELF)
print(usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024)
"""


def run() -> Iterator[str]:
    """One line."""
    stations = 200
    rounds = BLOCKS // (4 * stations)
    lines = gsi(*simulated(stations, rounds), width=16)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "big.gsi").write_text("\n".join(lines) + "\n", encoding="utf-8")
        (folder / "p").mkdir()
        (folder / "p" / "project.toml").write_text('format = 1\nname = "big"\n', encoding="utf-8")
        done = subprocess.run(
            [sys.executable, "-c", _CHILD, str(folder / "big.gsi"), str(folder / "p")],
            check=True,
            capture_output=True,
            text=True,
        )
    seconds, megabytes = (float(text) for text in done.stdout.split())
    verdict = "met" if seconds < 5.0 and megabytes < 300.0 else "NOT MET"
    yield f"{len(lines)} blocks: {seconds:.1f} s of 5, {megabytes:.0f} MB of 300: {verdict}"
