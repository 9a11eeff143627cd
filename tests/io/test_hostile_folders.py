"""The folder of a stranger: nothing outside of it is read, written or packed, and nothing hangs.

Each trick was seen to work once: a torn line moved through a link into a login script, a ledger
that was a link, link targets and /etc/shadow in a zip, devices and pipes that hang a command.
"""

from __future__ import annotations

import json
import os
import shutil
import time
import zipfile
from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.cli.main import main
from surveyapp.errors import SurveyError
from surveyapp.io.filing.ledger import LEDGER_FILE, append_entry
from surveyapp.io.guarded import place_inside
from surveyapp.observation.record import write_record
from surveyapp.observation.session import SessionDesk
from tests.tui.helpers_tui import make_project

SECRET = "root:secret:19000\n"
COMMANDS = ("orient", "check", "diagnose", "adjust", "report", "export", "compare", "close")
LONGEST_S = 5.0


@pytest.fixture
def outside(tmp_path: Path) -> Path:
    path = tmp_path / "outside" / "secret"
    path.parent.mkdir()
    path.write_text(SECRET, encoding="utf-8")
    return path


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return make_project(tmp_path / "p")


def run_all(folder: Path, capsys: pytest.CaptureFixture[str]) -> str:
    """Every command on the folder: none of them ends in 3, none takes long; all that they say."""
    said = ""
    for command in COMMANDS:
        arguments = [command, str(folder)]
        if command == "report":
            arguments += ["-o", str(folder.parent / "record.pdf")]
        if command == "export":
            arguments = ["export", "zip", str(folder), str(folder.parent / "all.zip")]
        if command == "compare":
            arguments.append(str(folder))
        began = time.process_time()
        code = main(arguments)
        assert code in (0, 1, 2), (command, code)
        assert time.process_time() - began < LONGEST_S, command
        out, err = capsys.readouterr()
        said += out + err
    return said


def packed_text(folder: Path) -> str:
    path = folder.parent / "all.zip"
    if not path.exists():
        return ""
    with zipfile.ZipFile(path) as packed:
        return "".join(packed.read(n).decode("utf-8", "replace") for n in packed.namelist())


def state(path: Path) -> tuple[bytes, int, list[str]]:
    return path.read_bytes(), path.stat().st_mtime_ns, sorted(p.name for p in path.parent.iterdir())


