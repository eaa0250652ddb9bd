"""A sweep that is killed, interrupted or loses its cluster goes on where it was, and answers the same."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import psutil
import pytest

from tyrefem import study
from tyrefem.sweep.sweep import Sweep, sweep
from tyrefem.variants.dask_cluster import Dask
from tyrefem.variants.outcomes import Outcome
from tyrefem.variants.plan import Plan, plan_of
from tyrefem.variants.store import NAME

COARSE = {"mesh.size": "12 mm", "numerics.tolerance": "0.5 K", "drive.duration": "120 s"}
SPEEDS = ("10 mph", "24 mph", 8)


@pytest.fixture(scope="module")
def plan() -> Plan:
    return plan_of(study("nasa-22x5.5-8pr", COARSE), {"drive.speed": SPEEDS})


@pytest.fixture(scope="module")
def whole(plan: Plan) -> Sweep:
    return sweep(plan, reduced="never")


def command(out: Path) -> list[str]:
    changes = [word for key, value in COARSE.items() for word in ("--set", f"{key}={value}")]
    speeds = f"drive.speed={SPEEDS[0]}:{SPEEDS[1]}:{SPEEDS[2]}"
    program = [sys.executable, "-m", "tyrefem", "sweep", "nasa-22x5.5-8pr", "--vary", speeds, *changes]
    return [*program, "--out", str(out), "--workers", "2", "--no-pictures", "--reduced", "never"]


def started(out: Path) -> subprocess.Popen[str]:
    """The command in a group of its own, Ctrl-C not ignored; returns when two variants are finished."""
    running = subprocess.Popen(
        command(out),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    deadline = time.monotonic() + 120
    while finished(out) < 2:
        assert running.poll() is None, running.communicate()
        assert time.monotonic() < deadline
        time.sleep(0.01)
    return running


def finished(out: Path) -> int:
    path = out / NAME
    return path.read_bytes().count(b'"answers"') if path.exists() else 0


def workers_of(group: int) -> list[int]:
    """Processes of a session that are alive."""
    processes = []
    for process in psutil.process_iter():
        with contextlib.suppress(psutil.Error, ProcessLookupError):
            if os.getsid(process.pid) == group and process.status() != psutil.STATUS_ZOMBIE:
                processes.append(process.pid)
    return processes


def test_a_sweep_killed_with_9_resumes_and_its_workers_are_gone(tmp_path: Path, whole: Sweep) -> None:
    running = started(tmp_path)
    running.kill()
    running.communicate()
    before = finished(tmp_path)
    deadline = time.monotonic() + 30
    while workers_of(running.pid) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not workers_of(running.pid)
    assert 2 <= before < 8
    again = subprocess.run([*command(tmp_path), "--json"], capture_output=True, text=True, timeout=300, check=False)
    assert again.returncode == 0, again.stderr
    summary = json.loads(again.stdout)
    assert summary["complete"]
    assert summary["sample"]["taken_up"] == before
    lines = [json.loads(line) for line in (tmp_path / NAME).read_text().splitlines()[1:]]
    assert sorted(line["variant"] for line in lines) == list(range(8))
    for line in lines:
        assert line["answers"]["hottest_degC"] == pytest.approx(
            whole.outcomes[line["variant"]].answers["hottest_degC"], abs=1e-9
        )


def test_ctrl_c_keeps_what_is_done_and_says_so(tmp_path: Path) -> None:
    running = started(tmp_path)
    os.killpg(running.pid, signal.SIGINT)
    _, output = running.communicate(timeout=60)
    assert running.returncode == 130
    assert "Traceback" not in output, output
    assert "the same command resumes from there" in output
    assert len((tmp_path / "sweep.csv").read_text().splitlines()) == finished(tmp_path) + 1


class Cluster:
    """A real scheduler and real workers, each a process of its own."""

    def __init__(self, folder: Path) -> None:
        self.running: list[subprocess.Popen[bytes]] = []
        self.folder, file = folder, folder / "scheduler.json"
        self.scheduler = self.start("dask_scheduler", "--port", "0", "--scheduler-file", str(file))
        deadline = time.monotonic() + 60
        while not (file.exists() and file.read_text().strip().endswith("}")):
            assert time.monotonic() < deadline
            time.sleep(0.05)
        self.address = json.loads(file.read_text())["address"]
        self.workers = [self.start("dask_worker", self.address, "--nthreads", "1", "--no-nanny") for _ in "ab"]

    def start(self, program: str, *arguments: str) -> subprocess.Popen[bytes]:
        environment = os.environ | {
            "PYTHONPATH": os.pathsep.join([str(Path(__file__).parent), *filter(None, sys.path)])
        }
        words = [sys.executable, "-m", f"distributed.cli.{program}", *arguments, "--no-dashboard"]
        process = subprocess.Popen(words, cwd=self.folder, env=environment, stderr=subprocess.DEVNULL)
        self.running.append(process)
        return process

    def end(self) -> None:
        for process in self.running:
            process.kill()
            process.wait()


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[Cluster]:
    cluster_of_test = Cluster(tmp_path)
    yield cluster_of_test
    cluster_of_test.end()


class After:
    """A scheduler that does something after so many outcomes."""

    def __init__(self, inner: Dask, count: int, deed: Callable[[], None]) -> None:
        self.inner, self.count, self.deed = inner, count, deed

    def outcomes(self, work: Callable[[Any], Outcome], tasks: Sequence[Any]) -> Iterator[tuple[int, Outcome]]:
        for number, outcome in enumerate(self.inner.outcomes(work, tasks), 1):
            yield outcome
            if number == self.count:
                self.deed()


def test_a_cluster_that_loses_a_worker_answers_every_variant_as_one_process_does(
    cluster: Cluster, plan: Plan, whole: Sweep, tmp_path: Path
) -> None:
    inner = Dask(cluster.address, timeout=60)
    inner.client.wait_for_workers(2, timeout=60)
    swept = sweep(plan, scheduler=After(inner, 2, cluster.workers[0].kill), folder=tmp_path / "out", reduced="never")
    inner.close()
    assert cluster.workers[0].wait(10) == -signal.SIGKILL
    assert swept.complete
    assert not swept.failed
    for number, outcome in whole.outcomes.items():
        for name, value in outcome.answers.items():
            same = pytest.approx(value, rel=1e-9, abs=1e-9, nan_ok=True) if isinstance(value, float) else value
            assert swept.outcomes[number].answers[name] == same


def test_a_lost_scheduler_costs_only_what_was_running(
    cluster: Cluster, plan: Plan, whole: Sweep, tmp_path: Path
) -> None:
    inner = Dask(cluster.address, timeout=60)
    swept = sweep(plan, scheduler=After(inner, 3, cluster.scheduler.kill), folder=tmp_path / "out", reduced="never")
    inner.close()
    assert "Dask scheduler" in swept.interrupted
    assert not swept.failed
    assert 3 <= len(swept.outcomes) < 8
    rest = sweep(plan, folder=tmp_path / "out", reduced="never")
    assert rest.complete
    assert rest.resumed == len(swept.outcomes)
    assert rest.table["hottest_degC"].tolist() == pytest.approx(whole.table["hottest_degC"].tolist(), abs=1e-9)
