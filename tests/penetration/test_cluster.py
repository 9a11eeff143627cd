"""Simulated surveys on a cluster from which a worker is killed: the same numbers.

The same but for the rounding of products of matrices: a worker counts on one thread, this process
on as many as it has cores, and the library adds in another order.
"""

import json
import os
import signal
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from surveyapp import api
from surveyapp.cli.main import main
from surveyapp.core.penetration.simulation import BLOCK, Task
from surveyapp.errors import SurveyError
from surveyapp.workflows.simulating import TOGETHER, simulated_misses
from tests.penetration.mines import mine_folder, mine_toml, straight

distributed = pytest.importorskip("distributed")
ROUNDING_M = 1e-9
"""Of sums of 60 sides of 100 m in double precision, with room: a thousandth of a micrometre."""

pytestmark = pytest.mark.filterwarnings("ignore")


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
    ) as local:
        yield local


def test_a_killed_worker_changes_nothing(cluster: Any) -> None:
    task = Task(straight(60, (0, 30), shared=8.0), 3, 14 * TOGETHER * BLOCK)
    alone = np.concatenate(simulated_misses(task))
    with distributed.Client(cluster) as client:
        victims = client.run(os.getpid)
        executor = client.get_executor(retries=3, pure=False)
        dying = executor.submit(time.sleep, 0.0)
        dying.result()
        killed = executor.submit(_kill_after, next(iter(victims.values())))
        many = np.concatenate(simulated_misses(task, executor))
        assert killed.done() or killed.result() is None
    np.testing.assert_allclose(many, alone, rtol=0.0, atol=ROUNDING_M)


def _flat(value: Any, name: str = "") -> dict[str, Any]:
    """Every leaf of a JSON value by its path."""
    if isinstance(value, dict):
        parts = [_flat(inner, f"{name}/{key}") for key, inner in value.items()]
    elif isinstance(value, list):
        parts = [_flat(inner, f"{name}/{key}") for key, inner in enumerate(value)]
    else:
        return {name: value}
    return {key: inner for part in parts for key, inner in part.items()}


def _kill_after(pid: int) -> None:
    """Kill a worker while it has blocks; where it is this one, the next attempt finds it gone."""
    time.sleep(0.2)
    try:
        os.kill(pid, signal.SIGKILL)
    except ProcessLookupError:
        return


def test_the_command_takes_the_address_of_a_cluster(
    cluster: Any, tmp_path: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    table = "monte_carlo = { runs = 12000, seed = 4 }\nsigma_distance = { mm = 2.0, ppm = 2.0 }"
    folder = mine_folder(tmp_path / "m", mine_toml(table=table))
    assert main(["predict", str(folder), "--json"]) == 0
    alone = capsys.readouterr().out
    address = cluster.scheduler_address
    assert main(["predict", str(folder), "--json", "--cluster", address]) == 0
    assert _flat(json.loads(capsys.readouterr().out)) == pytest.approx(_flat(json.loads(alone)))


def test_nobody_at_the_address_is_told(tmp_path: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("surveyapp.workflows.cluster.TIMEOUT_S", 1)
    folder = mine_folder(tmp_path / "m", mine_toml())
    nobody = "tcp://127.0.0.1:9"
    with pytest.raises(SurveyError, match="no cluster answers"), api.cluster_executor(nobody):
        pass
    assert main(["predict", str(folder), "--cluster", "tcp://127.0.0.1:9"]) == 2
