"""Crashes in the middle: torn books, full disks, kills between write and replace."""

import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest

from surveyapp.errors import SurveyError
from surveyapp.io.fieldbook import append_row, read_field_book
from surveyapp.io.fieldbook.reading import move_tail_aside
from surveyapp.io.filing.lock import ProjectLock
from surveyapp.io.project import read_project
from surveyapp.io.writing import atomic_write
from surveyapp_models.angles import AngleUnit

ROOT = Path(__file__).parents[2]
ENVIRONMENT = {**os.environ, "PYTHONPATH": f"{ROOT}{os.pathsep}{ROOT / 'models'}"}
BOOK = (
    "seq,kind,value,note\r\n1,reversal,179-00-00,\r\n2,reversal,181-00-00,Stra\u00dfe\r\n"
    "3,reversal,179-01-00,\n4,reversal,180-59-00,\n"
).encode()


def read(path: Path, *, repair: bool = True) -> list[int]:
    return [r.seq for r in read_field_book(path, angle_unit=AngleUnit.DMS, repair=repair).rows]


def test_a_book_cut_at_any_byte_keeps_every_complete_row(tmp_path: Path) -> None:
    path = tmp_path / "b.csv"
    torn = tmp_path / "b.csv.torn"
    for cut in range(len(BOOK) + 1):
        path.write_bytes(BOOK[:cut])
        torn.unlink(missing_ok=True)
        whole = BOOK[:cut].rfind(b"\n") + 1
        rows = list(range(1, BOOK[:cut].count(b"\n")))
        book = read_field_book(path, angle_unit=AngleUnit.DMS, repair=False)
        assert [r.seq for r in book.rows] == rows
        assert (book.torn_tail is None) == (whole == cut)
        assert path.read_bytes() == BOOK[:cut]
        assert not torn.exists()
        assert read(path) == rows
        assert path.read_bytes() == BOOK[:whole]
        assert torn.exists() == (whole < cut)
        if whole < cut:
            assert torn.read_bytes() == BOOK[whole:cut] + b"\n"


def test_torn_tails_are_collected(tmp_path: Path) -> None:
    path = tmp_path / "b.csv"
    for tail in (b"5,rev", b"5,reversal,17"):
        path.write_bytes(BOOK + tail)
        assert read(path) == [1, 2, 3, 4]
    assert (tmp_path / "b.csv.torn").read_bytes() == b"5,rev\n5,reversal,17\n"


def test_a_binary_file_is_not_taken_for_a_torn_line(tmp_path: Path) -> None:
    path = tmp_path / "b.csv"
    for data in (b"\x89PNG\0\0", b"seq,kind,value\r1,note,\r", b"x" * 5000, BOOK + b"x" * 5000):
        path.write_bytes(data)
        with pytest.raises(SurveyError):
            read(path)
        assert path.read_bytes() == data


