"""All records of an instrument together: pooled runs, priors of an archive, what is refused."""

import dataclasses
import shutil
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from bench._records import Truth, problems
from surveyapp import api
from surveyapp.diagnosis import Case
from surveyapp.diagnosis.pooling import pool
from surveyapp.diagnosis.subjects.choice import determinations
from surveyapp.domain.priors import DEFAULT_PRIORS
from surveyapp.errors import SurveyError
from surveyapp.io.findings import Findings
from surveyapp.io.priors import parse_priors, priors_text
from surveyapp_models.angles import ARCSEC
from tests.cli.command import run


def runs(truth: Truth, count: int, seed: int) -> list[Case]:
    made, _ = problems(truth, count, seed)
    return [dataclasses.replace(c, sigma=np.full(c.size, 4.0 * ARCSEC)) for c in made]


def test_a_warm_up_that_one_run_does_not_show_is_named_from_eight() -> None:
    truth = Truth("warm-up", 8, warm_up=40.0, one_sign=True)
    one = sum(pool(runs(truth, 1, s), np.random.default_rng(s)).named is not None for s in range(8))
    found = [pool(runs(truth, 8, s), np.random.default_rng(s)).named for s in range(4)]
    named = [item for item in found if item is not None and item.effect == "warm_up"]
    # .99 of eight runs and .18 of one are named in the reference
    assert len(named) >= 3
    assert one <= stats.binom.ppf(0.999, 8, 0.18)
    for item in named:
        assert item.coefficient is not None
        assert item.sessions == 8
        assert -90.0 < item.coefficient * np.sign(item.coefficient) - 40.0 < 60.0


def test_a_walk_is_not_named_however_many_runs_there_are() -> None:
    truth = Truth("walk", 8, walk=9.0)
    for count in (2, 8):
        found = [pool(runs(truth, count, s), np.random.default_rng(s)).named for s in range(6)]
        assert sum(item is not None for item in found) <= stats.binom.ppf(0.999, 6, 0.05)


def test_what_changes_once_in_each_run_is_no_effect_of_the_instrument() -> None:
    """Damping that changes somewhere in eight runs looks like dry friction: nothing is named."""
    truth = Truth("damping", 8, "damping_break", damping_change=0.002, one_sign=True)
    for seed in range(3):
        found = pool(runs(truth, 8, seed), np.random.default_rng(seed))
        assert found.named is None
        best = max(found.effects, key=lambda item: item.evidence)
        assert best.effect == "damping_break"
        assert best.p is None  # its place is that of each run: pooling names it not


def test_a_drift_that_all_runs_share_is_named() -> None:
    truth = Truth("drift", 8, "midpoint_drift", drift=3.0, one_sign=True)
    found = [pool(runs(truth, 8, s), np.random.default_rng(s)).named for s in range(8)]
    named = [item for item in found if item is not None]
    # .53 of such sets are named in the reference
    assert len(named) >= stats.binom.ppf(0.01, 8, 0.53) > 0
    for item in named:
        assert item.effect == "midpoint_drift"
        assert item.coefficient is not None
        assert item.sigma is not None
        assert abs(item.coefficient - 3.0) < 4.0 * item.sigma


@pytest.fixture(scope="module")
def archive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("archive")
    for seed in range(3):
        api.simulate("campaign", folder / f"c{seed}", effects=["temperature=1.5"], seed=seed)
    return folder


def test_an_archive_teaches_priors_that_a_project_then_uses(archive: Path, tmp_path: Path) -> None:
    project = shutil.copytree(archive / "c0", tmp_path / "p")
    before = api.orient(project)
    with ThreadPoolExecutor(2) as executor:
        found = api.diagnose_instrument(
            project, "G1", archive=[archive], priors=project / "priors.toml", executor=executor
        )
    assert found.priors is not None
    assert found.campaigns == 4  # the copy is another folder
    assert found.priors.share("temperature") > 2.0 * DEFAULT_PRIORS.share("temperature")
    text = (project / "project.toml").read_text(encoding="utf-8")
    text = text.replace("serial =", 'priors = "priors.toml"\nserial =', 1)
    (project / "project.toml").write_text(text, encoding="utf-8")
    after = api.orient(project)
    assert api.open_project(project).instruments[0].priors is not None
    assert after.lines[0].constant != before.lines[0].constant
    assert after.lines[0].constant_choice == "predicted"


