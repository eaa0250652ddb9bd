"""Microseconds of a 1 s step of the real-time model: steady inputs and ones that change every step; Python and FMU.

    python benchmarks/realtime.py [FILE.npz] [--quick]

Without a file a model of the 22x5.5 8PR on a coarse mesh is trained first. Times are of this process's own work
(CPU), best of five; the wall clock's 99th percentile tells what the machine makes of it. The FMU is driven through
fmpy, set and get included. Prints a table and, as its last line, one JSON object.
"""

# ruff: noqa: E402 - the number of BLAS threads must be set before numpy is loaded.
from __future__ import annotations

import os

for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

import argparse
import json
import shutil
import tempfile
import time
from collections.abc import Callable
from dataclasses import astuple
from pathlib import Path

import numpy as np

from tyrefem.realtime.tyre import Inputs, RealTimeTyre

STEPS, REPEATS = 500, 5


def timed(step: Callable[[Inputs], object], drive: list[Inputs]) -> tuple[float, float]:
    """Microseconds per step: best mean CPU time, and the 99th percentile of the wall clock."""
    means, walls = [], []
    for _ in range(REPEATS):
        began = time.process_time()
        for inputs in drive:
            before = time.perf_counter()
            step(inputs)
            walls.append(time.perf_counter() - before)
        means.append((time.process_time() - began) / len(drive))
    return min(means) * 1e6, float(np.percentile(walls, 99)) * 1e6


def drives(tyre: RealTimeTyre) -> dict[str, list[Inputs]]:
    """Steady inputs in the middle of the box, and random ones every step."""
    low, high = np.array(list(tyre.box.values())).T
    places = np.random.default_rng(1).random((STEPS, 5))
    return {
        "steady": [Inputs(*((low + high) / 2).tolist())] * STEPS,
        "changing": [Inputs(*one) for one in (low + (high - low) * places).tolist()],
    }


def unit(file: Path, folder: Path) -> Callable[[Inputs], object] | None:
    """A step of the FMU through fmpy; None without a C compiler."""
    if shutil.which("cc") is None:
        return None
    import fmpy
    from fmpy.fmi2 import FMU2Slave

    from tyrefem.realtime.fmu import write_fmu

    path = str(write_fmu(file, folder / "tyre.fmu"))
    found = FMU2Slave(
        guid=fmpy.read_model_description(path).guid,
        unzipDirectory=fmpy.extract(path, str(folder / "unit")),
        modelIdentifier="tyre",
        instanceName="one",
    )
    found.instantiate()
    found.setupExperiment(startTime=0.0)
    found.enterInitializationMode()
    found.exitInitializationMode()
    references = list(range(10, 10 + len(RealTimeTyre(file).names)))

    def step(inputs: Inputs) -> object:
        found.setReal([0, 1, 2, 3, 4], list(astuple(inputs)))
        found.doStep(0.0, 1.0)
        return found.getReal(references)

    return step


def main() -> None:
    """Run the table."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("file", nargs="?", type=Path, help="a file of tyrefem export")
    parser.add_argument("--quick", action="store_true", help="train on short drives")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder, file = Path(name), options.file
        if file is None:
            from tyrefem import study
            from tyrefem.realtime.certificate import export

            file = folder / "tyre.npz"
            tyre_study = study("nasa-22x5.5-8pr", {"mesh.size": "6 mm"})
            export(tyre_study, file, duration=60.0 if options.quick else None, tolerance=0.5)
        tyre = RealTimeTyre(file)
        rows = [("Python", lambda inputs: tyre.step(1.0, inputs))]
        compiled = unit(file, folder)
        if compiled is not None:
            rows.append(("FMU", compiled))
        print(f"{tyre.about['modes']} modes, {len(tyre.names)} outputs, {file.stat().st_size / 1e3:.0f} kB")
        print("| | inputs | CPU per step, us | 99th percentile of the wall clock, us |")
        print("|---|---|---|---|")
        summary: dict[str, float] = {}
        for what, step in rows:
            for kind, drive in drives(tyre).items():
                mean, late = timed(step, drive)
                print(f"| {what} | {kind} | {mean:.0f} | {late:.0f} |", flush=True)
                summary[f"{what.lower()}_{kind}_us"] = round(mean, 1)
    print(json.dumps(summary))


if __name__ == "__main__":
    main()
