"""How long a comparison with uncertain inputs takes, where strain cycles are by finite elements in large motion.

Drives of a radial at other loads and pressures are simulated, and compared with their own readings as if these were
measured. A changed stiffness by a run of its own, from the free tyre, is what every changed stiffness of every drive
would cost; its readings show what the comparison's start from a nearby footprint changes. All in one process: trust the
ratios, because seconds depend on the machine and on what else it does. Prints a table and, as the last line, one JSON
object.
Usage: python benchmarks/compare.py [--study NAME] [--drives N] [--size "3 mm"] [--keys N]
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from pathlib import Path
from typing import Any

import tyrefem as tf
from tyrefem.mechanics.cycle_schedule import same_cycles
from tyrefem.mechanics.footprint.pressed_tyre import REMEMBERED_TYRES

#: Load and pressure of each drive over those of the study.
DRIVES = ((1.0, 1.0), (1.15, 1.0), (1.0, 1.1))


def timed(function: Any) -> tuple[Any, float]:
    """What a function gives, and its processor time, s; tyres that were pressed before are forgotten."""
    REMEMBERED_TYRES.clear()
    start = time.process_time()
    answer = function()
    return answer, time.process_time() - start


def with_measured(study: tf.Study, drives: list[dict[str, Any]], folder: Path) -> tuple[tf.Study, list[float]]:
    """The study with what it computes at its drives as measured runs, 1 K warmer; processor time of each run, s."""
    entries, times = [], []
    for number, drive in enumerate(drives):
        result, seconds = timed(study.with_drive(drive).run)
        table = result.readings
        for name in table.columns[1:]:
            table[name] = table[name] + 1.0
        table.columns = ["time [s]", *(f"{name} [degC]" for name in table.columns[1:])]
        file = folder / f"run-{number + 1}.csv"
        table.to_csv(file, index=False)
        entries.append({"table": str(file), "drive": drive, "noise": "0.3 delta_degC"})
        times.append(seconds)
    return study.replace({"measured": entries}), times


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--study", default="aircraft-radial")
    parser.add_argument("--drives", type=int, default=len(DRIVES), help="number of drives, up to 3")
    parser.add_argument("--size", default="", help="of the mesh; default: the study's")
    parser.add_argument(
        "--keys", type=int, default=1, help="number of stiffness values that are run from the free tyre"
    )
    options = parser.parse_args()
    study = tf.study(options.study, {"mesh.size": options.size} if options.size else None)
    phase = study.card.drive.phases[0]
    drives = [
        {"load": f"{load * phase.load.start} N", "pressure": f"{pressure * phase.pressure.start} Pa"}
        for load, pressure in DRIVES[: options.drives]
    ]
    raised = {key: study.scaled(key, 1.0 + sd) for key, sd in study.uncertainty.items()}
    stiff = [key for key, changed in raised.items() if not same_cycles(changed, study)]
    with tempfile.TemporaryDirectory() as folder:
        measured, as_driven = with_measured(study, drives, Path(folder))
        comparison, seconds = timed(measured.compare)
    changes = comparison.inputs[comparison.inputs["phase"] == "all"].set_index(["run", "sensor", "key"])["change_K"]
    base = study.with_drive(drives[0])
    unchanged = timed(base.run)[0].readings
    alone, worst, largest = [], 0.0, 0.0
    for key in [key for key in stiff if "loss_tangent" not in key][-options.keys :]:
        result, each = timed(base.scaled(key, 1.0 + study.uncertainty[key]).run)
        alone.append(each)
        expected = (result.readings - unchanged).drop(columns="time_s").mean()
        of_run = changes.xs((comparison.residuals["run"].iloc[0], key), level=("run", "key"))
        worst = max(worst, float((of_run - expected).abs().max()))
        largest = max(largest, float(expected.abs().max()))
    each = sum(alone) / len(alone)
    before = sum(as_driven) + each * len(stiff) * len(drives)
    print(comparison.summary, *comparison.notes, sep="\n")
    print(f"{len(drives)} drives, {len(raised)} uncertain inputs, {len(stiff)} of them change the strain cycle")
    print(f"{'run of a drive':44} {sum(as_driven) / len(drives):8.1f} s")
    print(f"{'changed stiffness, from the free tyre':44} {each:8.1f} s")
    print(f"{'all of them from the free tyre':44} {before:8.1f} s")
    print(f"{'comparison':44} {seconds:8.1f} s  {before / seconds:.1f} times faster, {seconds / each:.1f} runs")
    print(f"changes of means by {len(alone)} stiffness: off by {worst:.3g} K at most, of {largest:.3g} K")
    numbers = {"run_s": sum(as_driven) / len(drives), "changed_run_s": each, "from_free_tyre_s": before}
    numbers |= {"comparison_s": seconds, "ratio": before / seconds, "difference_K": worst, "change_K": largest}
    cases = {"drives": len(drives), "inputs": len(raised), "changed_cycles": len(stiff) * len(drives)}
    print(json.dumps({"study": options.study, **cases, **numbers}))


if __name__ == "__main__":
    main()
