"""Mutated projects through the whole ``orient`` command: never a traceback, never an exit 3."""

import re
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from hypothesis import given, seed, settings
from hypothesis import strategies as st

from surveyapp.core.simulate.kinds import simulate_kind
from surveyapp.core.simulate.project import project_files, simulate_reversal_project
from surveyapp.core.simulate.specification import SessionSpec
from tests.cli.command import GOOD_BOOK, GOOD_TOML, run
from tests.cli.test_json_contract import ORIENT, conform, walk
from tests.io.test_mutated_projects import ACCIDENTS, VALID, Accident, at, mutate

PROJECTS = Path(__file__).parents[2] / "projects"
NUMBERS = (
    "0", "-0.0", "1", "-1", "1e-12", "1e-300", "1e300", "0.5", "3", "90", "-90", "180", "359.9999",
    "360", "400", "89.9999", "75", "1000000", "-5000000", "2147483648", "0.1", "1e5", "12.5",
)  # fmt: skip
ANGLES = ("0-00-00", "179-59-59.9", "180-00-00", "359-59-59.9", "90-00-00", "270-00-01", "45-00-00")
DIGITS = re.compile(rb"-?\d+(?:\.\d+)?")
DMS = re.compile(rb"\d+-\d\d-\d\d(?:\.\d+)?")


def sample(name: str) -> dict[str, str]:
    folder = PROJECTS / name
    files = [folder / "project.toml", *sorted((folder / "observations").glob("*.csv"))]
    return {str(f.relative_to(folder)): f.read_text(encoding="utf-8") for f in files}


def swing(method: str) -> dict[str, str]:
    spec = SessionSpec(method=method, points=6)  # type: ignore[arg-type]
    return project_files(simulate_reversal_project(spec, np.random.default_rng(3)))


BASES: dict[str, dict[str, str]] = {
    "reader's": VALID,
    "tracking": {"project.toml": GOOD_TOML, "observations/run.csv": GOOD_BOOK},
    "automatic": sample("tongjin-2015"),
    "tape zeros": sample("gi-b1-1966"),
    "simulated tracking": swing("tracking"),
    "amplitude": swing("amplitude"),
    "transit": swing("transit"),
    "campaign": simulate_kind("campaign", effects=[], seed=3)[0],
}
BASES["campaign"].pop("truth.json", None)


def exchange(data: bytes, pattern: re.Pattern[bytes], here: float, value: str) -> bytes:
    """Put another number, or another angle, where one stands."""
    found = list(pattern.finditer(data))
    if not found:
        return data
    hit = found[at(found, here)]
    return data[: hit.start()] + value.encode() + data[hit.end() :]


SWAPS = st.lists(
    st.one_of(
        st.tuples(st.just(DIGITS), st.floats(0, 1), st.sampled_from(NUMBERS)),
        st.tuples(st.just(DMS), st.floats(0, 1), st.sampled_from(ANGLES)),
    ),
    max_size=2,
)
COUNTS: Counter[int] = Counter()


def judge(files: dict[str, bytes], name: str) -> None:
    with TemporaryDirectory() as place:
        folder = Path(place)
        for path, data in files.items():
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            (folder / path).write_bytes(data)
        answer = run("orient", folder, "--json")
        COUNTS[answer.code] += 1
        assert answer.err == "", (name, answer.err)
        assert answer.code in (0, 1, 2), (name, answer.out)
        document = answer.json
        if answer.code == 2:
            assert document["problems"], name
            return
        conform(document, ORIENT, name)
        walk(document)
        assert run("orient", folder).code == answer.code


@given(
    base=st.sampled_from(sorted(BASES)),
    where=st.floats(0, 1),
    accidents=st.one_of(st.just([]), ACCIDENTS),
    swaps=SWAPS,
)
@seed(20261122)
@settings(max_examples=250, deadline=None, database=None)
def check_one_mutant(
    base: str,
    where: float,
    accidents: list[Accident],
    swaps: list[tuple[re.Pattern[bytes], float, str]],
) -> None:
    files = {path: text.encode() for path, text in BASES[base].items()}
    names = ["project.toml", *sorted(files)]
    name = names[at(names, where)]
    for pattern, here, value in swaps:
        files[name] = exchange(files[name], pattern, here, value)
    for accident in accidents:
        files[name] = mutate(files[name], accident)
    judge(files, f"{base}, {name}")


def test_two_hundred_and_fifty_mutants_are_oriented_or_refused() -> None:
    check_one_mutant()
    assert sum(COUNTS.values()) >= 200
    assert COUNTS[2] > 40
    assert COUNTS[0] + COUNTS[1] > 40


def test_every_base_is_oriented() -> None:
    for name, files in BASES.items():
        COUNTS.clear()
        judge({path: text.encode() for path, text in files.items()}, name)
        assert COUNTS[2] == 0, name
