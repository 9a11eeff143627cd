"""Closing, reopening and tampering: a changed byte is found, a crash leaves everything whole."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
from datetime import UTC, datetime
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surveyapp import api
from surveyapp.cli.main import main
from surveyapp.core.checks.filing_checks import filing_checks
from surveyapp.errors import SurveyError
from surveyapp.io.filing.ledger import LEDGER_FILE, append_entry, parse_ledger, read_ledger
from surveyapp.io.filing.sealed_files import project_file_names
from surveyapp.io.filing.seals import is_closed, read_filing
from surveyapp.io.template import create_project
from surveyapp.io.tomltext import atomic_write
from surveyapp.observation.session import SessionDesk

ROOT = Path(__file__).resolve().parents[2]

PROJECT = """format = 1
name = "Шахта 潼金矿"
rule_book = "own.toml"
[[instrument]]
id = "G1"
card = "cards/own-card.toml"
[[station]]
name = "A"
lat = 34.5
lon = 111.2
[[orientation]]
id = "run"
station = "A"
instrument = "G1"
method = "tracking"
book = "observations/run.csv"
[[sensor_log]]
id = "swing"
kind = "compass"
file = "sensors/swing.csv"
columns = { time_s = "t" }
"""
BOOK = "seq,kind,value\n" + "".join(
    f"{k + 1},reversal,{180 + (k % 2) * 2}-00-{10 + k}\n" for k in range(7)
)
CARD = 'id = "own-card"\ntitle = "Own"\nkind = "suspended"\nsource = "made for a test"\n'


def now() -> datetime:
    return datetime(2026, 3, 1, 12, tzinfo=UTC)


def make(parent: Path) -> Path:
    folder = parent / "mine"
    for name, text in {
        "mine/project.toml": PROJECT,
        "mine/observations/run.csv": BOOK,
        "mine/sensors/swing.csv": "t,x\n0,1\n",
        "mine/own.toml": rule_book(),
        "mine/notes/remarks.txt": "wet\n",
        "mine/cards/own-card.toml": CARD,
    }.items():
        path = parent / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return folder


def rule_book() -> str:
    return (
        'id = "own"\ntitle = "Own"\nsource = "office"\n[[limit]]\nid = "zero"\n'
        'quantity = "tape_zero"\nlimit = 0.5\nunit = "div"\nclause = "1"\nsource = "office"\n'
        "confirmed = true\n"
    )


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return make(tmp_path)


@pytest.fixture(scope="module")
def closed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = make(tmp_path_factory.mktemp("closed"))
    append_entry(
        folder, "diagnosis", {"verdict": "adequate", "p": 1e-05}, at="2026-02-01", software="s"
    )
    api.close(folder, by="Γεωργίου", now=now)
    return folder


def found_by_check(folder: Path) -> bool:
    """Whether ``check`` finds the change: a confirmed check not met, or a problem that says so."""
    try:
        checks = api.check(folder)
    except SurveyError as error:
        return any("was changed" in problem.what for problem in error.problems)
    return any(
        check.passed is False and check.confirmed and check.rule.startswith(("closing", "ledger"))
        for check in checks
    )


def test_everything_is_sealed(closed: Path) -> None:
    names = project_file_names(closed)
    assert names[0] == "project.toml"
    assert set(names) == {
        "project.toml",
        "observations/run.csv",
        "sensors/swing.csv",
        "own.toml",
        "notes/remarks.txt",
        "cards/own-card.toml",
    }
    entry = read_ledger(closed).entries[-1]
    assert [row["name"] for row in entry.data["files"]] == list(names)
    assert entry.data["by"] == "Γεωργίου"
    assert entry.at == "2026-03-01T12:00:00+00:00"
    assert not found_by_check(closed)
    assert is_closed(closed)


@settings(max_examples=120, deadline=None)
@given(st.data())
def test_any_single_changed_byte_is_found(closed: Path, data: st.DataObject) -> None:
    names = [*project_file_names(closed), LEDGER_FILE]
    path = closed / data.draw(st.sampled_from(names))
    whole = path.read_bytes()
    place = data.draw(st.integers(0, len(whole) - 1))
    flip = data.draw(st.integers(1, 255))
    try:
        path.write_bytes(whole[:place] + bytes([whole[place] ^ flip]) + whole[place + 1 :])
        assert found_by_check(closed), (path.name, place, flip)
    finally:
        path.write_bytes(whole)


def test_every_byte_of_the_ledger_is_guarded(closed: Path) -> None:
    whole = (closed / LEDGER_FILE).read_bytes()
    assert not parse_ledger(whole).faults
    for place in range(len(whole)):
        for flip in {1, 32, 128, whole[place] ^ 10} - {0}:  # the last makes a newline of it
            changed = whole[:place] + bytes([whole[place] ^ flip]) + whole[place + 1 :]
            ledger = parse_ledger(changed)
            assert ledger.faults or ledger.tail_altered, (place, flip)


def test_a_missing_file_and_a_file_that_grew_are_found(folder: Path) -> None:
    api.close(folder, now=now)
    (folder / "sensors" / "swing.csv").unlink()
    with (folder / "observations" / "run.csv").open("a", encoding="utf-8") as book:
        book.write("8,note,\n")
    (check,) = [c for c in api.check(folder) if c.rule == "closing.unchanged"]
    assert check.passed is False
    assert "sensors/swing.csv is missing" in check.text
    assert "observations/run.csv was changed" in check.text
    assert main(["check", str(folder)]) == 1


def test_a_closed_project_is_read_only_until_it_is_reopened(folder: Path) -> None:
    api.close(folder, now=now)
    observation = SessionDesk(folder, "run")
    assert not observation.writable
    observation.close()
    with pytest.raises(SurveyError) as caught:
        api.close(folder)
    assert "closed already" in caught.value.problems[0].what
    result = api.reopen(folder, reason="turning point 3 was misread", by="Иванов", now=now)
    assert result.found == ()
    assert not is_closed(folder)
    observation = SessionDesk(folder, "run")
    assert observation.writable
    observation.close()
    kinds = [entry.kind for entry in read_ledger(folder).entries]
    assert kinds == ["closing", "reopening"]
    assert api.close(folder).entry == 3
    assert not found_by_check(folder)


def test_a_reopening_needs_a_reason_and_tells_what_was_changed(folder: Path) -> None:
    with pytest.raises(SurveyError):
        api.reopen(folder, reason="nothing is closed")
    api.close(folder)
    with pytest.raises(SurveyError):
        api.reopen(folder, reason="  ")
    (folder / "own.toml").write_text(rule_book().replace("0.5", "5.0"), encoding="utf-8")
    result = api.reopen(folder, reason="new limits")
    assert result.found == ("own.toml was changed",)
    assert read_ledger(folder).entries[-1].data["found"] == ["own.toml was changed"]


def test_a_session_is_closed_by_itself(folder: Path) -> None:
    result = api.close(folder, session="run", by="Иванов", now=now)
    assert (result.scope, result.files) == ("session", 1)
    assert not is_closed(folder)
    assert is_closed(folder, "run")
    observation = SessionDesk(folder, "run")
    assert not observation.writable
    observation.close()
    text = PROJECT.replace('name = "A"\nlat = 34.5', 'name = "A"\nlat = 34.6')
    (folder / "project.toml").write_text(text, encoding="utf-8")
    assert found_by_check(folder), "the azimuth depends on the position of its station"
    (folder / "project.toml").write_text(PROJECT, encoding="utf-8")
    assert not found_by_check(folder)
    changed = PROJECT.replace('method = "tracking"', 'method = "tracking"\nobserver = "X"')
    (folder / "project.toml").write_text(changed, encoding="utf-8")
    assert found_by_check(folder)
    api.reopen(folder, session="run", reason="observer was missing")
    assert not found_by_check(folder)
    with pytest.raises(SurveyError) as caught:
        api.close(folder, session="rum")
    assert "run" in caught.value.problems[0].hint


CRASH = """
import os, sys
from pathlib import Path
from surveyapp import api
from surveyapp.io.filing import ledger
keep = int(sys.argv[2])
def torn(path, data):
    with path.open("ab") as stream:
        stream.write(data[:keep])
        stream.flush()
        os.fsync(stream.fileno())
    os._exit(9)
