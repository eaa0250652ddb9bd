"""Tasks for worker processes: at home where what they need was made, elsewhere if a worker is idle."""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path

import pytest

from tyrefem.diagnose.forward.worker_queues import (
    EVALUATIONS,
    HomedTask,
    WorkerQueues,
    begun,
    start_others,
    started_workers,
    worker_queues,
)


def meet(folder: Path, name: str, guests: int) -> bool:
    """Whether so many tasks run at the same time: each waits for the others, at most a minute."""
    (folder / name).touch()
    latest = time.monotonic() + 60.0
    while (here := len(list(folder.iterdir()))) < guests and time.monotonic() < latest:
        time.sleep(0.01)
    return here >= guests


def process_of(folder: Path, name: str, guests: int) -> int:
    """The process that does a task, once ``guests`` tasks run at the same time."""
    assert meet(folder, name, guests)
    return os.getpid()


def fail() -> None:
    """A task that fails."""
    raise ValueError("a tyre of glass")


def begun_in(queues: WorkerQueues, place: int) -> int:
    """The process of a worker."""
    return int(queues.workers[place].submit(os.getpid).result())


def processes_of(queues: WorkerQueues, folder: Path) -> dict[int, int]:
    """Number of the task -> process, for a task at home in each of two workers."""
    folder.mkdir()
    tasks = {home: HomedTask(home, process_of, (folder, str(home), 2)) for home in (0, 1)}
    return {number: process for number, _, process in queues.results(tasks)}


def test_a_task_goes_to_the_worker_that_is_its_home(tmp_path: Path) -> None:
    with worker_queues(2) as queues:
        first, again = processes_of(queues, tmp_path / "first"), processes_of(queues, tmp_path / "again")
    assert first == again
    assert len({*first.values(), os.getpid()}) == 3


def test_an_idle_worker_helps(tmp_path: Path) -> None:
    with worker_queues(2) as queues:
        tasks = {number: HomedTask(0, meet, (tmp_path, str(number), 2)) for number in range(2)}
        assert {(number, helped) for number, _, helped in queues.results(tasks)} == {(0, True), (1, True)}


def test_the_worker_of_a_result_is_told() -> None:
    with worker_queues(2) as queues:
        tasks = {number: HomedTask(1, os.getpid, (), stays=True) for number in range(3)}
        assert {(worker, process) for _, worker, process in queues.results(tasks)} == {(1, begun_in(queues, 1))}


def test_an_idle_worker_leaves_a_task_that_stays() -> None:
    with worker_queues(2) as queues:
        tasks = {number: HomedTask(0, time.sleep, (0.05,), stays=True) for number in range(4)}
        assert {worker for _, worker, _ in queues.results(tasks)} == {0}


def test_the_error_of_a_task_is_raised_and_the_workers_end() -> None:
    with pytest.raises(ValueError, match="a tyre of glass"), worker_queues(2) as queues:
        list(queues.results({0: HomedTask(0, os.getpid, ()), 1: HomedTask(1, fail, ())}))


def test_no_tasks_have_no_results() -> None:
    with worker_queues(1) as queues:
        assert list(queues.results({})) == []


def test_a_result_that_is_begun_early_comes_from_another_process() -> None:
    with started_workers(2) as workers:
        process = begun(workers, os.getpid)
        assert process() != os.getpid()
    with started_workers(1) as workers:
        assert begun(workers, os.getpid)() == os.getpid()


def test_processes_that_wait_for_a_core_are_started_later() -> None:
    with started_workers(2, at_once=1) as workers:
        assert not isinstance(workers, int)
        start_others(workers, 1)
        tasks = {number: HomedTask(number, imported, (), stays=True) for number in (0, 1)}
        assert [has for _, _, has in workers.results(tasks)] == [True, True]
    start_others(1, 1)  # without processes there is nothing to start


def imported() -> bool:
    """Whether this process has imported what a worker of a diagnosis needs."""
    return EVALUATIONS in sys.modules


def test_what_a_worker_has_printed_is_not_lost_when_it_ends(capfd: pytest.CaptureFixture[str]) -> None:
    with worker_queues(1) as queues:
        begun(queues, print, "tread")()
    assert capfd.readouterr().out == "tread\n"
