"""What a sweep of many variants costs beside its runs: memory, store, resuming, tables and page.

The runs are replaced by a formula that changes the answers of one run, so that a variant costs a fraction of a
millisecond; ``--reduced`` trains a reduced model of a coarse study instead. Every stage has a process of its own,
whose peak of resident memory counts. Prints a table and, as the last line, one JSON object.

Usage: python benchmarks/sweep_scale.py [--counts 1000,10000,100000] [--reduced] [--workers N] [--dask TASKS]
"""

# ruff: noqa: E402 - the number of BLAS threads must be set before numpy is loaded.
from __future__ import annotations

import os

for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

import argparse
import json
import resource
import shutil
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

STUDY = "nasa-22x5.5-8pr"
COARSE = {"mesh.size": "10 mm", "numerics.tolerance": "0.1 K", "drive.duration": "120 s"}
BOX = {
    "drive.speed": ("10 mph", "30 mph"),
    "drive.ambient": ("10 degC", "30 degC"),
    "materials.tread.loss_tangent.value": {"factor": [0.6, 1.4]},
    "boundaries.contained_air.film": ("3 W/m**2/K", "10 W/m**2/K"),
}
STAGES = ("sweep", "resume", "report")
BROWSERS = ("chromium", "chromium-browser", "google-chrome")


class Formula:
    """A scheduler that changes the answers of one run by a formula, in place of further runs."""

    workers = 2

    def __init__(self, answers: dict[str, Any]) -> None:
        self.answers, self.computed = answers, 0

    def outcomes(self, work: Any, tasks: Sequence[Any], common: Any = None) -> Iterator[tuple[int, Any]]:
        """Outcomes of tasks of one or several variants."""
        from tyrefem.variants.task import Task

        for place, task in enumerate(tasks):
            pieces = [task] if isinstance(task, Task) else task
            self.computed += len(pieces)
            outcomes = tuple(self.answered(piece) for piece in pieces)
            yield place, outcomes[0] if isinstance(task, Task) else outcomes

    def answered(self, task: Any) -> Any:
        """Every answer times a factor that depends on the variant's numbers."""
        from tyrefem.variants.outcomes import Answered

        speed, ambient, loss, film = (float(str(value).split()[0]) for value in task.changes.values())
        factor = 0.5 + 0.02 * speed + 0.003 * ambient + loss / 7.0 + 0.001 * film
        numbered = enumerate(self.answers.items())
        return Answered({k: v if isinstance(v, str) else v * factor ** (1 + n % 5 / 9) for n, (k, v) in numbered})


def stage(name: str, count: int, folder: Path, reduced: bool, workers: int) -> dict[str, Any]:
    """One stage in this process: its seconds, its peak of memory, and what it wrote."""
    import tyrefem
    from tyrefem.reports.sweep_files import save
    from tyrefem.sweep.design import questions
    from tyrefem.variants.execution import Execution
    from tyrefem.variants.plan import card_of
    from tyrefem.variants.schedulers import Here, Local
    from tyrefem.variants.store import NAME
    from tyrefem.variants.task import perform

    # The estimate is of the runs that the formula replaces.
    warnings.simplefilter("ignore")
    study = tyrefem.study(STUDY, COARSE)
    card = card_of(study, BOX, sample="latin-hypercube", count=count)
    began, wall = time.process_time(), time.perf_counter()
    wanted = questions(study, card)
    ready = time.process_time()
    if reduced:
        execution = Execution(Local(workers) if workers > 1 else Here(), folder, reduced="always", tolerance=0.1)
        formula = None
    else:
        file = folder.parent / "answers.json"
        if not file.exists():
            file.write_text(json.dumps(dict(perform(wanted.plan.task(0)).answers)))
        formula = Formula(json.loads(file.read_text()))
        execution = Execution(formula, folder, reduced="never")
    began_answers = time.process_time()
    design = wanted.answered(execution)
    answered = time.process_time()
    result: dict[str, Any] = {"plan_s": ready - began, "answers_s": answered - began_answers}
    if name == "report":
        save(design, folder)
        result |= {"files_s": time.process_time() - answered}
        result |= {file.name: file.stat().st_size for file in folder.iterdir() if file.is_file()}
    if name == "resume":
        assert design.swept is not None
        assert design.swept.resumed == count
        assert formula is None or not formula.computed
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    store = (folder / NAME).stat().st_size / count
    seconds = {"cpu_s": time.process_time() - began, "wall_s": time.perf_counter() - wall}
    return {**result, **seconds, "peak_MB": peak / 1e6, "store_bytes_per_variant": store}