@pytest.mark.parametrize(
    "name",
    [
        "observations/r1.csv",
        "observations/r1.csv.torn",
        LEDGER_FILE,
        ".surveyapp.lock",
        "notes.txt",
    ],
)
def test_a_link_to_a_file_outside_is_neither_read_nor_written(
    name: str, folder: Path, outside: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = state(outside)
    if name.endswith(".torn"):
        book = folder / "observations" / "r1.csv"
        book.write_text(book.read_text("utf-8") + "1,,,note,,,,,,,evil command", encoding="utf-8")
    (folder / name).unlink(missing_ok=True)
    (folder / name).symlink_to(outside)
    said = run_all(folder, capsys)
    with pytest.raises(SurveyError):
        append_entry(folder, "x", {}, at="2026", software="s") if name == LEDGER_FILE else _write(
            folder
        )
    assert state(outside) == before
    assert "secret:19000" not in said + packed_text(folder)


def _write(folder: Path) -> None:
    seen = SessionDesk(folder, "r1")
    try:
        assert not seen.writable or (folder / "observations" / "r1.csv.torn").is_symlink()
        raise SurveyError(())
    finally:
        seen.close()


def test_a_linked_folder_is_no_way_out(
    folder: Path, outside: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = state(outside)
    (outside.parent / "r1.csv").write_text("seq,kind,value\n1,note", encoding="utf-8")
    for path in (folder / "observations").iterdir():
        path.unlink()
    (folder / "observations").rmdir()
    (folder / "observations").symlink_to(outside.parent)
    (folder / "results").symlink_to(outside.parent)
    said = run_all(folder, capsys)
    assert "leads out of the project folder" in said
    with pytest.raises(SurveyError, match="leads out"):
        write_record(folder)
    (outside.parent / "r1.csv").unlink()
    after = state(outside)
    assert after[0] == before[0]
    assert after[2] == before[2]


@pytest.mark.parametrize("card", ["../outside/secret", "/etc/passwd", "link.toml"])
def test_cards_rule_books_and_logs_outside_are_not_read(
    card: str, folder: Path, outside: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "link.toml").symlink_to(outside)
    path = folder / "project.toml"
    text = path.read_text("utf-8").replace("wild-gak1", card)
    text = text.replace("format = 1", f'format = 1\nrule_book = "{card}"', 1)
    path.write_text(text + f'\n[[sensor_log]]\nid = "l"\nkind = "tilt"\nfile = "{card}"\n', "utf-8")
    said = run_all(folder, capsys)
    assert "leads out" in said
    for word in ("secret:19000", "root:"):
        assert word not in said + packed_text(folder)


@pytest.mark.parametrize("target", ["/dev/zero", "pipe"])
@pytest.mark.parametrize("name", ["observations/r1.csv", LEDGER_FILE, "project.toml", "extra.bin"])
def test_devices_and_pipes_hang_nothing(
    name: str, target: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / name).unlink(missing_ok=True)
    if target == "pipe":
        os.mkfifo(folder / name)
    else:
        (folder / name).symlink_to(target)
    run_all(folder, capsys)


@pytest.mark.parametrize(
    "files",
    [
        [{"name": "/dev/zero", "bytes": 1, "sha256": "x"}],
        [{"name": "../outside/secret", "bytes": 18, "sha256": "x"}],
        ["no table", 5, None],
        {"name": "no list"},
    ],
)
def test_a_forged_closing_hangs_nothing_and_is_no_fault(
    files: object, folder: Path, outside: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    data = {"session": "r1", "files": files, "table_sha256": 5, "depends": ["x"], "by": 5}
    append_entry(folder, "closing", data, at="2026-01-01", software="s")
    said = run_all(folder, capsys)
    assert "internal fault" not in said
    assert outside.read_text("utf-8") == SECRET


@pytest.mark.parametrize(
    "line",
    [b"{}", b"[]", b"null", b'{"seq": [1]}', b"\xff\xfe", b"[" * 5000],
)
def test_a_ledger_of_nonsense_is_told(
    line: bytes, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / LEDGER_FILE).write_bytes(line + b"\n")
    assert "internal fault" not in run_all(folder, capsys)


@pytest.mark.parametrize(
    ("name", "inside"),
    [
        ("observations/r1.csv", True),
        ("observations/../project.toml", True),
        ("../p2/x.csv", False),
        ("/etc/passwd", False),
        ("C:\\Windows\\win.ini", False),
        ("C:x", False),
        ("\\\\server\\share\\x", False),
        ("..\\x", os.name != "nt" and None),
        ("", False),
        ("a\0b", False),
        (".", False),
    ],
)
def test_where_a_path_leads(name: str, inside: bool | None, folder: Path) -> None:
    if inside is not None:
        assert (place_inside(folder, name) is not None) is inside


def test_a_hundred_thousand_columns_and_keys_and_problems_are_answered_at_once(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    book = folder / "observations" / "r1.csv"
    header = "seq,kind,value," + ",".join(f"c{i}" for i in range(100_000))
    book.write_text(header + "\n" + "1,note," + "," * 100_000 + "\n", encoding="utf-8")
    assert "columns" in run_all(folder, capsys)
    book.write_text("seq,kind,value\n", encoding="utf-8")
    toml = (folder / "project.toml").read_text("utf-8")
    (folder / "project.toml").write_text(toml + "a." * 5000 + "b = 1\n", encoding="utf-8")
    run_all(folder, capsys)
    (folder / "project.toml").write_text(toml + "[[station]]\n" * 30_000, encoding="utf-8")
    assert main(["orient", str(folder), "--json"]) == 2
    problems = json.loads(capsys.readouterr().out)["problems"]
    assert [problem["what"] for problem in problems] == ["name is missing"]
    assert problems[0]["where"].endswith(" and 29999 further places")


def test_a_note_steers_no_terminal(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    book = folder / "observations" / "r1.csv"
    row = "1,,,note,,,,,,,abc\u202edef\x9b31m\u2028end\u0085\n"
    book.write_text(book.read_text("utf-8") + row, encoding="utf-8")
    note = api.open_project(folder).sessions[0].book.rows[0].note
    assert note == "abc\\u202edef\\x9b31m\\u2028end"
    path = folder / "project.toml"
    path.write_text(path.read_text("utf-8").replace("Ramp 3", "Ramp\u202e 3\x85\x1b[31m"), "utf-8")
    said = run_all(folder, capsys)
    for letter in "\u202e\x9b\u2028\x85\x1b":
        assert letter not in said


def test_a_book_that_is_another_file_too_is_parted_from_it(folder: Path, tmp_path: Path) -> None:
    """A hard link: the torn line is taken off here and stays in the file outside."""
    book = folder / "observations" / "r1.csv"
    elsewhere = tmp_path / "elsewhere.csv"
    torn = book.read_bytes() + b"99,note,torn"
    elsewhere.write_bytes(torn)
    book.unlink()
    os.link(elsewhere, book)
    assert main(["orient", str(folder)]) in (0, 2)
    assert elsewhere.read_bytes() == torn
    assert book.read_bytes() == torn.removesuffix(b"99,note,torn")
    assert book.with_name("r1.csv.torn").read_bytes().startswith(b"99,note,torn")


def test_a_ledger_that_is_another_file_too_is_parted_from_it(folder: Path, tmp_path: Path) -> None:
    elsewhere = tmp_path / ".profile"
    elsewhere.write_bytes(b"")
    os.link(elsewhere, folder / LEDGER_FILE)
    append_entry(folder, "closing", {}, at="2026-01-01", software="s")
    assert elsewhere.read_bytes() == b""
    assert b"closing" in (folder / LEDGER_FILE).read_bytes()


@pytest.mark.parametrize("name", ["results/r.pdf", "results/deep/r.pdf"])
def test_a_result_is_not_written_through_a_link_of_the_project(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "p"
    shutil.copytree(Path(__file__).resolve().parents[2] / "projects" / "gi-b1-1966", folder)
    shutil.rmtree(folder / "results", ignore_errors=True)
    elsewhere = tmp_path / "elsewhere"
    (elsewhere / "deep").mkdir(parents=True)
    (folder / "results").symlink_to(elsewhere)
    assert main(["report", str(folder), "-o", str(folder / name), "--json"]) == 2
    assert "leads out" in json.loads(capsys.readouterr().out)["problems"][0]["what"]
    assert [path.name for path in elsewhere.rglob("*")] == ["deep"]


@pytest.mark.parametrize(
    "text",
    [
        "\n".join(f"[a{i}]" for i in range(160_000)),
        "\n".join(f"a.b{i}.c.d=1" for i in range(60_000)),
        "a=[" + "1," * 700_000 + "]",
        "a=[" + "[]," * 160_000 + "]",
    ],
)
def test_no_text_of_a_project_costs_more_than_its_length(
    text: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "project.toml").write_text(text, encoding="utf-8")
    began = time.process_time()
    assert main(["orient", str(folder), "--json"]) == 2
    assert time.process_time() - began < 1.0
    assert "beyond all bounds" in json.loads(capsys.readouterr().out)["problems"][0]["what"]


def test_a_text_that_is_too_long_is_refused_in_words(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = f'name = "{"x" * 30_000_000}"\n'
    (folder / "project.toml").write_text(text, encoding="utf-8")
    began = time.process_time()
    assert main(["check", str(folder), "--json"]) == 2
    assert time.process_time() - began < 1.0
    (problem,) = json.loads(capsys.readouterr().out)["problems"]
    assert problem["what"] == "this is too much text for a TOML file"
    assert problem["found"] == "31 million letters"


def test_of_many_unknown_keys_the_first_are_told(folder: Path) -> None:
    before = api.open_project(folder).warnings
    path = folder / "project.toml"
    more = "".join(f"\n[t{i}.a]" for i in range(50_000))
    path.write_text(path.read_text("utf-8") + more, encoding="utf-8")
    began = time.process_time()
    told = [w.text for w in api.open_project(folder).warnings if w not in before]
    assert time.process_time() - began < 3.0
    assert len(told) == 201
    assert told[0].startswith("project.toml: t0 is not known")
    assert "further keys" in told[-1]


@pytest.mark.parametrize("line", ["\n", "x\n", '1,note,"\n'])
def test_a_book_of_millions_of_lines_is_refused_at_once(
    line: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    book = folder / "observations" / "r1.csv"
    book.write_text("seq,kind,value\n" + line * 2_000_000, encoding="utf-8")
    began = time.process_time()
    assert main(["orient", str(folder), "--json"]) == 2
    assert time.process_time() - began < 2.0
    problems = json.loads(capsys.readouterr().out)["problems"]
    assert [problem["what"] for problem in problems] == ["the text has too many lines for a book"]
