"""What is adopted: the same in any company, written whole or not at all, told when doubtful."""

from __future__ import annotations

import json
import math
import re
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path

import filelock
import numpy as np
import pytest

from surveyapp import api
from surveyapp.cli.main import main
from surveyapp.core.simulate.campaign import CAMPAIGN_EFFECTS
from surveyapp.errors import SurveyError
from surveyapp.io.filing import ledger as ledger_module

KNOWN = 'serial = "SIM-0001"\nconstant = { arcsec = 40.0, sigma_arcsec = 1.0 }\n'


def adopted_campaign(folder: Path, effect: str = "temperature=1.5", seed: int = 3) -> Path:
    """A campaign whose effect was found and adopted."""
    api.simulate("campaign", folder, effects=[effect], seed=seed)
    found = api.diagnose(folder, campaign="G1", adopt=True)
    assert len(found.written) == 1, (effect, found.written)
    return folder


@pytest.fixture(scope="module")
def temperature(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return adopted_campaign(tmp_path_factory.mktemp("adopted") / "temperature")


def copy(folder: Path, to: Path) -> Path:
    shutil.copytree(folder, to)
    return to


def edit(folder: Path, change: Callable[[str], str]) -> Path:
    """Change project.toml by hand."""
    path = folder / "project.toml"
    text = change(path.read_text(encoding="utf-8"))
    assert text != path.read_text(encoding="utf-8"), "the edit did nothing"
    path.write_text(text, encoding="utf-8")
    return folder


def tables(text: str) -> tuple[str, list[str]]:
    """What stands before the sessions, and each session with its header."""
    head, *sessions = re.split(r"(?=^\[\[orientation\]\])", text, flags=re.MULTILINE)
    return head, sessions


def keep(wanted: Callable[[str], bool]) -> Callable[[str], str]:
    """Keep the sessions whose id is wanted."""

    def change(text: str) -> str:
        head, sessions = tables(text)
        chosen = [s for s in sessions if wanted(re.findall(r'^id = "(.*)"', s, re.MULTILINE)[0])]
        return head + "".join(chosen)

    return change


def with_known_constant(text: str) -> str:
    choice = KNOWN + 'constant_choice = "known"\n'
    return re.sub(r'^serial = ".*"\n', choice, text, count=1, flags=re.MULTILINE)


def azimuths(folder: Path) -> dict[str, float]:
    """Seconds of the true azimuth of each survey session by itself."""
    names = [s.id for s in api.open_project(folder).sessions if s.purpose == "survey"]
    found = {}
    for name in names:
        (line,) = api.orient(folder, session=name).lines
        assert line.true_azimuth is not None
        found[name] = math.degrees(line.true_azimuth.value) * 3600.0
    return found


def codes(folder: Path) -> list[str]:
    return [warning.code for warning in api.orient(folder).warnings]


@pytest.mark.parametrize(
    "effect", ["temperature=1.5", "latitude=150", "time_drift=0.3", "transport_step=60"]
)
def test_other_sessions_do_not_move_a_survey_with_a_known_constant(
    tmp_path: Path, effect: str
) -> None:
    folder = adopted_campaign(tmp_path / "all", effect)
    edit(folder, with_known_constant)
    before = azimuths(folder)
    alone = copy(folder, tmp_path / "alone")
    edit(alone, keep(lambda name: name == "later-01"))
    assert azimuths(alone) == {"later-01": before["later-01"]}
    fewer = copy(folder, tmp_path / "fewer")
    edit(fewer, keep(lambda name: name.startswith("later") or name > "det-025"))
    assert azimuths(fewer) == before
    assert "adopted_data_changed" in codes(fewer)
    assert "adopted_data_changed" not in codes(alone)  # none of them is there


def test_pooled_and_known_constants_are_those_at_the_reference(
    tmp_path: Path, temperature: Path
) -> None:
    folder = copy(temperature, tmp_path / "p")
    project = api.open_project(folder)
    (effect,) = project.instruments[0].effects
    assert effect.reference == (("temperature_c", 12.0),)  # reference_temperature_c of the sessions
    edit(folder, lambda text: text.replace("serial =", 'constant_choice = "pooled"\nserial =', 1))
    pooled = api.orient(folder).constants[0]
    assert pooled.value is not None
    pooled_line = azimuths(folder)["later-01"]
    value = math.degrees(pooled.value) * 3600.0
    edit(folder, lambda text: text.replace('constant_choice = "pooled"\n', "", 1))
    edit(folder, with_known_constant)
    edit(folder, lambda text: text.replace("arcsec = 40.0", f"arcsec = {value!r}"))
    assert azimuths(folder)["later-01"] == pytest.approx(pooled_line, abs=1e-5)
    (told,) = [w for w in api.orient(folder).warnings if w.code == "known_constant_at_reference"]
    assert "temperature_c 12" in told.text


def test_an_old_table_without_reference_works_as_before_and_says_so(
    tmp_path: Path, temperature: Path
) -> None:
    folder = copy(temperature, tmp_path / "p")
    before = azimuths(folder)
    edit(folder, lambda text: re.sub(r"^(reference =|sessions =).*\n", "", text, flags=re.M))
    # with a pooled constant the datum drops out
    assert azimuths(folder) == pytest.approx(before, abs=1e-5)
    assert "adopted_without_reference" in codes(folder)


@pytest.mark.statistical
def test_the_interval_after_adoption_covers_the_azimuth(tmp_path: Path) -> None:
    inside: dict[str, list[bool]] = {"pooled": [], "known": []}
    for seed in range(100, 114):
        folder = tmp_path / str(seed)
        api.simulate("campaign", folder, effects=["temperature=1.5"], seed=seed)
        if not api.diagnose(folder, campaign="G1", adopt=True, log=False).written:
            continue
        truth = json.loads((folder / "truth.json").read_text())
        azimuth = truth["sessions"]["later-01"]["azimuth_deg"]
        for choice in inside:
            if choice == "known":  # the true one, stated with a sigma that it was drawn with
                off = float(np.random.default_rng(seed).normal(0.0, 1.0))
                edit(folder, with_known_constant)
                edit(folder, lambda t, c=off: t.replace("= 40.0", f"= {40.0 + c:.4f}"))  # type: ignore[misc]
            line = api.orient(folder).lines[0].to_dict()["grid_azimuth"]
            error = abs((line["deg"] - azimuth + 180.0) % 360.0 - 180.0) * 3600.0
            inside[choice].append(error <= line["interval95_arcsec"])
    for choice, hits in inside.items():
        assert len(hits) >= 11
        # 95 %: 4 or more misses of 14 have a probability of 0.004
        assert hits.count(False) <= 3, choice


def test_a_line_that_stands_off_does_not_move_a_survey_of_it(tmp_path: Path) -> None:
    folder = tmp_path / "p"
    api.simulate("campaign", folder, effects=["line_offset=60,line=1"], seed=3)
    (offset,) = [e for e in CAMPAIGN_EFFECTS if e.id == "line_offset"]
    assert "known azimuth" in offset.meaning
    # a survey of a calibration line: its first determination observed once more
    head, sessions = tables((folder / "project.toml").read_text(encoding="utf-8"))
    calibrations = [s for s in sessions if 'purpose = "calibration"' in s]

    def survey(session: str) -> str:
        text = re.sub(r'^id = "(.*)"', r'id = "again-\1"', session, flags=re.MULTILINE)
        text = re.sub(r"^azimuth_known.*\n", "", text, flags=re.MULTILINE)
        return text.replace('purpose = "calibration"', 'purpose = "survey"')

    text = head + "".join(sessions) + "\n" + "\n".join(survey(s) for s in calibrations)
    (folder / "project.toml").write_text(text, encoding="utf-8")
    gyro = {s.id: s.targets[0].gyro_azimuth for s in api.orient(folder).sessions}
    assert api.diagnose(folder, campaign="G1", adopt=True).written
    (effect,) = api.open_project(folder).instruments[0].effects
    assert effect.id == "line_offset"
    name = str(dict(effect.grid)["line"])
    result = api.orient(folder)
    for line in result.lines:
        if line.sessions[0].startswith("again") and f"{line.station}-{line.target}" == name:
            break
    told, measured = line.to_dict(), gyro[line.sessions[0]]
    assert measured is not None
    # gyro azimuths of all rounds and the constant, and no 60 arcsec more
    moved = told["true_azimuth"]["deg"] - math.degrees(measured.value)
    moved = moved * 3600.0 - told["constant"]["arcsec"]
    assert abs((moved + 648000.0) % 1296000.0 - 648000.0) < 15.0
    (warning,) = [w for w in result.warnings if w.code == "line_not_moved"]
    assert name in warning.text


@pytest.mark.parametrize(
    ("pattern", "text", "message"),
    [
        ("arcsec/K", "deg/K", "unit.*found deg/K; expected arcsec/K"),
        ("{ coefficient =", "{ koeff =", "do not fit it; found koeff; expected coefficient"),
        (r"value = [-\d.]+", "value = 1e6", "plausible range.*-10 to 10"),
        (r"sigma = [\d.]+", "sigma = 0.0", "no sigma"),
        (r"sigma = [\d.]+", "sigma = 1.0", "contradict each other"),
        (r"covariance = .*", "covariance = [[-1.0]]", "not positive"),
        (r"valid = .*", "valid = { latitude = [0.1, 0.2] }", "of no column of it"),
        (r"reference = .*", "reference = { latitude = 0.7 }", "reference.*does not fit"),
        (r"reference = .*", "grid = { tau_s = 3.0 }", "grid.*does not fit"),
        ('id = "temperature"', 'id = "temprature"', "in no catalogue.*Did you mean temperature"),
    ],
)
def test_an_adopted_table_that_no_longer_fits_is_refused(
    tmp_path: Path, temperature: Path, pattern: str, text: str, *, message: str
) -> None:
    folder = copy(temperature, tmp_path / "p")
    edit(folder, lambda old: re.sub(pattern, text, old, count=1))
    for command in (api.orient, lambda f: api.diagnose(f, campaign="G1")):
        with pytest.raises(SurveyError, match=message):
            command(folder)


def test_an_asymmetric_covariance_and_a_missing_grid_are_refused(tmp_path: Path) -> None:
    folder = adopted_campaign(tmp_path / "p", "circle_eccentricity=25,phase=40")
    other = copy(folder, tmp_path / "q")
    edit(folder, lambda t: re.sub(r"(covariance = \[\[[^,]*, )[^\]]*", r"\g<1>9.0", t))
    with pytest.raises(SurveyError, match="not symmetric"):
        api.orient(folder)
    step = adopted_campaign(tmp_path / "step", "transport_step=60")
    edit(step, lambda t: re.sub(r"^grid = .*\n", "", t, flags=re.MULTILINE))
    with pytest.raises(SurveyError, match="found no grid; expected after_day"):
        api.orient(step)
    assert "effect_range_unknown" not in codes(other)


def test_an_effect_that_stands_twice_is_refused(tmp_path: Path, temperature: Path) -> None:
    folder = copy(temperature, tmp_path / "p")
    table = re.compile(r"^\[\[instrument\.effect\]\]\n(?:.+\n)*", re.MULTILINE)
    edit(folder, lambda t: table.sub(lambda m: f"{m[0]}\n{m[0]}", t))
    with pytest.raises(SurveyError, match="adopted twice"):
        api.orient(folder)


def test_without_a_range_nothing_is_corrected_and_the_effect_enters_the_sigma(
    tmp_path: Path, temperature: Path
) -> None:
    folder = copy(temperature, tmp_path / "p")
    before = api.orient(folder, session="later-01").lines[0]
    measured = api.orient(folder, session="later-01").sessions[0].targets[0].gyro_azimuth
    assert measured is not None
    ungated = measured.value
    edit(folder, lambda t: re.sub(r"^valid = .*\n", "", t, flags=re.MULTILINE))
    result = api.orient(folder, session="later-01")
    budget = {item.source: item.sigma for item in result.lines[0].budget}
    # what the effect may have done between calibrations and survey, some kelvin at 1.5 arcsec
    assert budget["adopted effect outside its range"] > math.radians(2.0 / 3600.0)
    assert result.lines[0].gyro_azimuth.value == pytest.approx(ungated, abs=1e-12)
    assert before.true_azimuth is not None
    assert result.lines[0].true_azimuth is not None
    assert result.lines[0].true_azimuth.sigma > before.true_azimuth.sigma
    told = [w for w in result.warnings if w.code == "effect_range_unknown"]
    assert len(told) == 1
    assert "temperature_c" in told[0].text


def test_changed_data_are_told(tmp_path: Path, temperature: Path) -> None:
    folder = copy(temperature, tmp_path / "p")
    assert "adopted_data_changed" not in codes(folder)
    edit(folder, lambda t: t.replace("[[orientation]]", "# a comment\n[[orientation]]", 1))
    assert "adopted_data_changed" not in codes(folder)
    book = folder / "observations" / "det-007.csv"
    book.write_text(
        re.sub(r",north,(\d+)-(\d+)-(\d)", r",north,\1-\2-0", book.read_text(), count=1)
    )
    assert "adopted_data_changed" in codes(folder)


def test_changed_data_of_a_run_are_told(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    api.simulate("reversal-run", folder, effects=["midpoint_step=40,at=0.5"], seed=6)
    api.diagnose(folder, session="run-1", confirm="run-2", adopt=True)
    assert "adopted_data_changed" not in codes(folder)
    book = folder / "observations" / "run-1.csv"
    lines = book.read_text().splitlines()
    last = max(i for i, line in enumerate(lines) if ",reversal," in line)
    del lines[last]
    book.write_text("\n".join(lines) + "\n")
    assert "adopted_data_changed" in codes(folder)


def test_outside_its_range_what_is_said_of_the_sigma_is_true(tmp_path: Path) -> None:
    folder = adopted_campaign(tmp_path / "p", "transport_step=60")
    texts = [w.text for w in api.orient(folder).warnings if w.code == "effect_outside_range"]
    assert texts
    assert all("the sigma stays" in text for text in texts)
    budget = api.orient(folder).lines[0].to_dict()["budget"]
    assert not [item for item in budget if "outside" in item["source"]]


def test_a_missing_temperature_is_told_in_words(tmp_path: Path, temperature: Path) -> None:
    folder = copy(temperature, tmp_path / "p")
    for book in (folder / "observations").glob("later-*.csv"):
        head, *rows = book.read_text().splitlines()
        place = head.split(",").index("temperature_c")
        cells = [row.split(",") for row in rows]
        book.write_text(
            "\n".join([head, *(",".join([*c[:place], "", *c[place + 1 :]]) for c in cells)]) + "\n"
        )
    result = api.orient(folder)
    (text, *_) = [w.text for w in result.warnings if w.code == "effect_outside_range"]
    assert "later-01: temperature_c missing: the adopted effect temperature is taken as at" in text
    # the largest effect of the range: 1.5 arcsec/K from -3.9 to 12
    (line,) = api.orient(folder, session="later-01").lines
    assert line.true_azimuth is not None
    assert line.true_azimuth.sigma == pytest.approx(math.radians(1.516 * 15.9 / 3600), rel=0.05)


def test_adopting_again_says_why_nothing_is_written(tmp_path: Path, temperature: Path) -> None:
    folder = copy(temperature, tmp_path / "p")
    text = (folder / "project.toml").read_bytes()
    found = api.diagnose(folder, campaign="G1", adopt=True)
    assert found.written == ()
    (refused,) = found.to_dict()["not_written"]
    assert refused["effect"] == "temperature"
    assert "already adopted by G1" in refused["reason"]
    assert any("Not written: temperature" in word for word in found.words)
    assert (folder / "project.toml").read_bytes() == text


def test_a_run_with_an_adopted_effect_says_so_when_it_is_diagnosed_again(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    api.simulate("reversal-run", folder, effects=["midpoint_step=40,at=0.5"], seed=6)
    api.diagnose(folder, session="run-1", confirm="run-2", adopt=True)
    found = api.diagnose(folder, session="run-1", adopt=True)
    assert found.diagnosis is not None
    assert "already_adopted" in [w.code for w in found.diagnosis.warnings]
    assert "adopted midpoint_step already" in found.words[0]
    assert "already adopted by run-1" in found.not_written[0].reason
    assert api.diagnose(folder, session="run-2").to_dict()["not_written"] == []


def test_several_gross_errors_are_adopted_and_used(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    api.simulate("reversal-run", folder, effects=["gross_error=200,count=2"], seed=1)
    truth = json.loads((folder / "truth.json").read_text())["sessions"]["run-1"]
    assert api.diagnose(folder, session="run-1", adopt=True).written
    (effect,) = api.open_project(folder).session("run-1").effects
    assert [name for name, *_ in effect.coefficients] == ["error_1", "error_2"]
    assert [name for name, _ in effect.grid] == ["point_1", "point_2"]
    north = api.orient(folder, session="run-1").sessions[0].gyro_north
    assert north is not None
    error = (math.degrees(north.value) - truth["run_mean_north_deg"]) * 3600.0
    assert abs(error) < 4.0 * math.degrees(north.sigma) * 3600.0


def test_an_effect_of_ones_own_is_not_adopted(tmp_path: Path) -> None:
    folder = tmp_path / "p"
    api.simulate("campaign", folder, effects=["temperature=1.5"], seed=3)
    own = tmp_path / "own.py"
    guide = (Path(__file__).resolve().parents[2] / "docs/how-to/add-your-own-effect.md").read_text()
    code = guide.split("```python\n")[1].split("```")[0]
    own.write_text(code.replace("(theta - theta.mean()) ** 2", "theta - theta.mean()"))
    text = (folder / "project.toml").read_bytes()
    found = api.diagnose(folder, campaign="G1", effects=own, adopt=True)
    if "temperature_squared" in [item.effect for item in found.not_written]:
        assert "your own" in found.not_written[0].reason
    assert "temperature_squared" not in (folder / "project.toml").read_text()
    assert found.written or (folder / "project.toml").read_bytes() == text


class Refusal:
    """A system that refuses to write."""

    def __call__(self, *_: object, **__: object) -> None:
        raise OSError(30, "Read-only file system")


@pytest.mark.parametrize("what", ["lock", "project", "ledger"])
def test_adopting_where_nothing_can_be_written_is_refused_and_leaves_no_trace(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    what: str,
) -> None:
    folder = tmp_path / "p"
    api.simulate("campaign", folder, effects=["temperature=1.5"], seed=3)
    before = {p.name: p.read_bytes() for p in folder.rglob("*") if p.is_file()}
    if what == "lock":
        monkeypatch.setattr(filelock.FileLock, "acquire", Refusal())
    elif what == "project":
        monkeypatch.setattr(tempfile, "mkstemp", Refusal())
    else:
        monkeypatch.setattr(ledger_module, "_append", Refusal())
    assert main(["diagnose", str(folder), "--campaign", "G1", "--adopt", "--json"]) == 2
    (problem,) = json.loads(capsys.readouterr().out)["problems"]
    assert "written" in problem["what"]
    after = {p.name: p.read_bytes() for p in folder.rglob("*") if p.is_file()}
    after.pop(".surveyapp.lock", None)
    assert after == before
    # without --adopt the diagnosis itself is not lost
    assert main(["diagnose", str(folder), "--campaign", "G1", "--json"]) == 0
    told = [w["code"] for w in json.loads(capsys.readouterr().out)["warnings"]]
    assert ("ledger_not_written" in told) == (what == "ledger")


def test_the_order_of_the_tables_moves_no_p_value(tmp_path: Path) -> None:
    folder = tmp_path / "p"
    api.simulate("campaign", folder, effects=["temperature=0.8"], seed=4)
    before = api.diagnose(folder, campaign="G1", log=False).to_dict()

    def shuffled(text: str) -> str:
        head, sessions = tables(text.rstrip() + "\n\n")
        order = np.random.default_rng(1).permutation(len(sessions))
        return head + "".join(sessions[i] for i in order)

    edit(folder, shuffled)
    assert api.diagnose(folder, campaign="G1", log=False).to_dict() == before


def test_an_empty_project_is_told_what_a_diagnosis_needs(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "project.toml").write_text('format = 1\nname = "x"\n')
    assert main(["diagnose", str(tmp_path)]) == 0
    assert "Nothing in this project can be diagnosed" in capsys.readouterr().out
    assert main(["diagnose", str(tmp_path), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["subjects"] == []
    assert "turning points" in found["words"][0]
    assert main(["diagnose", str(tmp_path), "--adopt", "--json"]) == 2


def test_the_table_of_candidates_says_why_one_is_not_applicable(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "run"
    api.simulate("reversal-run", folder, seed=1)
    book = folder / "observations" / "run-1.csv"
    head, *rows = book.read_text().splitlines()
    place, gaps = head.split(",").index("temperature_c"), 0
    for i, row in enumerate(rows):
        cells = row.split(",")
        if ",reversal," in row and gaps < 3:
            cells[place], gaps = "", gaps + 1
        rows[i] = ",".join(cells)
    book.write_text("\n".join([head, *rows]) + "\n")
    assert main(["diagnose", str(folder), "--session", "run-1"]) == 0
    text = " ".join(capsys.readouterr().out.split())
    assert "not applicable: temperature: temperature_c missing at 3 of" in text