def test_a_tail_that_cannot_be_moved_is_left_out_in_memory(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(handle: int) -> None:
        raise OSError(28, "No space left on device")

    path = tmp_path / "b.csv"
    path.write_bytes(BOOK + b"5,rev")
    monkeypatch.setattr(os, "fsync", refuse)
    assert read(path) == [1, 2, 3, 4]
    assert path.read_bytes() == BOOK + b"5,rev"


def test_a_book_that_has_grown_since_it_was_read_is_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "b.csv"
    path.write_bytes(BOOK + b"5,rev" + b"ersal,179-02-00,\n")
    assert move_tail_aside(path, size=len(BOOK) + 5, tail=b"5,rev") is False
    assert read(path) == [1, 2, 3, 4, 5]


def project(folder: Path) -> Path:
    (folder / "project.toml").write_text(
        'format = 1\n[[station]]\nname = "A"\n[[instrument]]\nid = "G"\ncard = "wild-gak1"\n'
        '[[orientation]]\nid = "r"\nstation = "A"\ninstrument = "G"\nmethod = "tracking"\n'
        'book = "b.csv"\n',
        encoding="utf-8",
    )
    (folder / "b.csv").write_bytes(BOOK + b"5,rev")
    return folder


def test_a_project_repairs_only_while_nobody_else_writes(tmp_path: Path) -> None:
    project(tmp_path)
    with ProjectLock(tmp_path) as writer:
        assert writer.writable
        found = read_project(tmp_path)
        assert found.sessions[0].book.torn_tail == "5,rev"
        assert (tmp_path / "b.csv").read_bytes() == BOOK + b"5,rev"
    second = read_project(tmp_path)
    assert second.digest == found.digest
    assert [w.code for w in second.warnings] == ["torn_tail"]
    assert "b.csv.torn" in second.warnings[0].text
    third = read_project(tmp_path)
    assert (third.digest, third.warnings) == (found.digest, ())


def test_the_second_opener_reads(tmp_path: Path) -> None:
    with ProjectLock(tmp_path) as first:
        with ProjectLock(tmp_path) as second:
            assert (first.writable, second.writable) == (True, False)
        assert first.writable
    with ProjectLock(tmp_path) as third:
        assert third.writable
    assert not ProjectLock(tmp_path / "none").writable
    assert not (tmp_path / "none").exists()


def test_rows_are_appended_one_by_one(tmp_path: Path) -> None:
    path = tmp_path / "observations" / "b.csv"
    assert append_row(path, {"kind": "reversal", "value": "179-00-00", "note": 'a "b", c'}) == 1
    assert append_row(path, {"kind": "reversal", "value": "181-00-00"}) == 2
    before = path.read_bytes()
    assert append_row(path, {"kind": "strike", "value": "2"}) == 3
    assert path.read_bytes().startswith(before)
    book = read_field_book(path, angle_unit=AngleUnit.DMS)
    assert [r.note for r in book.rows] == ['a "b", c', "", ""]
    assert book.struck == (2,)


def test_a_row_keeps_the_columns_and_line_ends_of_its_book(tmp_path: Path) -> None:
    path = tmp_path / "b.csv"
    path.write_bytes(b"\xef\xbb\xbfvalue,seq,kind\r\n179-00-00,7,reversal\r\n")
    assert append_row(path, {"kind": "missed", "note": ""}) == 8
    assert path.read_bytes().endswith(b"179-00-00,7,reversal\r\n,8,missed\r\n")
    with pytest.raises(SurveyError, match="no column note"):
        append_row(path, {"kind": "missed", "note": "wind"})


@pytest.mark.parametrize(
    ("row", "word"),
    [
        ({"kind": "reversal", "value": "198.5"}, "gon"),
        ({"kind": "reversal", "value": "181-00-01"}, "missed"),
        ({"kind": "note", "note": "two\nlines"}, "one line"),
        ({"kind": "note", "note": "\x1b"}, "one line"),
        ({"kind": "strike", "value": "9"}, "stand above"),
        ({"value": "9"}, "kind"),
    ],
)
def test_a_wrong_row_is_refused_and_changes_nothing(
    tmp_path: Path, row: dict[str, str], word: str
) -> None:
    path = tmp_path / "b.csv"
    path.write_bytes(BOOK)
    with pytest.raises(SurveyError, match=word):
        append_row(path, row)
    assert path.read_bytes() == BOOK


def test_a_book_with_an_old_problem_can_be_mended_by_a_strike(tmp_path: Path) -> None:
    path = tmp_path / "b.csv"
    path.write_bytes(BOOK + b"5,reversal,365-00-00,\n")
    assert append_row(path, {"kind": "strike", "value": "5"}) == 6
    assert read(path) == [1, 2, 3, 4, 5, 6]


def test_an_old_problem_does_not_stop_the_next_reading(tmp_path: Path) -> None:
    path = tmp_path / "b.csv"
    path.write_bytes(BOOK + b"5,reversal,365-00-00,\n")
    assert append_row(path, {"kind": "reversal", "value": "179-02-00"}) == 6
    with pytest.raises(SurveyError, match="366") as caught:
        append_row(path, {"kind": "reversal", "value": "366-00-00"})
    assert len(caught.value.problems) == 1


def test_a_short_write_leaves_the_earlier_rows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "b.csv"
    path.write_bytes(BOOK)
    real = os.write
    monkeypatch.setattr(os, "write", lambda handle, data: real(handle, data[:5]))
    with pytest.raises(SurveyError, match="5 of"):
        append_row(path, {"kind": "missed"})
    assert path.read_bytes() == BOOK


def test_a_full_disk_leaves_the_earlier_rows() -> None:
    if not Path("/dev/full").exists():
        pytest.skip("no /dev/full")
    with pytest.raises(SurveyError):
        append_row(Path("/dev/full"), {"kind": "missed"})


def test_a_failing_fsync_reports_and_leaves_the_earlier_rows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(handle: int) -> None:
        raise OSError(28, "No space left on device")

    path = tmp_path / "b.csv"
    path.write_bytes(BOOK)
    monkeypatch.setattr(os, "fsync", refuse)
    with pytest.raises(SurveyError, match="No space left"):
        append_row(path, {"kind": "missed"})
    assert path.read_bytes() == BOOK


APPENDER = """
import sys
from pathlib import Path
from surveyapp.io.fieldbook import append_row
while True:
    print(append_row(Path(sys.argv[1]), {"kind": "note", "note": "x" * 200}), flush=True)
"""


@pytest.mark.parametrize("pause_s", [0.005, 0.013, 0.05])
def test_every_reported_reading_survives_a_kill(tmp_path: Path, pause_s: float) -> None:
    path = tmp_path / "b.csv"
    command = [sys.executable, "-c", APPENDER, str(path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, env=ENVIRONMENT, text=True) as child:
        assert child.stdout is not None
        assert child.stdout.readline() == "1\n"
        time.sleep(pause_s)
        child.kill()
        reported = 1 + child.stdout.read().count("\n")
    rows = read(path)
    assert rows == list(range(1, len(rows) + 1))
    assert reported <= len(rows) <= reported + 1


@pytest.mark.parametrize("step", ["fsync", "replace", "mkstemp"])
def test_an_error_at_any_step_leaves_the_old_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, step: str
) -> None:
    def refuse(*arguments: object, **options: object) -> None:
        raise OSError(28, "No space left on device")

    path = tmp_path / "project.toml"
    path.write_bytes(b"old")
    owners: dict[str, object] = {"fsync": os, "mkstemp": tempfile, "replace": Path}
    monkeypatch.setattr(owners[step], step, refuse)
    with pytest.raises(SurveyError, match="No space left"):
        atomic_write(path, b"new")
    assert path.read_bytes() == b"old"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["project.toml"]


KILLED = """
import os, sys
from pathlib import Path
from surveyapp.io.writing import append_table, set_value
Path.replace = lambda self, target: os.kill(os.getpid(), 9)
path = Path(sys.argv[1])
if sys.argv[2] == "append":
    append_table(path, "station", {"name": "B"})
else:
    set_value(path, ("orientation", "r", "target"), "A")
"""


@pytest.mark.parametrize("change", ["append", "set"])
def test_a_kill_before_the_replace_leaves_the_old_file(tmp_path: Path, change: str) -> None:
    path = project(tmp_path) / "project.toml"
    old = path.read_bytes()
    command = [sys.executable, "-c", KILLED, str(path), change]
    assert subprocess.run(command, env=ENVIRONMENT, check=False).returncode == -signal.SIGKILL
    assert path.read_bytes() == old
    assert read_project(tmp_path, repair=False).stations[0].name == "A"
