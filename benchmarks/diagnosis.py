"""How long a diagnosis takes: four runs, eight histories, all effects of the catalogue.

    python benchmarks/diagnosis.py [--workers 2]

Prints the parts for people and, as its last line, one JSON object: seconds, and what the same sensitivities would cost
by simulating every run again for every unknown.
"""

from __future__ import annotations

import argparse
import json
import os
import time

import tyrefem as tf
from tyrefem.compare.experiment import experiments
from tyrefem.diagnose.data.runs import measured_drive
from tyrefem.diagnose.data.sensitivities import responses, unknowns_of
from tyrefem.diagnose.forward.evaluations import evaluating
from tyrefem.diagnose.forward.forward_model import ForwardModel
from tyrefem.diagnose.unknowns.candidates import catalogue_candidates
from tyrefem.diagnose.workflow import diagnose
from tyrefem.simulation.surroundings import GAS


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--study", default="hidden-effect")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    given = parser.parse_args()
    study = tf.study(given.study)
    model = ForwardModel(study, tuple(measured_drive(one, study).sampling for one in experiments(study)))
    unknowns, nuisance = unknowns_of(study, [*study.sensors, GAS], catalogue_candidates(study))
    began = time.perf_counter()
    model.driven(study, 0).run()
    one_run = time.perf_counter() - began
    began = time.perf_counter()
    with evaluating(model, given.workers) as evaluations:
        known = responses(evaluations, unknowns)
    sensitivities = time.perf_counter() - began
    began = time.perf_counter()
    found = diagnose(study, workers=given.workers, known=known, looks=1)
    rest = time.perf_counter() - began
    again = one_run * len(model.drives) * sum(not one.measures for one in unknowns) / given.workers
    print(f"{len(model.drives)} runs, {len(study.sensors) + 1} histories, {len(found.candidates)} candidates, "
          f"{len(unknowns)} unknowns, {nuisance} of them in every model")  # fmt: skip
    print(f"sensitivities {sensitivities:.1f} s (by simulating again: about {again:.0f} s)")
    print(f"search, fits, amended study {rest:.1f} s: {found.verdict}, {found.judgement.best.key}")
    print(json.dumps({
        "seconds": sensitivities + rest,
        "sensitivities_s": sensitivities,
        "search_s": rest,
        "speedup_of_sensitivities": again / sensitivities,
        "workers": given.workers,
    }))  # fmt: skip


if __name__ == "__main__":
    main()
