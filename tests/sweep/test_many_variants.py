"""Sweeps of many variants: what grows with their number, and what does not."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from pyarrow import parquet

from tyrefem import study
from tyrefem.reports.sweep import ROWS_OF_VARIANTS, chosen_rows
from tyrefem.reports.sweep_files import save, write_parts, write_table
from tyrefem.sweep.design import DesignData, questions
from tyrefem.sweep.evaluation import VariantEvaluation
from tyrefem.sweep.reduced_tasks import by_model
from tyrefem.sweep.sweep import sweep
from tyrefem.variants.blocks import packed
from tyrefem.variants.execution import Execution, SweepSettings
from tyrefem.variants.outcome_table import OutcomeTable
from tyrefem.variants.outcomes import Answered, Failed, Outcome, answer_of
from tyrefem.variants.plan import Plan, card_of, plan_of
from tyrefem.variants.samples import check_distinct
from tyrefem.variants.store import NAME
from tyrefem.variants.task import Task
from tyrefem.variants.task_list import task_size

COARSE = {"mesh.size": "12 mm", "numerics.tolerance": "0.5 K", "drive.duration": "120 s"}
BOX = {
    "drive.speed": ("10 mph", "30 mph"),
    "drive.ambient": ("10 degC", "30 degC"),
    "materials.tread.loss_tangent.value": {"factor": [0.6, 1.4]},
}


class Formula:
    """Answers by a formula in place of runs; records the variants, and how many tasks exist at a time."""

    workers = 8

    def __init__(self) -> None:
        self.computed: list[int] = []
        self.largest = 0

    def outcomes(self, work: Any, tasks: Any, common: Any = None) -> Iterator[tuple[int, Any]]:
        for place, task in enumerate(tasks):
            alone = isinstance(task, Task)
            pieces = [task] if alone else task
            self.largest = max(self.largest, len(pieces))
            outcomes = tuple(self.answered(each) for each in pieces)
            self.computed += [each.number for each in pieces]
            yield place, outcomes[0] if alone else outcomes

    def answered(self, task: Task) -> Outcome:
        speed, ambient = (float(str(task.changes[key]).split()[0]) for key in ("drive.speed", "drive.ambient"))
        if task.number % 97 == 5:
            return Failed("bursts")
        hot = ambient + 2.0 * speed
        answers = {"hottest_degC": hot, "hottest_region": "tread" if speed > 20 else "carcass"}
        return Answered(answers | {"rolling_resistance_coefficient": 0.01 - 1e-4 * speed + 1e-9 * hot**2})


def many(count: int) -> Plan:
    return plan_of(study("nasa-22x5.5-8pr", COARSE), BOX, sample="latin-hypercube", count=count)


#: Many tasks of several variants, as a large sweep has.
PIECES = Execution(reduced="never", settings=SweepSettings(single=50, piece=32))


def test_the_digest_of_a_plan_is_that_of_its_variants_written_out() -> None:
    plan = many(20)
    text = json.dumps([plan.packed.digest, list(plan.variants), plan.time_to], sort_keys=True, default=str)
    assert plan.digest == hashlib.sha256(text.encode()).hexdigest()[:16]


def test_variants_are_made_when_they_are_asked_for() -> None:
    plan = many(50)
    assert plan.variants[7] == plan.variants[7]
    assert plan.variants[7] is not plan.variants[7]
    assert plan.variants[-1] == list(plan.variants)[49]
    assert plan.names[9] == "10"
    with pytest.raises(IndexError):
        _ = plan.variants[50]


def test_equal_variants_are_named_among_many() -> None:
    variants = [{"drive.speed": f"{number} mph"} for number in range(300)]
    names = [f"v{number}" for number in range(300)]
    check_distinct(variants, names)
    variants[211] = {"drive.speed": "17 mph"}
    with pytest.raises(ValueError, match="'v17' and 'v211' are the same"):
        check_distinct(variants, names)


def test_resuming_computes_only_what_is_missing_and_gives_the_same_table(tmp_path: Path) -> None:
    plan, first, again = many(2000), Formula(), Formula()
    whole = sweep(plan, PIECES, scheduler=first)
    execution = dataclasses.replace(PIECES, folder=tmp_path, scheduler=first)
    with VariantEvaluation(plan, execution, plan.variants, plan.digest) as part:
        finished = next(part.evaluate(range(300, 900)))
    assert 0 < finished < 600
    rest = sweep(plan, PIECES, scheduler=again, folder=tmp_path)
    assert rest.resumed == finished
    assert sorted([*part.outcomes, *again.computed]) == list(range(2000))
    pd.testing.assert_frame_equal(rest.table, whole.table)
    nothing = Formula()
    once_more = sweep(plan, PIECES, scheduler=nothing, folder=tmp_path)
    assert nothing.computed == []
    assert once_more.resumed == 2000
    pd.testing.assert_frame_equal(once_more.table, whole.table)


def test_what_a_sweep_keeps_open_does_not_grow(tmp_path: Path) -> None:
    handles = Path("/proc/self/fd")
    if not handles.exists():
        pytest.skip("no list of open files on this system")
    before = len(os.listdir(handles))
    swept = sweep(many(1000), PIECES, scheduler=(formula := Formula()), folder=tmp_path)
    _ = swept.table
    assert len(os.listdir(handles)) <= before
    assert formula.largest <= 32
    assert [file.name for file in tmp_path.iterdir()] == [NAME]


def test_outcomes_in_memory_are_packed(tmp_path: Path) -> None:
    swept = sweep(many(2000), PIECES, scheduler=Formula())
    blocks = swept.packed._blocks
    inside = sum(len(block.numbers) for block in blocks)
    assert inside > 0.95 * 2000
    assert sum(len(block.content) for block in blocks) < 30 * inside  # type: ignore[arg-type]
    assert len(swept.packed._singles) == 2000 - inside


def test_the_parts_of_a_table_are_the_table(tmp_path: Path) -> None:
    swept = sweep(many(700), PIECES, scheduler=Formula())
    write_table(swept.table, tmp_path, "whole")
    write_parts(swept.parts(64), tmp_path, "parts")
    assert (tmp_path / "parts.csv").read_bytes() == (tmp_path / "whole.csv").read_bytes()
    pd.testing.assert_frame_equal(pd.read_parquet(tmp_path / "parts.parquet"), swept.table)
    units = parquet.read_schema(tmp_path / "parts.parquet").field("hottest_degC").metadata
    assert units[b"unit"] == b"degC"
    assert list(swept.overview().columns) == [
        name for name in swept.table.columns if name not in ("hottest_region", "mass_kg")
    ]


def design_of(count: int) -> DesignData:
    tyre = study("nasa-22x5.5-8pr", COARSE)
    card = card_of(tyre, BOX, sample="latin-hypercube", count=count, limits={"hottest_degC": {"below": 70}})
    return questions(tyre, card).answered(PIECES, scheduler=Formula())


def test_the_page_does_not_grow_with_the_number_of_variants(tmp_path: Path) -> None:
    sizes = []
    for count in (4000, 12000):
        save(design_of(count), tmp_path / str(count))
        page = (tmp_path / str(count) / "sweep.html").read_text()
        assert page.count("<tr") < ROWS_OF_VARIANTS + 10
        assert f"of {count} variants: the Pareto front" in page
        sizes.append(len(page))
        assert len((tmp_path / str(count) / "sweep.csv").read_text().splitlines()) == count + 1
    assert sizes[1] < 1.1 * sizes[0]


def test_the_page_has_the_front_and_the_extreme_answers() -> None:
    rng = np.random.default_rng(1)
    table = pd.DataFrame({"variant": [str(n) for n in range(5000)], "a": rng.random(5000), "b": rng.random(5000)})
    table.loc[17, "a"] = np.nan
    places = chosen_rows(table, {"40", "3000"}, ["a", "b"])
    assert len(places) <= ROWS_OF_VARIANTS
    assert list(places) == sorted(set(places))
    extremes = [table["a"].idxmin(), table["a"].idxmax(), table["b"].idxmin(), table["b"].idxmax()]
    assert {40, 3000, *extremes} <= set(places)
    assert 17 not in places or table["b"].rank()[17] < 200
    assert list(chosen_rows(table.head(300), set(), ["a"])) == list(range(300))


class Deadly:
    """A scheduler on which every task of more than 32 variants, and every task with variant 40, ends its worker."""

    workers = 1

    def __init__(self) -> None:
        self.sizes: list[int] = []

    def outcomes(self, work: Any, tasks: Any, common: Any = None) -> Iterator[tuple[int, Any]]:
        for place, task in enumerate(tasks):
            speeds = [float(changes["drive.speed"].split()[0]) for changes in task.changes]
            self.sizes.append(len(speeds))
            if len(speeds) > 32 or 40.0 in speeds:
                yield place, Failed("its process died")
            else:
                yield place, packed({n: Answered({"hottest_degC": speed}, "reduced") for n, speed in enumerate(speeds)})


class NoModel:
    """In place of a reduced model that nobody uses."""

    def packed(self, _: Any) -> None:
        return None


def test_variants_of_a_task_that_ends_its_worker_are_tried_in_smaller_tasks() -> None:
    speeds = {"drive.speed": ("1 km/h", "1024 km/h", 1024)}
    plan, deadly = plan_of(study("nasa-22x5.5-8pr", COARSE), speeds), Deadly()
    execution = Execution(deadly, settings=SweepSettings(piece=32))
    model: Any = NoModel()
    outcomes = OutcomeTable()
    for part in by_model(model, plan, plan.variants, execution):
        outcomes.update(part)
    by_place = {number: answer_of(outcome, "hottest_degC") for number, outcome in outcomes.items()}
    assert deadly.sizes == [64] * 16 + [32] * 32
    assert by_place == {n: n + 1.0 for n in range(1024) if not 32 <= n < 64}


@pytest.mark.parametrize(("count", "workers"), [(1000, 2), (10**5, 2), (10**7, 100), (10**7, 800)])
def test_tasks_are_few_and_every_worker_has_several(count: int, workers: int) -> None:
    size = task_size(count, workers, 64)
    tasks = count / size
    assert size % 64 == 0
    assert tasks >= workers * 4
    assert tasks <= max(workers * 20, count / 1984)
