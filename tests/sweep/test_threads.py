"""Sweeps on threads of one process, as on threaded workers of a cluster: what a process remembers serves them all."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from typing import Any, TypeVar

import pandas as pd
import pytest

from tyrefem import study
from tyrefem.reduced import packed_model
from tyrefem.sweep.sweep import Sweep, sweep
from tyrefem.variants.execution import SweepSettings
from tyrefem.variants.plan import Plan, plan_of
from tyrefem.variants.task import bundle, unpacked

Result = TypeVar("Result")


class Threads:
    """Runs the tasks of any sweep on the threads of one pool."""

    def __init__(self, pool: ThreadPoolExecutor) -> None:
        self.pool = pool

    def outcomes(
        self, work: Callable[..., Result], tasks: Sequence[Any], common: Any = None
    ) -> Iterator[tuple[int, Result]]:
        given = () if common is None else (common,)
        places = {self.pool.submit(work, task, *given): place for place, task in enumerate(tasks)}
        for future in as_completed(places):
            yield places[future], future.result()


def plan(load: str, angle: str) -> Plan:
    coarse = {"mesh.size": "14 mm", "numerics.tolerance": "0.5 K", "drive.duration": "40 s", "drive.load": load}
    tyre = study("nasa-22x5.5-8pr", coarse | {"section.cord_angle": angle})
    return plan_of(tyre, {"drive.speed": ("12 mph", "20 mph", 5), "drive.ambient": ["15 degC", "30 degC"]})


def answers(swept: Sweep) -> pd.DataFrame:
    assert swept.complete
    assert not swept.failed
    return swept.table


@pytest.mark.parametrize("reduced", ["never", "always"])
def test_two_sweeps_at_once_answer_as_one_after_the_other(reduced: str) -> None:
    plans = [plan("2400 lbf", "35 deg"), plan("2800 lbf", "37 deg")]
    how: dict[str, Any] = {"reduced": reduced, "tolerance": 0.05, "settings": SweepSettings(piece=3)}
    after_each_other = [answers(sweep(each, **how)) for each in plans]
    with ThreadPoolExecutor(4) as workers, ThreadPoolExecutor(2) as sweeps:
        both = [sweeps.submit(sweep, each, scheduler=Threads(workers), **how) for each in plans]
        at_once = [answers(each.result()) for each in both]
    for table, expected in zip(at_once, after_each_other, strict=True):
        pd.testing.assert_frame_equal(table, expected, rtol=1e-9, atol=1e-9)
    assert (at_once[0]["hottest_degC"] != at_once[1]["hottest_degC"]).all()


class Named:
    """Stands for a packed study; another thread goes on whenever its digest is asked for."""

    def __init__(self, name: str) -> None:
        self.name = name

    @property
    def digest(self) -> str:
        time.sleep(0)
        return self.name


def test_every_thread_gets_the_tyre_of_its_own_study(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(packed_model, "unpacked", lambda packed: packed)
    monkeypatch.setattr(packed_model, "tyre_of", lambda packed, counts: f"tyre of {packed.name}")
    begin = threading.Barrier(8)

    def wrong(number: int) -> int:
        begin.wait()
        names = [f"study {(number + n) % 8}" for n in range(500)]
        return sum(packed_model.base_of(Named(name)) != f"tyre of {name}" for name in names)  # type: ignore[arg-type]

    with ThreadPoolExecutor(8) as pool:
        assert sum(pool.map(wrong, range(8))) == 0


def test_threads_share_an_unpacked_study() -> None:
    packed = bundle(study("nasa-22x5.5-8pr", {"mesh.size": "14 mm"}))
    begin = threading.Barrier(8)

    def number_of_the_study(_: int) -> int:
        begin.wait()
        return id(unpacked(packed))

    with ThreadPoolExecutor(8) as pool:
        assert len(set(pool.map(number_of_the_study, range(8)))) == 1
