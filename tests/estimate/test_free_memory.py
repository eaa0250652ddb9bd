"""Free memory is the least of what the machine, its control group and `ulimit` leave."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

import pytest

from tyrefem.estimates.memory import UNKNOWN, free_memory

pytestmark = pytest.mark.fast

MEMINFO = "MemTotal:       16777216 kB\nMemFree:  1000 kB\nMemAvailable:    8388608 kB\n"
GIB = 2**30


def machine(folder: Path, files: Mapping[str, str]) -> Path:
    for name, text in {"proc/meminfo": MEMINFO, **files}.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return folder


def test_of_a_machine_it_is_what_is_available_not_what_is_unused(tmp_path: Path) -> None:
    assert free_memory(machine(tmp_path, {})) == 8 * GIB


def test_a_container_of_version_2_gives_back_the_files_it_has_read(tmp_path: Path) -> None:
    files = {
        "proc/self/cgroup": "0::/job/step\n",
        "sys/fs/cgroup/job/step/memory.max": "max\n",
        "sys/fs/cgroup/job/memory.max": str(2 * GIB),
        "sys/fs/cgroup/job/memory.current": str(GIB),
        "sys/fs/cgroup/job/memory.stat": f"anon 5\ninactive_file {GIB // 4}\n",
    }
    assert free_memory(machine(tmp_path, files)) == 1.25 * GIB


def test_a_container_sees_its_own_group_at_the_root(tmp_path: Path) -> None:
    files = {
        "proc/self/cgroup": "0::/a/path/of/the/host\n",
        "sys/fs/cgroup/memory.max": str(GIB),
        "sys/fs/cgroup/memory.current": "0",
    }
    assert free_memory(machine(tmp_path, files)) == GIB


@pytest.mark.parametrize(("limit", "free"), [(3 * GIB, 2 * GIB), (2**63 - 4096, 8 * GIB)])
def test_version_1_writes_the_largest_number_for_no_limit(tmp_path: Path, limit: int, free: int) -> None:
    files = {
        "proc/self/cgroup": "9:cpu:/other\n4:memory:/job\n",
        "sys/fs/cgroup/memory/job/memory.limit_in_bytes": str(limit),
        "sys/fs/cgroup/memory/job/memory.usage_in_bytes": str(GIB),
    }
    assert free_memory(machine(tmp_path, files)) == free


def test_a_group_that_is_full_leaves_nothing_and_not_less(tmp_path: Path) -> None:
    files = {
        "proc/self/cgroup": "0::/\n",
        "sys/fs/cgroup/memory.max": "1000",
        "sys/fs/cgroup/memory.current": "2000",
    }
    assert free_memory(machine(tmp_path, files)) == 0


def test_ulimit_counts_what_the_process_has_already(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    resource = pytest.importorskip("resource")
    monkeypatch.setattr(resource, "getrlimit", lambda _kind: (GIB, GIB))
    pages = GIB // 2 // os.sysconf("SC_PAGE_SIZE")
    assert free_memory(machine(tmp_path, {"proc/self/statm": f"{pages} 1 1"})) == GIB / 2


def test_a_machine_without_proc_has_all_its_memory_or_a_stated_guess(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert free_memory(tmp_path) == os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    monkeypatch.delattr(os, "sysconf")
    assert free_memory(tmp_path) == UNKNOWN
