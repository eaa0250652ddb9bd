"""A diagnosis of data by another code: the NASA report's own network of 33 elements, with an effect hidden or none.

    python benchmarks/network_data.py                  # four cases, 12 minutes
    python benchmarks/network_data.py --cases wind

Data: the four runs and eight thermocouples of `hidden-effect` by finite differences on the report's slice, with its own
films, conductivity and capacity (`tests/studies/report_network.py`), and 0.5 K noise. Strain energy and loss tangent
are the study's. The network differs from the study by 8 to 13 K before anything is hidden. Prints a line for each case
as a row of a table: verdict, names, what may act beside other causes, rms of the held-out run as written and after.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import tyrefem as tf
from tyrefem.diagnose import diagnose
from tyrefem.diagnose.forward.sampling import DriveSampling
from tyrefem.diagnose.layout.planned_runs import planned
from tyrefem.diagnose.numbers import percent
from tyrefem.diagnose.words.discrepancy_record import possible_effects
from tyrefem.measured import MeasuredRun
from tyrefem.simulation.rolling_tyre import RollingTyre

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "studies"))

from report_network import Slice, nodes

Array = NDArray[np.float64]
#: What is hidden: arguments of `Slice.rate`.
CASES = {"nothing": {}, "hot road": {"road": 28.0}, "wind": {"wind": 8.0}, "brake": {"rim": 40.0}}
#: Rolling, then standing, s; time between readings, s; noise, K.
ROLLING, END, EVERY, NOISE = 900.0, 1500.0, 10.0, 0.5


def histories(study: tf.Study, times: Array, hidden: dict[str, float]) -> tuple[Array, Array]:
    """Temperatures (n, 11, 3) of the elements and (n,) of the contained air, degC."""
    tyre = RollingTyre(study)
    model = Slice("8PR", tyre)
    phase = study.card.drive.phases[0]
    speed, ambient = float(phase.speed.at(0.0)), float(tyre.ambient(0.0))
    state, parts = np.full(34, ambient), []
    for begin, end, rolls in ((0.0, ROLLING, True), (ROLLING, END, False)):
        revolutions = tyre.schedule.revolutions_per_second(begin + 1.0) if rolls else 0.0
        inside = times[(times >= begin) & (times < end)]

        def rate(_time: float, y: Array, turns: float = revolutions, v: float = speed if rolls else 0.0) -> Array:
            return np.asarray(model.rate(y, turns, v, ambient, **hidden))

        solved = solve_ivp(rate, (begin, end), state, method="BDF", rtol=1e-6, dense_output=True)
        parts.append(solved.sol(inside).T)
        state = solved.y[:, -1]
    whole = np.concatenate(parts)
    return whole[:, :-1].reshape(-1, 11, 3), whole[:, -1]


def measured(study: tf.Study, drive: DriveSampling, rng: np.random.Generator, hidden: dict[str, float]) -> MeasuredRun:
    """A run of the network, read at the study's thermocouples between its nodes, with noise."""
    driven = study.at_run(drive.name, drive.drive)
    times = np.arange(0.0, END, EVERY) + rng.uniform(0.0, EVERY, int(END / EVERY))
    elements, gas = histories(driven, times, hidden)
    s, depth = nodes("8PR", driven.section)
    rows = np.argsort(s[:, 1])
    table = {}
    for name, sensor in driven.sensors.items():
        in_rows = np.array([[np.interp(sensor.depth, depth[row], T[row]) for row in rows] for T in elements])
        table[name] = np.array([np.interp(sensor.s, s[rows, 1], along) for along in in_rows])
    frame = pd.DataFrame(table | {"contained-air": gas})
    return MeasuredRun(drive.name, times, frame + rng.normal(0.0, NOISE, frame.shape))


def main() -> None:
    """Diagnose the cases."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", nargs="+", default=list(CASES), choices=list(CASES))
    parser.add_argument("--seed", type=int, default=5)
    given = parser.parse_args()
    study = tf.study("hidden-effect")
    print("| hidden | verdict | named | may act beside | held-out rms, K | processor s |\n|---|---|---|---|---|---|")
    for name in given.cases:
        rng, began = np.random.default_rng(given.seed), time.process_time()
        data = [measured(study, drive, rng, CASES[name]) for drive in planned(study)]
        d = diagnose(study, data, rerun=False, looks=1, workers=1)
        named = " + ".join(member.key for member in d.best.members) or "-"
        may = ", ".join(f"{key} {percent(share)}" for key, share in possible_effects(d).items() if share > 0.5) or "-"
        rms = " to ".join(f"{d.rms(after=after, held_out=True):.1f}" for after in (False, True))
        row = (name, d.verdict, named, may, rms, f"{time.process_time() - began:.0f}")
        print(f"| {' | '.join(row)} |", flush=True)


if __name__ == "__main__":
    main()
