"""Coverage and effectivity of estimated errors: fresh variants by a reduced model and by tight full runs.

The true error of a variant is the largest difference of its temperature answers to a full run on the same mesh with a
time error of 0.001 K; effectivity is the estimate over the true error. No variant played a part in training.

Prints a table. Usage: python benchmarks/error_estimate.py [--sweep NAME] [--mesh SIZE] [--count N] [--seed N]
"""

# ruff: noqa: E402 - the number of BLAS threads must be set before numpy is loaded.
from __future__ import annotations

import os

for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

import argparse
import time

import numpy as np
from sweep import BOX

import tyrefem
from tyrefem.reduced.surrogate import surrogate, temperature_error
from tyrefem.simulation.run import run
from tyrefem.sweep.design import loaded
from tyrefem.variants.answers import answers
from tyrefem.variants.plan import plan_of


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sweep", help="name of a sweep file; else seven numbers of the 22x5.5 8PR")
    parser.add_argument("--mesh", default="3 mm")
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=2, help="of the Sobol sequence")
    parser.add_argument("--tolerance", type=float, default=0.01, help="K, of the certificate")
    options = parser.parse_args()
    mesh, drawn = (
        {"mesh.size": options.mesh},
        {"sample": "sobol", "count": max(options.count, 64), "seed": options.seed},
    )
    if options.sweep:
        plan = loaded(options.sweep, mesh, **drawn).plan
    else:
        plan = plan_of(tyrefem.study("nasa-22x5.5-8pr", mesh), BOX, **drawn)
    certified = surrogate(plan, tolerance=options.tolerance)
    studies = [plan.study.replace(plan.variants[number]) for number in range(options.count)]
    began = time.process_time()
    outcomes = certified.answers(studies)
    each = (time.process_time() - began) / options.count
    true, estimates = [], []
    for study, outcome in zip(studies, outcomes, strict=True):
        full = answers(run(study.replace({"numerics.tolerance": "0.001 delta_degC"}), like=certified.model.base))
        true.append(temperature_error(outcome.answers, full))
        estimates.append(outcome.error)
    ratio = np.array(estimates) / true
    print(f"{certified.model.size} modes, {certified.model.further.shape[1]} further; certificate", end=" ")
    print(f"{certified.certificate.worst:.4f} K; {each * 1e3:.1f} ms per variant")
    print(f"true error: median {np.median(true):.4f}, largest {max(true):.4f} K; ", end="")
    print(f"above the tolerance: {np.mean(np.array(true) > options.tolerance):.1%}")
    print(f"estimate:   median {np.median(estimates):.4f}, largest {max(estimates):.4f} K")
    print(f"held: {int((ratio >= 1).sum())} of {options.count}; with the tolerance's tenth added:", end=" ")
    print(int((np.array(estimates) + 0.1 * options.tolerance >= true).sum()))
    print("effectivity: least, 5 %, median, 95 %, largest", *np.quantile(ratio, [0, 0.05, 0.5, 0.95, 1]).round(2))


if __name__ == "__main__":
    main()
