"""Field files of 100 MB in every format: seconds, megabytes of memory, and what is answered.

Each file is a simulated traverse written over and over. Whole it is more than one traverse holds
and is refused in words that name the parts; the first part is then taken. A JobXML file that holds
little but records that are not used is taken whole.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from tests.formats.field_writers import TABLE_MAP, gsi, jobxml, sdr, simulated, table

BYTES = 100_000_000
LIMIT_MB = 300.0
_STATIONS = 50
_CHILD = """
import json, resource, sys
from surveyapp import api
from surveyapp.errors import SurveyError
form, file, folder, options = sys.argv[1:5]
told = []
try:
    result = api.import_file(form, file, folder, progress=told.append, **json.loads(options))
    said = f"{result.readings} readings, {result.rows} rows"
except SurveyError as error:
    said = f"{error.problems[0].what}: {error.problems[0].found}"
    print(error.problems[0].hint.partition(": ")[2].partition(",")[0])
else:
    print()
usage = resource.getrusage(resource.RUSAGE_SELF)
print(usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024, len(told), said)
"""


def _files() -> Iterator[tuple[str, str, list[str], list[str], list[str], dict[str, object]]]:
    """Format, title, head, what is repeated, tail, options."""
    truth = simulated(_STATIONS, 4)
    units = {"hz": "gon", "v": "gon", "sd": "m", "hi": "m", "ht": "m"}
    yield "gsi", "GSI-16", [], gsi(*truth, width=16), [], {}
    yield "gsi", "GSI-8, one line", [], [" ".join(gsi(*truth))], [], {}
    lines = sdr(*truth)
    yield "sdr", "SDR33", lines[:3], lines[3:], [], {}
    lines = jobxml(*truth)
    yield "jobxml", "JobXML", lines[:3], lines[3:-1], lines[-1:], {}
    note = "<NoteRecord><Note>" + "x" * 400 + "</Note></NoteRecord>"
    yield "jobxml", "JobXML, notes", lines[:-1], [note] * 1000, lines[-1:], {}
    lines = table(truth[1])
    yield "csv", "CSV", lines[:1], lines[1:], [], {"columns": TABLE_MAP, "units": units}


def _imported(form: str, file: Path, folder: Path, options: dict[str, object]) -> list[str]:
    folder.mkdir()
    (folder / "project.toml").write_text('format = 1\nname = "huge"\n', encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-c", _CHILD, form, str(file), str(folder), json.dumps(options)],
        check=True,
        capture_output=True,
        text=True,
    )
    return done.stdout.splitlines()


def _line(title: str, answer: str) -> str:
    seconds, megabytes, told, said = answer.split(" ", 3)
    verdict = "met" if float(megabytes) < LIMIT_MB and int(told) > 10 else "NOT MET"
    return (
        f"{title:<16} {float(seconds):5.1f} s  {float(megabytes):4.0f} MB of {LIMIT_MB:.0f}  "
        f"progress told {told} times  {verdict}  {said}"
    )


def run() -> Iterator[str]:
    """One line for each file, and one for its first part."""
    for form, title, head, body, tail, options in _files():
        with tempfile.TemporaryDirectory() as name:
            file = Path(name) / f"huge.{form}"
            text = "\n".join(body) + ("\n" if "one line" not in title else " ")
            with file.open("w", encoding="utf-8") as stream:
                stream.write("\n".join(head) + "\n" if head else "")
                for _ in range(BYTES // len(text)):
                    stream.write(text)
                stream.write("\n".join(tail) + "\n")
            part, answer = _imported(form, file, Path(name) / "whole", options)
            yield _line(title, answer)
            if part and "one line" not in title:
                first, last = part.split("-")
                more = {**options, "lines": [int(first), int(last)]}
                yield _line(f"  lines {part}", _imported(form, file, Path(name) / "p", more)[1])