def test_the_archive_tells_by_how_much_the_constant_scatters(archive: Path) -> None:
    """The constant followed the temperature by 1.5" per kelvin: that is what scatters."""
    found = api.diagnose_instrument(archive / "c0", "G1", archive=[archive]).priors
    assert found is not None
    assert found.scatter is not None
    text = priors_text(found, instrument="G1", serial="", software="test")
    again = parse_priors(text.encode(), "priors.toml", Findings())
    assert again is not None
    assert again.scatter == pytest.approx(found.scatter, abs=0.001 * ARCSEC)
    deviations = []
    for seed in range(3):
        constants = determinations(api.compute(archive / f"c{seed}").orientation, "G1")
        values = np.array([item.value for item in constants])
        stated = float(np.mean([(item.sigma or 0.0) ** 2 for item in constants]))
        deviations.append(max(float(values.var(ddof=1)) - stated, 0.0))
    assert found.scatter == pytest.approx(float(np.sqrt(np.mean(deviations))), rel=0.15)


def test_two_determinations_take_the_scatter_of_the_archive(tmp_path: Path) -> None:
    project = tmp_path / "p"
    api.simulate("reversal-run", project, seed=3)
    before = api.orient(project).lines[0].constant_sigma_arcsec
    priors = dataclasses.replace(DEFAULT_PRIORS, scatter=20.0 * ARCSEC, sessions=40)
    text = priors_text(priors, instrument="G1", serial="", software="test")
    (project / "priors.toml").write_text(text, encoding="utf-8")
    toml = (project / "project.toml").read_text(encoding="utf-8")
    toml = toml.replace("serial =", 'priors = "priors.toml"\nserial =', 1)
    (project / "project.toml").write_text(toml, encoding="utf-8")
    line = api.orient(project).lines[0]
    assert before is not None
    sigma = line.constant_sigma_arcsec
    assert sigma is not None
    assert sigma**2 == pytest.approx(before**2 + 20.0**2 * 1.5, rel=1e-6)
    assert "constant: scatter in the archive" in {item.source for item in line.budget}
    (project / "priors.toml").write_text(
        text.replace("scatter_arcsec = 20.0", 'scatter_arcsec = "wide"'), encoding="utf-8"
    )
    answer = run("orient", str(project))
    assert answer.code == 2
    assert "scatter_arcsec is no number" in answer.err


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("format = 2", "no priors file"),
        ("[[[", "no valid TOML"),
        (
            'format = 1\nkind = "priors of the instrument constant"\n[shares]\nbase = 0.5\n'
            'drft = 0.5\n[sizes]\n"0.7" = 2',
            "drift",
        ),
    ],
)
def test_a_faulty_priors_file_is_told(archive: Path, tmp_path: Path, text: str, told: str) -> None:
    project = shutil.copytree(archive / "c1", tmp_path / "p")
    (project / "priors.toml").write_text(text, encoding="utf-8")
    toml = (project / "project.toml").read_text(encoding="utf-8")
    toml = toml.replace("serial =", 'priors = "priors.toml"\nserial =', 1)
    (project / "project.toml").write_text(toml, encoding="utf-8")
    answer = run("orient", str(project))
    assert answer.code == 2
    assert told in answer.err


def test_what_cannot_be_pooled_is_refused(archive: Path, tmp_path: Path) -> None:
    other = shutil.copytree(archive / "c2", tmp_path / "other")
    text = (other / "project.toml").read_text(encoding="utf-8")
    text = text.replace('serial = "simulated"', 'serial = "another one"')
    (other / "project.toml").write_text(text, encoding="utf-8")
    found = api.diagnose_instrument(archive / "c0", "G1", archive=[other])
    assert found.projects == 1
    assert [w.code for w in found.warnings] == ["other_instrument"]
    empty = tmp_path / "empty"
    empty.mkdir()
    with pytest.raises(SurveyError, match="archive without projects"):
        api.diagnose_instrument(archive / "c0", "G1", archive=[empty])
    for words in (
        ["--instrument", "G2"],
        ["--instrument", "G1", "--adopt"],
        ["--campaign", "G1", "--archive", str(archive)],
    ):
        answer = run("diagnose", str(archive / "c0"), *words)
        assert answer.code == 2, words
        assert "Traceback" not in answer.err


def test_the_pooled_result_has_its_keys(archive: Path) -> None:
    found = api.diagnose_instrument(archive / "c0", "G1").to_dict()
    assert found["schema"] == "surveyapp.diagnose/1"
    assert set(found) >= {"subject", "verdict", "pooled", "priors", "words", "warnings"}
    diagnosis = api.diagnose(archive / "c0", campaign="G1", log=False).to_dict()
    assert diagnosis["pooled"] is None
    held = diagnosis["prediction"]
    assert set(held["before"]) == {"rms", "coverage", "interval95_arcsec"}
    assert held["after"]["rms"] < held["before"]["rms"]
    assert diagnosis["actions"]
    best = diagnosis["actions"][0]
    assert set(best) == {"action", "text", "separation", "information", "interval95_arcsec"}
    gains = [item["information"] for item in diagnosis["actions"]]
    assert gains == sorted(gains, reverse=True)
