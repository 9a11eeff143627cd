"""A ratio to the peer is printed only where it has adjusted the same network."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from bench import _gama
from bench.network import network, with_plain_azimuths
from surveyapp.core.network import adjust
from surveyapp.io.exporters.gkf import write_gkf
from surveyapp.io.importers.gkf import read_gkf

HEAD = '<?xml version="1.0"?>\n<gama-local-adjustment xmlns="http://www.gnu.org/software/gama/'
HEAD += 'gama-local-adjustment">\n'
ERROR = (
    HEAD + '<error category="gamaLocalApproximateCoordinates">\n<description>No points available '
    "for adjustment</description>\n<lineNumber>0</lineNumber>\n</error>\n</gama-local-adjustment>\n"
)
ADJUSTED = (
    HEAD + "<network-processing-summary><project-equations><equations>9</equations>\n"
    "<degrees-of-freedom>{dof}</degrees-of-freedom></project-equations><standard-deviation>\n"
    "<apriori>1.0e+00</apriori><aposteriori>{sigma0:.7e}</aposteriori></standard-deviation>\n"
    "</network-processing-summary></gama-local-adjustment>\n"
)
SAME = _gama.Expected(57, 1.0042)
ANSWERS = [
    (ERROR, 0, "it ended in an error (gamaLocalApproximateCoordinates: No points available"),
    (ADJUSTED.format(dof=57, sigma0=1.0042), 0, ""),
    (ADJUSTED.format(dof=57, sigma0=1.0042), 3, "exit code 3: no word"),
    (ADJUSTED.format(dof=50, sigma0=1.0042), 0, "another network (50 degrees of freedom, ours 57)"),
    (ADJUSTED.format(dof=57, sigma0=1.4), 0, "another result (sigma 0 1.4, ours 1.0042)"),
    (HEAD + "</gama-local-adjustment>", 0, "holds no adjustment (no degrees-of-freedom)"),
    ("", 0, "cannot be read"),
]


@pytest.fixture
def peer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A program of the peer's name that writes ``answer.xml`` and ends with the code beside it."""
    program = tmp_path / _gama.PROGRAM
    program.write_text(
        f"#!{sys.executable}\nimport pathlib, shutil, sys\n"
        f"here = pathlib.Path({str(tmp_path)!r})\n"
        "shutil.copy(here / 'answer.xml', sys.argv[sys.argv.index('--xml') + 1])\n"
        "sys.exit(int((here / 'code').read_text()))\n",
        encoding="utf-8",
    )
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    return tmp_path


@pytest.mark.parametrize(("answer", "code", "told"), ANSWERS)
def test_what_the_peer_answered_is_looked_at(peer: Path, answer: str, code: int, told: str) -> None:
    (peer / "answer.xml").write_text(answer, encoding="utf-8")
    (peer / "code").write_text(str(code), encoding="utf-8")
    found = _gama.adjusted(peer / "net.gkf", SAME)
    assert told in found.refused
    assert bool(told) == bool(found.refused)
    line = _gama.compared(peer / "net.gkf", 0.1, SAME)
    assert ("ratio" in line.replace("no ratio", "")) == (not told)


def test_an_answer_of_another_run_is_not_taken(peer: Path) -> None:
    (peer / "net.out.xml").write_text(ADJUSTED.format(dof=57, sigma0=1.0042), encoding="utf-8")
    (peer / _gama.PROGRAM).write_text("#!/bin/sh\nexit 0\n", encoding="utf-8")
    assert "cannot be read" in _gama.adjusted(peer / "net.gkf", SAME).refused


def test_without_the_peer_there_is_no_ratio(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    assert "is not on the PATH" in _gama.compared(tmp_path / "net.gkf", 1.0, SAME)


@pytest.mark.parametrize("branched", [False, True])
def test_approximate_coordinates_change_no_result(tmp_path: Path, *, branched: bool) -> None:
    found = []
    for near in (False, True):
        net = network(60, branched=branched, near=near)
        assert (net.points[-1].e is not None) == near
        write_gkf(with_plain_azimuths(net), tmp_path / "net.gkf")
        found.append(adjust(read_gkf(tmp_path / "net.gkf")))
    without, given = found
    assert without.dof == given.dof
    for a, b in zip(without.points, given.points, strict=True):
        assert a.e == pytest.approx(b.e, abs=1e-6)
        assert a.n == pytest.approx(b.n, abs=1e-6)
