"""How long a command takes from a cold process: the list of commands, a run without pictures, a run with its report.

Each is a process of its own, in turn with the others, and is compared with a process that only imports numpy and
scipy.sparse: trust the ratios, because seconds depend on the machine and on what else it does. Files are in the
system's cache, bytecode is kept. Prints a table and, as the last line, one JSON object.
Usage: python benchmarks/start.py [--repeat N] [--study NAME]
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

#: What the others are compared with.
BARE = "import numpy, scipy.sparse"


def commands(study: str, folder: Path) -> dict[str, list[str]]:
    """Name -> arguments of Python."""
    run = ["-m", "tyrefem", "run", study, "--quiet", "--out"]
    return {
        "python": ["-c", "pass"],
        BARE: ["-c", BARE],
        "tyrefem --help": ["-m", "tyrefem", "--help"],
        "run, no pictures": [*run, str(folder / "tables"), "--no-pictures"],
        "run with the report": [*run, str(folder / "report")],
    }


def measured(arguments: list[str], environment: dict[str, str]) -> tuple[float, float]:
    """Processor time and wall time of a process, s."""
    before, started = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run([sys.executable, *arguments], stdout=subprocess.DEVNULL, env=environment, check=True)
    wall, after = time.perf_counter() - started, resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, wall


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--study", default="nasa-22x5.5-8pr")
    options = parser.parse_args()
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    environment |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
    with tempfile.TemporaryDirectory() as folder:
        wanted = commands(options.study, Path(folder))
        for arguments in wanted.values():  # bytecode, fonts, the system's cache
            measured(arguments, environment)
        times: dict[str, list[tuple[float, float]]] = {name: [] for name in wanted}
        for _ in range(options.repeat):
            for name, arguments in wanted.items():
                times[name].append(measured(arguments, environment))
    rows = {name: [statistics.median(each) for each in zip(*values, strict=True)] for name, values in times.items()}
    processor, wall = rows[BARE]
    print(f"{'':28} {'processor s':>12} {'ratio':>6} {'wall s':>8} {'ratio':>6}")
    for name, (cpu, clock) in rows.items():
        print(f"{name:28} {cpu:12.2f} {cpu / processor:6.2f} {clock:8.2f} {clock / wall:6.2f}")
    print(json.dumps({
        name: {"processor_s": cpu, "wall_s": clock, "processor_ratio": cpu / processor, "wall_ratio": clock / wall}
        for name, (cpu, clock) in rows.items()
    }))  # fmt: skip


if __name__ == "__main__":
    main()
