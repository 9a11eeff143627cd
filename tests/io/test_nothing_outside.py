"""Nothing outside of a stranger's folder is opened, and no answer takes 300 MB.

Every opening, listing, renaming and removal that Python asks the system for is an audit event; the
commands are run on hostile folders while they are written down.
"""

from __future__ import annotations

import hashlib
import json
import os
import sys
import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from surveyapp import api
from surveyapp.cli.main import main
from surveyapp.io.filing.ledger import LEDGER_FILE, append_entry
from tests.tui.helpers_tui import make_project

LONGEST_S, LARGEST_MB = 5.0, 300.0
OWN_PEAK = """
import re, sys
from pathlib import Path
from surveyapp.cli.main import main
try:
    sys.exit(main(sys.argv[2:]))
finally:  # its own peak: the one that the system accounts holds that of the process it came from
    peak = re.search(r"VmHWM:\\s+(\\d+) kB", Path("/proc/self/status").read_text())
    Path(sys.argv[1]).write_text(str(int(peak[1]) / 1024.0))
"""
WATCHED = (
    "open", "os.listdir", "os.scandir", "os.rename", "os.remove", "os.mkdir", "os.rmdir", "os.link",
    "os.symlink", "os.truncate", "os.chmod", "shutil.copyfile", "shutil.rmtree",
)  # fmt: skip
_seen: list[tuple[str, str]] | None = None


def _note(event: str, arguments: tuple[Any, ...]) -> None:
    if _seen is not None and event in WATCHED:
        for item in arguments[:2]:
            if isinstance(item, str | bytes | os.PathLike):
                _seen.append((event, os.fsdecode(item)))


@contextmanager
def looked_on() -> Iterator[list[tuple[str, str]]]:
    """Events and paths while the body runs; a hook cannot be taken away, it falls silent."""
    global _seen
    if not getattr(sys, "_surveyapp_hook", False):
        sys.addaudithook(_note)
        sys._surveyapp_hook = True  # type: ignore[attr-defined]
    found: list[tuple[str, str]] = []
    _seen = found
    try:
        yield found
    finally:
        _seen = None


def link_book(folder: Path, outside: Path) -> None:
    (folder / "observations" / "r1.csv").unlink()
    (folder / "observations" / "r1.csv").symlink_to(outside / "book.csv")


def link_ledger(folder: Path, outside: Path) -> None:
    (folder / LEDGER_FILE).symlink_to(outside / "ledger.jsonl")


def link_folder(folder: Path, outside: Path) -> None:
    (folder / "observations" / "r1.csv").unlink()
    (folder / "observations").rmdir()
    (folder / "observations").symlink_to(outside)


def link_torn(folder: Path, outside: Path) -> None:
    book = folder / "observations" / "r1.csv"
    book.write_text(book.read_text("utf-8") + "1,,,note,,,,,,,evil", encoding="utf-8")
    Path(f"{book}.torn").symlink_to(outside / "book.csv")


def link_results(folder: Path, outside: Path) -> None:
    (folder / "results").symlink_to(outside)
    (folder / "signatures").symlink_to(outside)
    (folder / "closings.txt").symlink_to(outside / "book.csv")
    (folder / ".surveyapp.journal").symlink_to(outside / "book.csv")


def named_outside(folder: Path, outside: Path) -> None:
    path = folder / "project.toml"
    text = path.read_text("utf-8").replace('card = "wild-gak1"', f'card = "{outside}/card.toml"')
    text = text.replace("format = 1", 'format = 1\nrule_book = "../outside/card.toml"', 1)
    text += f'\n[[sensor_log]]\nid = "l"\nkind = "tilt"\nfile = "{outside}/book.csv"\n'
    path.write_text(text, "utf-8")


def forged_closing(folder: Path, outside: Path) -> None:
    rows = [{"name": f"{outside}/book.csv", "bytes": 1, "sha256": "x"}]
    data = {"session": "r1", "files": rows, "table_sha256": "x", "depends": {}, "by": "x"}
    append_entry(folder, "closing", data, at="2026-01-01", software="s")


HOSTILE: tuple[Callable[[Path, Path], None], ...] = (
    link_book, link_ledger, link_folder, link_torn, link_results, named_outside, forged_closing,
)  # fmt: skip
COMMANDS = (
    ["orient"], ["check"], ["diagnose"], ["adjust"], ["predict"], ["shaft"], ["close", "--by", "x"],
    ["reopen", "--reason", "x"],
)  # fmt: skip