def opened(page: Path) -> float | None:
    """Wall seconds in which a headless browser loads a page, less those for an empty one; None: no browser."""
    browser = next((path for name in BROWSERS if (path := shutil.which(name))), None)
    if browser is None:
        return None
    empty = page.with_name("empty.html")
    empty.write_text("<!doctype html><title>empty</title>")
    seconds = []
    for file in (empty, page, empty, page):
        with tempfile.TemporaryDirectory() as profile:
            words = [browser, "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={profile}"]
            began = time.perf_counter()
            subprocess.run([*words, "--dump-dom", file.as_uri()], check=True, capture_output=True, timeout=300)
            seconds.append(time.perf_counter() - began)
    empty.unlink()
    return min(seconds[1::2]) - min(seconds[::2])


def empty_task(changes: Sequence[Any]) -> bytes:
    """A task that computes nothing: the bytes of as many packed outcomes come back."""
    return b"x" * (200 * len(changes))


def cluster_costs(tasks: int) -> dict[str, Any]:
    """Tasks of 64 and 2048 variants on a local Dask cluster: seconds and bytes of each, without any computation."""
    import pickle

    from distributed import Client, LocalCluster

    import tyrefem
    from tyrefem.variants.dask_cluster import Dask
    from tyrefem.variants.plan import plan_of
    from tyrefem.variants.task_list import TaskList

    warnings.simplefilter("ignore")
    variants = plan_of(tyrefem.study(STUDY, COARSE), BOX, sample="latin-hypercube", count=2048).variants
    costs: dict[str, Any] = {}
    options = {"threads_per_worker": 1, "dashboard_address": None, "processes": True}
    with LocalCluster(n_workers=2, **options) as cluster, Client(cluster) as client:
        scheduler = Dask(client)
        for size in (64, 2048):
            count = max(tasks * 64 // size, 20)
            work = TaskList(count, lambda _, size=size: variants[:size])
            list(scheduler.outcomes(empty_task, TaskList(8, work.make)))
            used = client.run_on_scheduler(time.process_time)
            began, wall = time.process_time(), time.perf_counter()
            assert sum(len(part) for _, part in scheduler.outcomes(empty_task, work)) == 200 * size * count
            costs[str(size)] = {
                "tasks": count,
                "wall_ms": 1e3 * (time.perf_counter() - wall) / count,
                "client_and_scheduler_ms": 1e3 * (time.process_time() - began) / count,
                "same_process": bool(client.run_on_scheduler(os.getpid) == os.getpid()),
                "scheduler_ms": 1e3 * (client.run_on_scheduler(time.process_time) - used) / count,
                "bytes_to_a_worker": len(pickle.dumps((empty_task, variants[:size]))),
            }
    return costs


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--counts", default="1000,10000,100000", help="numbers of variants")
    parser.add_argument("--reduced", action="store_true", help="a reduced model of a coarse study, no formula")
    parser.add_argument("--workers", type=int, default=1, help="processes for the reduced model")
    parser.add_argument("--dask", type=int, default=0, metavar="TASKS", help="also costs of tasks on a local cluster")
    parser.add_argument("--stage", nargs=3, metavar=("NAME", "COUNT", "FOLDER"), help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.stage:
        name, count, folder = options.stage
        print(json.dumps(stage(name, int(count), Path(folder), options.reduced, options.workers)))
        return
    rows: dict[str, dict[str, Any]] = {}
    print(f"{'variants':>9} {'stage':7} {'cpu s':>8} {'peak MB':>8} {'store B':>8} {'page kB':>8} {'opens s':>8}")
    with tempfile.TemporaryDirectory() as place:
        for count in map(int, options.counts.split(",")):
            folder = Path(place) / str(count)
            for name in STAGES:
                words = [sys.executable, __file__, "--stage", name, str(count), str(folder)]
                words += ["--reduced", "--workers", str(options.workers)] if options.reduced else []
                done = subprocess.run(words, check=True, capture_output=True, text=True)
                row = rows.setdefault(str(count), {})[name] = json.loads(done.stdout.splitlines()[-1])
                page = row.get("sweep.html")
                row["page_opens_s"] = opened(folder / "sweep.html") if page else None
                shown = ["" if page is None else f"{page / 1e3:.0f}"]
                shown.append("" if row["page_opens_s"] is None else f"{row['page_opens_s']:.2f}")
                numbers = f"{row['cpu_s']:8.2f} {row['peak_MB']:8.0f} {row['store_bytes_per_variant']:8.0f}"
                print(f"{count:9d} {name:7} {numbers} {shown[0]:>8} {shown[1]:>8}", flush=True)
    result: dict[str, Any] = {"reduced": options.reduced, "counts": rows}
    if options.dask:
        result["dask"] = cluster_costs(options.dask)
        for size, cost in result["dask"].items():
            print(f"Dask, {size} variants a task: {cost['wall_ms']:.1f} ms, {cost['bytes_to_a_worker']} B to a worker")
    print(json.dumps(result))


if __name__ == "__main__":
    main()