ledger._append = torn
api.close(sys.argv[1])
"""


@pytest.mark.parametrize("keep", [0, 1, 200, 10_000])
def test_a_crash_in_the_middle_of_closing_leaves_the_project_open_and_whole(
    keep: int, folder: Path
) -> None:
    """Killed after any number of bytes of the entry; 10 000 is all of it: then it is closed."""
    api.close(folder, session="run", now=now)
    api.reopen(folder, session="run", reason="a ledger that exists already", now=now)
    before = {name: (folder / name).read_bytes() for name in project_file_names(folder)}
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join((str(ROOT), str(ROOT / "models")))}
    done = subprocess.run(
        [sys.executable, "-c", CRASH, str(folder), str(keep)], env=environment, check=False
    )
    assert done.returncode == 9
    assert {name: (folder / name).read_bytes() for name in before} == before
    assert is_closed(folder) is (keep == 10_000)
    assert not found_by_check(folder)
    api.orient(folder)
    if keep < 10_000:
        result = api.close(folder)
        assert result.entry == 3
        assert is_closed(folder)
        assert not found_by_check(folder)


def test_a_full_disk_takes_the_entry_back(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    append_entry(folder, "diagnosis", {}, at="2026-01-01", software="s")
    before = (folder / LEDGER_FILE).read_bytes()

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("surveyapp.io.filing.ledger.os.fsync", full)
    with pytest.raises(SurveyError) as caught:
        append_entry(folder, "closing", {}, at="2026-01-02", software="s")
    assert "No space" in caught.value.problems[0].what
    monkeypatch.undo()
    assert (folder / LEDGER_FILE).read_bytes() == before


def test_a_torn_tail_is_tolerated_and_moved_aside(folder: Path) -> None:
    append_entry(folder, "diagnosis", {"n": 1}, at="2026-01-01", software="s")
    with (folder / LEDGER_FILE).open("ab") as stream:
        stream.write(b'{"at":"2026')
    assert len(read_ledger(folder).entries) == 1
    (tail,) = [c for c in filing_checks(read_filing(folder)) if c.rule == "ledger.tail"]
    assert (tail.passed, tail.confirmed) == (False, False)
    append_entry(folder, "diagnosis", {"n": 2}, at="2026-01-03", software="s")
    ledger = read_ledger(folder)
    assert [entry.data["n"] for entry in ledger.entries] == [1, 2]
    assert not ledger.tail
    assert not ledger.faults
    assert (folder / f"{LEDGER_FILE}.torn").read_bytes() == b'{"at":"2026\n'


def test_a_damaged_ledger_refuses_a_closing_but_not_the_work(folder: Path) -> None:
    append_entry(folder, "diagnosis", {"n": 1}, at="2026-01-01", software="s")
    path = folder / LEDGER_FILE
    path.write_bytes(path.read_bytes().replace(b'"n":1', b'"n":2'))
    with pytest.raises(SurveyError) as caught:
        api.close(folder)
    assert "ledger was changed" in caught.value.problems[0].what
    assert api.orient(folder).sessions


def test_the_record_shows_the_seal(folder: Path) -> None:
    assert "Closing" not in api.report_text(folder)
    seal = api.close(folder, by="Иванов", now=now).seal
    text = api.report_text(folder)
    assert seal in text
    assert "Иванов" in text


def test_closing_on_the_command_line(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["close", str(folder), "--by", "X", "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed["schema"] == "surveyapp.closing/1"
    assert printed["files"] == 6
    assert main(["reopen", str(folder), "--reason", "again"]) == 0
    assert main(["reopen", str(folder), "--reason", "again"]) == 2


def test_a_second_opener_cannot_close(folder: Path) -> None:
    observation = SessionDesk(folder, "run")
    try:
        with pytest.raises(SurveyError) as caught:
            api.close(folder)
    finally:
        observation.close()
    assert "cannot be written" in caught.value.problems[0].what
    assert not (folder / LEDGER_FILE).exists()


def test_a_new_project_can_be_closed() -> None:
    with tempfile.TemporaryDirectory() as parent:
        folder = Path(parent) / "new"
        create_project(folder, name="New")
        api.close(folder)
        assert is_closed(folder)
        atomic_write(folder / "project.toml", b"format = 1\n")
        assert found_by_check(folder)
        shutil.rmtree(folder)


def test_a_ledger_in_which_nothing_was_closed_adds_no_check(folder: Path) -> None:
    before = api.check(folder)
    append_entry(folder, "diagnosis", {"n": 1}, at="2026-01-01", software="s")
    assert api.check(folder) == before
    path = folder / LEDGER_FILE
    path.write_bytes(path.read_bytes().replace(b'"n":1', b'"n":3'))
    assert found_by_check(folder)


def test_the_head_of_the_signed_record_is_verified(folder: Path) -> None:
    head = api.close(folder, by="Μ", now=now).head
    assert len(head.replace("-", "")) == 20
    assert api.check(folder, seal=head)[-1].passed
    assert api.check(folder, seal=head.lower().replace("-", " "))[-1].passed
    other = head[:-1] + ("0" if head[-1] != "0" else "1")
    assert api.check(folder, seal=other)[-1].passed is False
    assert main(["check", str(folder), "--seal", other]) == 1
    assert main(["check", str(folder), "--seal", "short"]) == 2
    (folder / "notes" / "remarks.txt").write_text("dry\n", encoding="utf-8")
    assert api.check(folder, seal=head)[-1].passed is False


@pytest.mark.parametrize("scope", [None, "run"])
def test_who_forges_the_whole_ledger_is_found_by_the_paper(folder: Path, scope: str | None) -> None:
    head = api.close(folder, session=scope, now=now).head
    for name in (LEDGER_FILE, "closings.txt"):
        (folder / name).unlink()
    book = folder / "observations" / "run.csv"
    book.write_text(book.read_text("utf-8") + "\n", encoding="utf-8")
    forged = api.close(folder, session=scope, now=now).head
    assert forged != head
    assert api.check(folder, seal=head)[-1].passed is False


@pytest.mark.parametrize("scope", [None, "run"])
@pytest.mark.parametrize("keep", [0, 1])
def test_a_ledger_that_was_deleted_or_cut_is_missed(
    folder: Path, scope: str | None, keep: int
) -> None:
    append_entry(folder, "diagnosis", {"p": 0.5}, at="2026-02-01", software="s")
    api.close(folder, session=scope, now=now)
    lines = (folder / LEDGER_FILE).read_bytes().splitlines(keepends=True)
    (folder / LEDGER_FILE).write_bytes(b"".join(lines[:keep]))
    if not keep:
        (folder / LEDGER_FILE).unlink()
    assert found_by_check(folder)
    assert main(["check", str(folder)]) == 1


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("lat = 34.5", "lat = 34.6"),
        ('id = "G1"', 'id = "G1"\nscale_value_arcsec = 601.0'),
        ('rule_book = "own.toml"', 'rule_book = "own.toml"\nangle_unit = "dms"'),
    ],
)
def test_the_seal_of_a_session_covers_what_its_azimuth_depends_on(
    folder: Path, old: str, new: str
) -> None:
    api.close(folder, session="run", now=now)
    assert not found_by_check(folder)
    (folder / "project.toml").write_text(PROJECT.replace(old, new), encoding="utf-8")
    assert found_by_check(folder)
    (folder / "project.toml").write_text(PROJECT, encoding="utf-8")
    (folder / "cards" / "own-card.toml").write_text(CARD + "# changed\n", encoding="utf-8")
    assert found_by_check(folder)
