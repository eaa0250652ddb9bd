"""Local processes and a Dask cluster: nothing is lost when a worker dies."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from worker_tasks import added, always_dies, dies_the_first_time, kept_file, squared

from tyrefem import study
from tyrefem.errors import InputError
from tyrefem.processes import processes
from tyrefem.sweep.sweep import sweep
from tyrefem.variants.dask_cluster import Dask, outcome_of
from tyrefem.variants.execution import SweepSettings
from tyrefem.variants.outcomes import Failed
from tyrefem.variants.plan import plan_of
from tyrefem.variants.schedulers import Here, Local


def test_in_this_process() -> None:
    assert dict(Here().outcomes(squared, [1, 2])) == {0: {"answers": {"x": 1.0}}, 1: {"answers": {"x": 4.0}}}


def test_local_processes_answer_everything() -> None:
    outcomes = dict(Local(2).outcomes(squared, list(range(12))))
    assert {n: outcome["answers"]["x"] for n, outcome in outcomes.items()} == {n: n**2 for n in range(12)}


def test_what_is_common_to_all_tasks_reaches_every_worker() -> None:
    outcomes = dict(Local(2).outcomes(added, list(range(6)), [0.5]))
    assert {n: outcome["answers"]["x"] for n, outcome in outcomes.items()} == {n: n + 0.5 for n in range(6)}
    assert dict(Here().outcomes(added, [1], [0.5]))[0]["answers"]["x"] == 1.5


def test_processes_are_kept_from_one_call_to_the_next_and_replaced_when_one_dies(tmp_path: Path) -> None:
    with Local(1) as scheduler:
        first, second = (dict(scheduler.outcomes(added, [1, 2], [0.0])) for _ in "ab")
        assert {outcome["answers"]["process"] for outcome in (*first.values(), *second.values())} == {
            first[0]["answers"]["process"]
        }
        outcomes = list(scheduler.outcomes(dies_the_first_time, [(3, str(tmp_path))]))
        assert outcomes == [(0, {"answers": {"x": 3.0}})]
        third = dict(scheduler.outcomes(added, [1], [0.0]))
        assert third[0]["answers"]["process"] != first[0]["answers"]["process"]


@pytest.mark.parametrize("interrupted", [False, True])
def test_processes_leave_no_temporary_files(interrupted: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    with suppress(KeyboardInterrupt), processes(2) as pool:
        files = list(map(Path, pool.map(kept_file, range(4))))
        assert all(file.is_file() and file.is_relative_to(tmp_path) for file in files)
        if interrupted:
            raise KeyboardInterrupt
    assert list(tmp_path.iterdir()) == []


def test_a_process_that_is_killed_costs_nothing(tmp_path: Path) -> None:
    tasks = [(n, str(tmp_path)) for n in range(10)]
    outcomes = list(Local(2).outcomes(dies_the_first_time, tasks))
    assert sorted(n for n, _ in outcomes) == list(range(10))
    assert all(outcome["answers"]["x"] == n for n, outcome in outcomes)


def test_a_task_that_kills_its_process_is_named_and_the_others_go_on() -> None:
    outcomes = dict(Local(2).outcomes(always_dies, list(range(6))))
    assert "died" in outcomes[2].reason
    assert {n for n, outcome in outcomes.items() if not isinstance(outcome, Failed)} == {0, 1, 3, 4, 5}


def test_no_scheduler_there_is_one_clear_error() -> None:
    with pytest.raises(InputError, match=r"no Dask scheduler at 'tcp://127\.0\.0\.1:9'"):
        Dask("tcp://127.0.0.1:9", timeout=1.0)


class Tearing:
    """A scheduler that loses every piece of work of several variants, as a dying worker does."""

    def __init__(self) -> None:
        self.lost = 0

    def outcomes(self, work: Any, tasks: Sequence[Any], common: Any = None) -> Iterator[tuple[int, Any]]:
        for place, task in enumerate(tasks):
            torn = isinstance(task, list)
            self.lost += torn
            yield place, Failed("died") if torn else work(task)


def test_variants_of_a_lost_piece_are_tried_one_by_one() -> None:
    tyre = study("nasa-22x5.5-8pr", {"mesh.size": "12 mm", "numerics.tolerance": "0.5 K", "drive.duration": "20 s"})
    scheduler = Tearing()
    plan = plan_of(tyre, {"drive.speed": ("10 mph", "20 mph", 4)})
    outcomes = sweep(plan, scheduler=scheduler, settings=SweepSettings(single=2))
    assert scheduler.lost == 2
    assert outcomes.complete
    assert not outcomes.failed


@pytest.mark.parametrize("status", ["finished", "lost", "pending"])
def test_a_fetched_result_counts_also_if_its_worker_is_lost_afterwards(status: str) -> None:
    assert outcome_of(status, {"answers": {"x": 1.0}}) == {"answers": {"x": 1.0}}
    assert outcome_of("error", (KeyError, KeyError("gone"), None)) == Failed("lost by the cluster: 'gone'")