@pytest.mark.parametrize("trick", HOSTILE, ids=[item.__name__ for item in HOSTILE])
def test_no_command_opens_anything_outside(
    trick: Callable[[Path, Path], None], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    outside = tmp_path / "outside"
    outside.mkdir()
    for name in ("book.csv", "ledger.jsonl", "card.toml", "record.pdf", "r1.csv"):
        (outside / name).write_text("secret", "utf-8")
    before = {p.name: (p.read_bytes(), p.stat().st_mtime_ns) for p in outside.iterdir()}
    folder = make_project(tmp_path / "p")
    trick(folder, outside)
    with looked_on() as events:
        for name, *options in COMMANDS:
            assert main([name, str(folder), *options]) in (0, 1, 2)
        assert main(["report", str(folder), "-o", str(tmp_path / "r.pdf")]) in (0, 1, 2)
        assert main(["export", "zip", str(folder), str(tmp_path / "a.zip")]) in (0, 1, 2)
        assert main(["compare", str(folder), str(folder)]) in (0, 1, 2)
    capsys.readouterr()
    real = os.path.realpath(outside)
    touched = [
        (event, path)
        for event, path in events
        if os.path.realpath(Path(path).parent).startswith(real)
        or (event != "os.scandir" and os.path.realpath(path).startswith(real))
    ]
    assert events
    assert touched == []
    after = {p.name: (p.read_bytes(), p.stat().st_mtime_ns) for p in outside.iterdir()}
    assert after == before


def test_the_watch_sees_an_opening(tmp_path: Path) -> None:
    (tmp_path / "x").write_text("y", "utf-8")
    with looked_on() as events:
        (tmp_path / "x").read_text("utf-8")
    assert ("open", str(tmp_path / "x")) in events


def _xml(folder: Path) -> list[str]:
    path = folder / "deep.gkf"
    path.write_text("<gama-local>" * 1_000_000, "utf-8")
    return ["adjust", str(path)]


def _columns(folder: Path) -> list[str]:
    header = "seq,kind,value," + ",".join(f"c{k}" for k in range(100_000))
    book = folder / "observations" / "r1.csv"
    book.write_text(f"{header}\n1,note,{',' * 100_000}\n", "utf-8")
    return ["orient", str(folder)]


def _toml(folder: Path) -> list[str]:
    path = folder / "project.toml"
    path.write_text(path.read_text("utf-8") + "a." * 100_000 + "b = 1\n", "utf-8")
    return ["orient", str(folder)]


def _arrays(folder: Path) -> list[str]:
    path = folder / "project.toml"
    path.write_text(path.read_text("utf-8") + "x = " + "[" * 100_000 + "\n", "utf-8")
    return ["check", str(folder)]


def _problems(folder: Path) -> list[str]:
    path = folder / "project.toml"
    path.write_text(path.read_text("utf-8") + "[[station]]\n" * 30_000, "utf-8")
    return ["check", str(folder)]


def _zeros(folder: Path) -> list[str]:
    (folder / "observations" / "r1.csv").unlink()
    (folder / "observations" / "r1.csv").symlink_to("/dev/zero")
    return ["orient", str(folder)]


@pytest.mark.parametrize("make", [_xml, _columns, _toml, _arrays, _problems, _zeros])
def test_no_answer_takes_five_seconds_or_300_mb(
    make: Callable[[Path], list[str]], tmp_path: Path
) -> None:
    arguments = make(make_project(tmp_path / "p"))
    child = os.posix_spawn(
        sys.executable,
        [sys.executable, "-c", OWN_PEAK, str(tmp_path / "peak"), *arguments],
        os.environ,
        file_actions=[
            (os.POSIX_SPAWN_OPEN, fd, str(tmp_path / f"said{fd}"), os.O_WRONLY | os.O_CREAT, 0o600)
            for fd in (1, 2)
        ],
    )
    _, status, used = os.wait4(child, 0)
    said = (tmp_path / "said2").read_text("utf-8")
    assert os.waitstatus_to_exitcode(status) == 2, said
    assert "Traceback" not in said
    assert used.ru_utime + used.ru_stime < LONGEST_S
    assert float((tmp_path / "peak").read_text("utf-8")) < LARGEST_MB


def test_a_log_outside_is_packed_only_where_it_is_asked_for_and_pinned(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = tmp_path / "log.csv"
    log.write_text("time_s,tilt_along_arcsec\n0,1\n", "utf-8")
    folder = make_project(tmp_path / "p")
    path = folder / "project.toml"
    text = path.read_text("utf-8")
    entry = '\n[[sensor_log]]\nid = "l"\nkind = "tilt"\nfile = "../log.csv"\n'
    path.write_text(text + entry, "utf-8")
    zipped = tmp_path / "a.zip"
    made = api.export_zip(folder, zipped)
    assert [w.code for w in made.warnings] == ["logs_outside"]
    assert not [n for n in zipfile.ZipFile(zipped).namelist() if "log" in n]
    arguments = ["export", "zip", str(folder), str(zipped), "--allow-outside", "--json"]
    assert main(arguments) == 2
    assert "sha256" in json.loads(capsys.readouterr().out)["problems"][0]["expected"]
    digest = hashlib.sha256(log.read_bytes()).hexdigest()
    path.write_text(f'{text}{entry}sha256 = "{digest}"\n', "utf-8")
    assert main(arguments) == 0
    packed = zipfile.ZipFile(zipped)
    (name,) = [n for n in packed.namelist() if n.endswith("log.csv")]
    assert packed.read(name) == log.read_bytes()
    log.write_text("another", "utf-8")
    assert main(arguments) == 2
