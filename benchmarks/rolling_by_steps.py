"""The plain tyre rolled step by step in time, in three dimensions, beside its steady state by harmonics.

    python benchmarks/rolling_by_steps.py        # writes docs/evidence/tables/rolling-by-steps.csv, four minutes

Both have the same section. Deflection, travel per radian and slip angle are given; forces, moments and friction power
are compared. Deviations of F_x and F_y are over the horizontal force: F_x of a freely rolling tyre is almost nothing.
"""

from __future__ import annotations

import csv
import math
import os
import time
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.example_tyre import PlainTyre
from tyrefem.mechanics.rolling.rolling_in_steps import RollingInSteps
from tyrefem.mechanics.rolling.rolling_motion import RollingMotion
from tyrefem.mechanics.rolling.steady_rolling import RollingLoads, SteadyRolling
from tyrefem.mechanics.rolling.wheel_of_hexahedra import WheelOfHexahedra

TABLE = Path(__file__).resolve().parents[1] / "docs" / "evidence" / "tables" / "rolling-by-steps.csv"
ALONG, DEFLECTION, FRICTION, HARMONICS, TURNS = 4, 0.02, 1.0, 180, 1.2
#: Slip angle, deg, and slip.
POINTS = ((2.0, 0.0), (0.0, 0.02), (4.0, -0.02))
#: Sectors of the wheel, and steps from level to level.
MESHES = ((40, 8), (60, 8), (100, 2), (100, 4), (100, 8))
QUANTITIES = ("F_x [N]", "F_y [N]", "F_z [N]", "M_z [N m]", "torque [N m]", "friction power at 1 m/s [W]")


def deviations(computed: NDArray[np.float64], exact: NDArray[np.float64]) -> NDArray[np.float64]:
    """(6,) deviations; of F_x and F_y over the horizontal force, of the torque over that force times 0.3 m."""
    level = float(np.hypot(*exact[:2]))
    scale = np.array([level, level, *np.maximum(np.abs(exact[2:4]), 1e-3 * level), 0.3 * level, exact[5]])
    return np.asarray((computed - exact) / scale)


def main() -> None:
    """Write and print the table."""
    state = PlainTyre(half=False).state(along=ALONG)
    tyre = SteadyRolling(Pressing(state), 0.0, FRICTION)
    free = tyre.roll(RollingMotion(), RollingLoads(deflection=DEFLECTION, torque=0.0), HARMONICS)
    wheels = {sectors: WheelOfHexahedra(state, sectors) for sectors, _ in MESHES}
    with TABLE.open("w", encoding="utf-8", newline="") as stream:
        table = csv.writer(stream, lineterminator="\n")
        names = [f"{name}, {kind}" for name in QUANTITIES for kind in ("steady", "in steps", "deviation [%]")]
        table.writerow(["slip angle [deg]", "slip", "nodes round the wheel", "angle of a step [mrad]", *names])
        for degrees, slip in POINTS:
            angle = math.radians(degrees)
            travel = free.travel / ((1 + slip) * math.cos(angle))
            steady = tyre.roll(RollingMotion(angle), RollingLoads(deflection=DEFLECTION, travel=travel), HARMONICS)
            exact = np.array([*steady.force, steady.moment[2], steady.torque, steady.friction_power])
            for sectors, substeps in MESHES:
                start = time.process_time()
                rolling = RollingInSteps(wheels[sectors], DEFLECTION, travel, angle, FRICTION, substeps)
                values, change = rolling.steady(rolling.run(TURNS))
                row: list[float] = []
                for triple in zip(exact, values, 100 * deviations(values, exact), strict=True):
                    row.extend(triple)
                step = 1e3 * rolling.step
                words = [f"{degrees:g}", f"{slip:g}", str(2 * sectors), f"{step:.3g}", *(f"{v:.4g}" for v in row)]
                table.writerow(words)
                print(*words[:4], *(f"{v:+.2f}" for v in row[2::3]), f"change {change:.1e}",
                      f"{time.process_time() - start:.0f} s", flush=True)  # fmt: skip


if __name__ == "__main__":
    main()
