"""A diagnosis of data whose strain energy comes from another strain law, with a hot road or nothing hidden.

    python benchmarks/far_mechanics.py                      # the law by finite elements, in large motion: 15 minutes
    python benchmarks/far_mechanics.py --law barrel --hot 0

Data: `hidden-effect` by the other law on a finer mesh, its four runs and eight thermocouples, 0.5 K noise, base numbers
and sensors off by 0.3 of a draw from their priors. Prints a line for each case: verdict, names, rms of the held-out run
as written and after, and processor seconds; then the first sentences.
"""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Sequence
from dataclasses import replace

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

import tyrefem as tf
from tyrefem.diagnose import diagnose
from tyrefem.diagnose.blind.blind_case import BlindCase, cases
from tyrefem.diagnose.blind.synthetic import Logger, record
from tyrefem.diagnose.layout.planned_runs import planned
from tyrefem.diagnose.unknowns.candidates import catalogue_candidates
from tyrefem.diagnose.unknowns.unknown import with_values
from tyrefem.diagnose.words.sentences import verdict_words
from tyrefem.inputs.study import StudyData
from tyrefem.measured import MeasuredRun

#: Share of a draw from the priors by which base numbers and sensors are off.
OFF = 0.3
#: Mesh of the data.
MESH = "5 mm"


def truth(study: StudyData, seed: int, warmer_by: float) -> BlindCase:
    """Nothing hidden but a road that is warmer, K."""
    case = next(each for each in cases(study, 10, seed) if each.kind == "none")
    values = {unknown: OFF * x for unknown, x in case.values.items()}
    if warmer_by:
        road = next(each for each in catalogue_candidates(study) if each.name == "hot-road")
        values |= dict.fromkeys(road.amplitudes, warmer_by)
    return replace(case, values=values)


def measured(study: StudyData, case: BlindCase, law: str) -> list[MeasuredRun]:
    """The runs of a case by another strain law."""
    runs = []
    for number, drive in enumerate(planned(study)):
        driven = with_values(study.at_run(drive.name, drive.drive), case.values)
        rng = np.random.default_rng([case.seed, number])
        runs.append(record(driven.replace({"mesh.size": MESH, "mechanics.strain": law}), drive.name, Logger(), rng))
    return runs


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the cases."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--law", default="fem", help="strain law of the data (fem)")
    parser.add_argument("--hot", type=float, nargs="*", default=[25.0, 0.0], help="road warmer than stated, K (25, 0)")
    parser.add_argument("--seed", type=int, default=5)
    parser.add_argument("--largest", type=int, default=3, help="most effects in a set (3)")
    given = parser.parse_args(arguments)
    study = tf.study("hidden-effect")
    for warmer_by in given.hot:
        runs = measured(study, truth(study, given.seed, warmer_by), given.law)
        began = time.process_time()
        d = diagnose(study, runs, largest=given.largest, rerun=False, looks=1)
        before, after = (d.rms(after=each, held_out=True) for each in (False, True))
        names = ", ".join(member.key for member in d.best.members) or "-"
        taken = d.better_law.trial.law if d.better_law else "-"
        seconds = time.process_time() - began
        print(f"{given.law} +{warmer_by:g} K: {d.verdict}; named: {names}; law taken: {taken}; held out "
              f"{before:.1f} -> {after:.1f} K; {seconds:.0f} s", flush=True)  # fmt: skip
        print("  " + "\n  ".join(verdict_words(d)[:4]))


if __name__ == "__main__":
    main()
