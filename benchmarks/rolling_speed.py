"""Processor time of slip curves at 5,000 nodes and 40 harmonics on one core, beside the cost in three dimensions.

    python benchmarks/rolling_speed.py [--large]        # two minutes; with --large ten more

Goals: 2 s a point after the footprint, 30 s a curve of 20 points; large motion within five times that. Prints a table
and, as its last line, one JSON object.

The cost in three dimensions is an estimate. Small wheels of 27-node hexahedra are factorised; their time over the
number of unknowns is a power law, extrapolated to the same section at every angle of the contact grid round the wheel.
A point of steady-state transport needs several such factorisations (`ITERATIONS`, an estimate), without symmetry.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import time
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

import tyrefem as tf
from tyrefem.mechanics.footprint.example_tyre import PlainTyre
from tyrefem.mechanics.footprint.reference_3d import Hexahedra, angles_near_contact
from tyrefem.mechanics.rolling.rolling_motion import RollingMotion
from tyrefem.mechanics.rolling.wheel_on_road import WheelOnRoad, wheel_on_road

STUDY, LOAD, HARMONICS, POINTS = "passenger-205-55r16", 4000.0, 40, 20
#: Mesh of the study with 5,000 nodes of the mechanics, and a coarser one for large motion.
MESH, LARGE_MESH = "1.4 mm", "1.7 mm"
#: Elements along the meridian, and angles of half a wheel, of the hexahedra that are timed.
HEXAHEDRA = ((4, 6, 5), (6, 8, 6), (8, 10, 8), (10, 14, 10))
#: Factorisations of a point in three dimensions.
ITERATIONS = 5


def curves(wheel: WheelOnRoad) -> dict[str, float]:
    """Seconds of the compliance with free rolling, and of curves over slip angle and over slip."""
    start = time.process_time()
    free = wheel.free(HARMONICS)
    seconds = {"compliance and free rolling": time.process_time() - start}
    angles = [(RollingMotion(float(a), speed=20.0), {"torque": 0.0}) for a in np.radians(np.linspace(0.5, 10, POINTS))]
    slips = [(RollingMotion(speed=20.0), {"slip": float(slip)}) for slip in -np.linspace(0.005, 0.1, POINTS)]
    for name, points in (("slip angle", angles), ("slip", slips)):
        near, each = free, []
        for motion, along in points:
            start = time.process_time()
            near = wheel.roll(motion, along, HARMONICS, near)
            each.append(time.process_time() - start)
        seconds[f"curve over {name}"] = sum(each)
        seconds[f"slowest point over {name}"] = max(each)
    return seconds


def rolled(motion: str, mesh: str, drum: float) -> dict[str, Any]:
    """Nodes, seconds of the footprint and of the curves."""
    start = time.process_time()
    study = tf.study(STUDY, {"mesh.size": mesh})
    wheel = wheel_on_road(study, load=LOAD, drum_diameter=drum, motion=motion)
    pressed = time.process_time() - start
    return {
        "motion": motion,
        "road": "flat" if math.isinf(drum) else f"drum of {drum:g} m",
        "nodes": wheel.pressed.tyre.body.rings.n_nodes,
        "points of the tread": len(wheel.rolling.points.places[0]),
        "inflated and pressed": pressed,
        **curves(wheel),
    }


def three_dimensions(nodes: int) -> dict[str, float]:
    """Seconds of a factorisation of hexahedra, and of a point, extrapolated to both sides of a section of ``nodes``."""
    unknowns, seconds = [], []
    for along, fine, coarse in HEXAHEDRA:
        solid = Hexahedra(PlainTyre().state(along=along), angles_near_contact(0.35, fine, coarse))
        _ = solid.stiffness
        start = time.process_time()
        free, _ = solid.factor
        seconds.append(time.process_time() - start)
        unknowns.append(len(free))
    exponent, constant = np.polyfit(np.log(unknowns), np.log(seconds), 1)
    whole = 3 * 2 * nodes * 2 * HARMONICS
    factor = float(np.exp(constant + exponent * np.log(whole)))
    return {
        "largest timed, unknowns": unknowns[-1],
        "its seconds": seconds[-1],
        "exponent": float(exponent),
        "unknowns": whole,
        "factorisation": factor,
        "point": ITERATIONS * factor,
    }


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--large", action="store_true")
    cases = [("linear", MESH, math.inf), ("linear", MESH, 2.0)]
    if parser.parse_args().large:
        cases.append(("large", LARGE_MESH, math.inf))
    rows = []
    for case in cases:
        rows.append(rolled(*case))
        print("\n".join(f"{key:36} {value if isinstance(value, str | int) else format(value, '.2f')}"
                        for key, value in rows[-1].items()), "\n", flush=True)  # fmt: skip
    solid = three_dimensions(rows[0]["nodes"])
    print("in three dimensions", {key: float(f"{value:.3g}") for key, value in solid.items()})
    point = rows[0]["curve over slip angle"] / POINTS
    ratio = float(f"{solid['point'] / point:.2g}")
    print(json.dumps({"nodes": rows[0]["nodes"], "point_s": round(point, 2), "3D_over_this": ratio}))


if __name__ == "__main__":
    main()
