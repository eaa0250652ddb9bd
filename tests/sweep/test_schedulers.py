"""Local processes and a Dask cluster: nothing is lost when a worker dies."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tyrefem.errors import InputError
from tyrefem.sweep.schedulers import Dask, Here, Local


def squared(task: Any) -> dict[str, Any]:
    return {"answers": {"x": float(task) ** 2}}


def dies_the_first_time(task: tuple[int, str]) -> dict[str, Any]:
    number, folder = task
    if number == 3:
        mark = Path(folder) / "died"
        if not mark.exists():
            mark.touch()
            os.kill(os.getpid(), signal.SIGKILL)
    return {"answers": {"x": float(number)}}


def always_dies(task: int) -> dict[str, Any]:
    if task == 2:
        os.kill(os.getpid(), signal.SIGKILL)
    return {"answers": {"x": float(task)}}


def slowly(task: int) -> dict[str, Any]:
    time.sleep(0.15)
    return {"answers": {"x": float(task), "process": os.getpid()}}


def test_in_this_process() -> None:
    assert dict(Here().outcomes(squared, [1, 2])) == {0: {"answers": {"x": 1.0}}, 1: {"answers": {"x": 4.0}}}


def test_local_processes_answer_everything() -> None:
    found = dict(Local(2).outcomes(squared, list(range(12))))
    assert {n: one["answers"]["x"] for n, one in found.items()} == {n: n**2 for n in range(12)}


def test_a_process_that_is_killed_costs_nothing(tmp_path: Path) -> None:
    tasks = [(n, str(tmp_path)) for n in range(10)]
    found = list(Local(2).outcomes(dies_the_first_time, tasks))
    assert sorted(n for n, _ in found) == list(range(10))
    assert all(one["answers"]["x"] == n for n, one in found)


def test_a_task_that_kills_its_process_is_named_and_the_others_go_on() -> None:
    found = dict(Local(2).outcomes(always_dies, list(range(6))))
    assert "died" in found[2]["failure"]
    assert {n for n, one in found.items() if "answers" in one} == {0, 1, 3, 4, 5}


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """A real scheduler and two real workers, each a process of its own."""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(Path(__file__).parent), *sys.path])}
    running: list[subprocess.Popen[bytes]] = []

    def start(*arguments: str) -> subprocess.Popen[bytes]:
        one = subprocess.Popen(
            [sys.executable, "-m", *arguments], cwd=tmp_path, env=environment, stderr=subprocess.DEVNULL
        )
        running.append(one)
        return one

    file = tmp_path / "scheduler.json"
    start("distributed.cli.dask_scheduler", "--port", "0", "--no-dashboard", "--scheduler-file", str(file))
    deadline = time.monotonic() + 60
    while not file.exists() and time.monotonic() < deadline:
        time.sleep(0.1)
    import json

    address = json.loads(file.read_text())["address"]
    workers = [
        start("distributed.cli.dask_worker", address, "--nthreads", "1", "--no-dashboard", "--no-nanny") for _ in "ab"
    ]
    yield address, workers
    for one in running:
        one.kill()
        one.wait()


def test_a_cluster_loses_a_worker_and_no_variant(cluster: tuple[str, list[subprocess.Popen[bytes]]]) -> None:
    from distributed import Client

    address, workers = cluster
    with Client(address, timeout=60, set_as_default=False) as client:
        client.wait_for_workers(2, timeout=60)
        found, killed = {}, False
        for place, outcome in Dask(client).outcomes(slowly, list(range(30))):
            assert place not in found
            found[place] = outcome
            if len(found) == 8 and not killed:
                workers[0].kill()
                killed = True
    assert sorted(found) == list(range(30))
    assert all(one["answers"]["x"] == n for n, one in found.items())
    assert len({one["answers"]["process"] for one in found.values()}) == 2


def test_no_scheduler_there_is_one_clear_error() -> None:
    with pytest.raises(InputError, match="no Dask scheduler at 'tcp://127.0.0.1:9'"):
        Dask("tcp://127.0.0.1:9", timeout=1.0)
