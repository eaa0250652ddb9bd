"""Linear algebra uses one thread, in the shell unless the environment names a number."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import psutil
import pytest
import scipy.linalg  # noqa: F401 - loads libraries that count their threads
from threadpoolctl import threadpool_info, threadpool_limits

import tyrefem as tf
from tyrefem.threads import VARIABLES, one_thread, one_thread_by_default, usable_cores

#: A command, and then the numbers of threads of its libraries.
COMMAND = """
import sys
from tyrefem.cli import main
sys.argv = ["tyrefem", "check", "nasa-22x5.5-8pr"]
try:
    main()
except SystemExit as end:
    assert not end.code
import scipy.linalg
from threadpoolctl import threadpool_info
print(*{library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"})
"""


def threads() -> set[int]:
    """Numbers of threads of the loaded libraries for linear algebra."""
    return {library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"}


@pytest.mark.parametrize("given", [{}, {"OPENBLAS_NUM_THREADS": "3"}, {"OMP_NUM_THREADS": "2"}])
def test_a_number_in_the_environment_is_left(given: dict[str, str], monkeypatch: pytest.MonkeyPatch) -> None:
    environment = dict(given)
    monkeypatch.setattr(os, "environ", environment)
    one_thread_by_default()
    assert environment == (given or dict.fromkeys(VARIABLES, "1"))


def test_a_run_computes_with_one_thread_and_gives_the_others_back() -> None:
    seen: list[set[int]] = []
    study = tf.study("nasa-22x5.5-8pr", {"mesh.size": "10 mm", "drive.duration": "20 s"})
    with threadpool_limits(2, user_api="blas"):
        before = threads()
        with one_thread():
            assert threads() == {1}
        study.run(progress=lambda _: seen.append(threads()))
        assert threads() == before
    assert seen
    assert all(each == {1} for each in seen)


@pytest.mark.skipif(psutil.cpu_count() == 1, reason="one core has one thread anyway")
@pytest.mark.parametrize("given", [{}, {"OMP_NUM_THREADS": "2"}])
def test_a_command_has_as_many_threads_as_the_environment_says_else_one(given: dict[str, str]) -> None:
    environment = {name: value for name, value in os.environ.items() if name not in VARIABLES} | given
    told = subprocess.run(
        [sys.executable, "-c", COMMAND], capture_output=True, text=True, env=environment, timeout=120, check=True
    )
    assert told.stdout.splitlines()[-1] == given.get("OMP_NUM_THREADS", "1")


def test_a_process_with_few_cores_uses_no_more(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "cpu_count", lambda: 64)
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(16)), raising=False)
    assert usable_cores(str(tmp_path)) == 16
    group = tmp_path / "sys/fs/cgroup"
    (group / "cpu").mkdir(parents=True)
    for version_1, version_2, cores in ((-1, "max", 16), (150_000, "max", 2), (-1, "400000", 4), (10_000, "max", 1)):
        (group / "cpu/cpu.cfs_quota_us").write_text(f"{version_1}\n")
        (group / "cpu/cpu.cfs_period_us").write_text("100000\n")
        (group / "cpu.max").write_text(f"{version_2} 100000\n")
        assert usable_cores(str(tmp_path)) == cores
