"""What the pages show is what the commands print; what they link to exists.

A block ``console`` holds commands after ``$`` and their output, with ``...`` where lines are left
out. A block ``toml`` or ``csv`` below a line that ends in a path between backticks and a colon is
a file of the example.
"""

import re
import shlex
from pathlib import Path

import pytest

from tests.cli.command import run

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
NAMED = re.compile(r"`([^`\n]+)`:\n\n$")
LINK = re.compile(r"\]\(([^)#\s]+)(?:#[^)]*)?\)")


def with_examples() -> list[Path]:
    return [page for page in PAGES if "```console\n" in page.read_text(encoding="utf-8")]


def page_id(page: Path) -> str:
    return str(page.relative_to(ROOT))


@pytest.mark.parametrize("page", with_examples(), ids=page_id)
def test_examples_print_what_the_page_shows(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "projects").symlink_to(ROOT / "projects")
    monkeypatch.chdir(tmp_path)
    text = page.read_text(encoding="utf-8")
    shown = 0
    for block in BLOCK.finditer(text):
        kind, body = block.groups()
        named = NAMED.search(text[: block.start()])
        if kind == "console":
            shown += check_console(body)
        elif kind in ("toml", "csv", "text") and named:
            path = tmp_path / named.group(1)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(body, encoding="utf-8")
    assert shown


def check_console(body: str) -> int:
    """Run every ``$ surveyapp ...`` of a block and look for its output in order."""
    parts = re.split(r"^\$ (.*)\n", body, flags=re.MULTILINE)[1:]
    for command, expected in zip(parts[::2], parts[1::2], strict=True):
        words = shlex.split(command)
        assert words[0] == "surveyapp", command
        answer = run(*words[1:])
        assert answer.code in (0, 1, 2), answer
        whole = answer.out + answer.err
        for piece in re.split(r"^\.\.\.\n", expected, flags=re.MULTILINE):
            assert piece in whole, f"$ {command}\n{piece}\n--- printed:\n{whole}"
            whole = whole[whole.index(piece) + len(piece) :]
        if not re.search(r"^\.\.\.$", expected, re.MULTILINE):
            assert whole == "", command
    return len(parts) // 2


@pytest.mark.parametrize("page", PAGES, ids=page_id)
def test_links_lead_somewhere(page: Path) -> None:
    for target in LINK.findall(page.read_text(encoding="utf-8")):
        if "://" not in target:
            assert (page.parent / target).exists(), f"{page_id(page)}: {target}"


def test_every_page_can_be_reached_from_the_readme() -> None:
    seen: set[Path] = set()
    todo = [ROOT / "README.md"]
    while todo:
        page = todo.pop().resolve()
        if page in seen or not page.exists():
            continue
        if page.is_dir():
            todo += page.rglob("*.md")
            continue
        seen.add(page)
        if page.suffix == ".md":
            links = LINK.findall(page.read_text(encoding="utf-8"))
            todo += [page.parent / target for target in links if "://" not in target]
    assert {page.resolve() for page in PAGES} <= seen
