"""Speed and accuracy of a sweep by a certified reduced model against full runs of every variant.

Seven numbers of the 22x5.5 8PR aircraft tyre vary at once: speed, load, ambient, conductivity of the carcass, tan delta
and specific heat of the tread, film of the contained air. One process, one thread. The time of the reduced sweep holds
everything: training runs, corrections, certification on fresh full runs, and building, marching and answering every
variant. The time of full runs is the median of a few, times the number of variants. Errors are those of full runs that
played no part in training or certification.

With --sweep the box is that of a shipped sweep file, e.g. eight-numbers, whose variants have other shapes: then every
full run has its own mesh and operators.

Prints a table and, as the last line, one JSON object.
Usage: python benchmarks/sweep.py [--quick] [--sweep NAME] [--variants N] [--mesh SIZE] [--tolerance K] [--full N]
       [--set NAME=VALUE]
"""

# ruff: noqa: E402 - the number of BLAS threads must be set before numpy is loaded.
from __future__ import annotations

import os

for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

import argparse
import json
import statistics
import time

import tyrefem
from tyrefem.reduced.packed_model import ReducedTask, pack, perform_reduced
from tyrefem.reduced.surrogate import surrogate, temperature_error
from tyrefem.variants.execution import SweepSettings
from tyrefem.variants.plan import plan_of
from tyrefem.variants.task import perform

BOX = {
    "drive.speed": ("10 mph", "30 mph"),
    "drive.load": ("2000 lbf", "3500 lbf"),
    "drive.ambient": ("10 degC", "30 degC"),
    "materials.carcass.conductivity.value": ("0.15 W/m/K", "0.35 W/m/K"),
    "materials.tread.loss_tangent.value": {"factor": [0.6, 1.4]},
    "materials.tread.specific_heat.value": {"factor": [0.8, 1.2]},
    "boundaries.contained_air.film": ("3 W/m**2/K", "10 W/m**2/K"),
}


class Clock:
    """Wall and processor seconds since it was made."""

    def __init__(self) -> None:
        self.wall, self.cpu = time.perf_counter(), time.process_time()

    def read(self) -> tuple[float, float]:
        """(wall, processor)."""
        return time.perf_counter() - self.wall, time.process_time() - self.cpu


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="coarse mesh, 100 variants, 3 full runs")
    parser.add_argument("--variants", type=int, default=1000)
    parser.add_argument("--mesh", default="1.8 mm")
    parser.add_argument("--tolerance", type=float, default=0.01, help="K, of the certificate")
    parser.add_argument("--full", type=int, default=8, help="full runs that are timed and compared")
    parser.add_argument("--sweep", help="name of a sweep file")
    parser.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE", help="of the study, e.g. strain law"
    )
    options = parser.parse_args()
    if options.quick:
        options.variants, options.mesh, options.full = 100, "8 mm", 3
    changes = {"mesh.size": options.mesh, **dict(each.split("=", 1) for each in options.set)}
    study = tyrefem.study("nasa-22x5.5-8pr", changes)
    if options.sweep:
        from tyrefem.sweep.design import loaded

        plan = loaded(options.sweep, changes, sample="sobol", count=options.variants).plan
        study = plan.study
    else:
        plan = plan_of(study, BOX, sample="sobol", count=options.variants)

    # Of the full runs the first builds mesh and operators: it is not timed.
    chosen = [round(k * (options.variants - 1) / options.full) for k in range(options.full + 1)]
    full, walls, cpus = [], [], []
    for number in chosen:
        clock = Clock()
        full.append(perform(plan.task(number)).answers)
        wall, cpu = clock.read()
        walls.append(wall)
        cpus.append(cpu)
    one = statistics.median(walls[1:]), statistics.median(cpus[1:])

    parts: dict[str, list[float]] = {}
    last = [Clock()]

    def tick(what: str, done: int, total: int) -> None:
        if done == total:
            parts[what] = [a + b for a, b in zip(parts.get(what, [0.0, 0.0]), last[0].read(), strict=True)]
            last[0] = Clock()

    whole = Clock()
    found = surrogate(plan, tolerance=options.tolerance, progress=tick)
    taught = whole.read()
    packed = pack(found.model, plan.packed)
    reduced: list[dict[str, object]] = []
    clock = Clock()
    piece = SweepSettings().piece
    for first in range(0, options.variants, piece):
        task = ReducedTask(plan.variants[first : first + piece], plan.time_to)
        reduced += [outcome.answers for outcome in perform_reduced(task, packed)]
    answered, total = clock.read(), whole.read()

    errors = [temperature_error(reduced[number], answers) for number, answers in zip(chosen, full, strict=True)]
    sensors = [
        max(abs(reduced[number][f"{name}_degC"] - answers[f"{name}_degC"]) for name in study.sensors)  # type: ignore[operator]
        for number, answers in zip(chosen, full, strict=True)
    ]
    nodes, ratio = found.model.operators.size, [options.variants * a / b for a, b in zip(one, total, strict=True)]
    alone = [options.variants * a / b for a, b in zip(one, answered, strict=True)]
    print(f"{nodes} nodes, {len(plan.varied)} numbers, {options.variants} variants; {found.model.size} modes, ", end="")
    print(f"{len(found.model.at_samples)} sample nodes, {found.certificate.amended} corrections\n")
    print(f"{'':34}{'wall s':>10}{'cpu s':>10}")
    rows = [("one full run (median)", one), *parts.items(), ("training and certification", taught)]
    rows += [(f"{options.variants} reduced variants", answered), ("all", total)]
    for name, (wall, cpu) in rows:
        print(f"{name:34}{wall:10.2f}{cpu:10.2f}")
    print(f"{'times faster':34}{ratio[0]:10.1f}{ratio[1]:10.1f}")
    print(f"{'a variant alone, times faster':34}{alone[0]:10.1f}{alone[1]:10.1f}\n")
    print(f"certificate {found.certificate.error:.4f} K of {found.certificate.cases} fresh runs;", end=" ")
    if found.certificate.energies is not None:
        print(f"strain energies learnt within {found.certificate.energies:.2g};", end=" ")
    print(f"{len(errors)} others: {max(errors):.4f} K, sensors {max(sensors):.4f} K")
    print(
        json.dumps(
            {
                "nodes": nodes,
                "numbers": len(plan.varied),
                "variants": options.variants,
                "modes": found.model.size,
                "sample_nodes": len(found.model.at_samples),
                "corrections": found.certificate.amended,
                "full_run_s": one,
                "training_and_certification_s": taught,
                "reduced_s": answered,
                "total_s": total,
                "times_faster": ratio,
                "alone_times_faster": alone,
                "certificate_K": found.certificate.error,
                "other_runs": len(errors),
                "worst_error_K": max(errors),
                "worst_sensor_error_K": max(sensors),
            }
        )
    )


if __name__ == "__main__":
    main()
