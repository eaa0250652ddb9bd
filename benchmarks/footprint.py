"""Time and memory of footprint and loss by harmonics, against mesh and harmonics, and against hexahedra.

    python benchmarks/footprint.py [--quick]

Prints the tables of docs/evidence/footprint.md and, as its last line, one JSON object: seconds and peak memory of
the half section with about 5000 nodes and 40 harmonics, and how much longer one small three-dimensional solve takes.
"""

from __future__ import annotations

import argparse
import json
import resource
import time

from tyrefem import study
from tyrefem.geometry.meshing import build
from tyrefem.materials.loss_tangent import OfTemperature
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.example_tyre import PlainTyre
from tyrefem.mechanics.footprint.harmonic_balance import Balance
from tyrefem.mechanics.footprint.loss import RevolutionLoss
from tyrefem.mechanics.footprint.pressed_tyre import TOLERANCE, mechanical_mesh
from tyrefem.mechanics.footprint.reference_3d import Hexahedra, angles_near_contact
from tyrefem.mechanics.footprint.road import Road
from tyrefem.mechanics.footprint.strain_harmonics import StrainHarmonics
from tyrefem.mechanics.solid.inflation import inflate

MESHES = ((24, (1, 1, 1)), (60, (1, 1, 2)), (130, (1, 2, 6)), (240, (2, 2, 6)))
HARMONICS = (20, 40, 80, 160)
DEFLECTION = 0.02


def peak() -> float:
    """Largest memory of this process so far, MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def by_harmonics(along: int, through: tuple[int, int, int], harmonics: int) -> dict[str, float]:
    """Seconds of each step for one mesh."""
    state = PlainTyre().state(along=along, through=through)
    began = time.perf_counter()
    pressing = Pressing(state)
    _ = pressing.harmonics.matrices
    assembled = time.perf_counter()
    found = pressing.at_load(3000.0, harmonics)
    touched = time.perf_counter()
    loss = RevolutionLoss(StrainHarmonics(found), dict.fromkeys(state.mesh.subdomains, OfTemperature(0.15)), 20.0)
    coefficient = loss.coefficient
    ended = time.perf_counter()
    return {
        "nodes": pressing.harmonics.elements.basis.N,
        "assembly": assembled - began,
        "contact": touched - assembled,
        "loss": ended - touched,
        "total": ended - began,
        "deflection": found.deflection,
        "coefficient": coefficient,
        "peak": peak(),
    }


def real_tyre() -> dict[str, float]:
    """Inflation, footprint and loss of the shipped passenger radial on about 5000 nodes with 40 harmonics."""
    tyre = study("passenger-205-55r16")
    mesh = build(tyre.section, mesher="mapped", size=8e-3, cell="quad", through=2)
    began = time.perf_counter()
    inflated = inflate(tyre, mesh=mesh)
    middle = time.perf_counter()
    found = Pressing(inflated.state, Road(2.0)).at_load(4825.0, 40)
    touched = time.perf_counter()
    laws = {region: tyre.materials[region].loss_tangent.over_frequency for region in inflated.body.parts}
    coefficient = RevolutionLoss(StrainHarmonics(found), laws, 22.2, 25.0).coefficient
    ended = time.perf_counter()
    return {
        "nodes": inflated.body.rings.n_nodes,
        "inflation": middle - began,
        "footprint": touched - middle,
        "loss": ended - touched,
        "total": ended - began,
        "deflection": found.deflection,
        "coefficient": coefficient,
        "peak": peak(),
    }


def against_hexahedra() -> dict[str, float]:
    """The same small tyre both ways."""
    state = PlainTyre().state(along=10)
    began = time.perf_counter()
    flat = Pressing(state).at_deflection(DEFLECTION, 54)
    middle = time.perf_counter()
    solid = Hexahedra(state, angles_near_contact(0.35, 10, 8))
    pressed = solid.at_deflection(DEFLECTION)
    ended = time.perf_counter()
    return {
        "harmonics_s": middle - began,
        "hexahedra_s": ended - middle,
        "unknowns": 3 * solid.basis.N,
        "load_ratio": flat.load / pressed.load,
    }


def in_large_motion() -> dict[str, float]:
    """Processor seconds of the passenger at its rated load in large motion, linear, and of the truck's inflation."""
    tyre = study("passenger-205-55r16")
    began = time.process_time()
    inflated = inflate(tyre, mesh=mechanical_mesh(tyre, large=True))
    middle = time.process_time()
    linear = Pressing(inflated.state, Road(2.0)).solve(load=4825.0, tolerance=TOLERANCE)
    touched = time.process_time()
    balance = Balance(Pressing(inflated.state, Road(2.0)))
    large = balance.solve(load=4825.0, tolerance=TOLERANCE)
    ended = time.process_time()
    truck = inflate(study("truck-295-80r22.5"))
    return {
        "inflation": middle - began,
        "linear": touched - middle,
        "large": ended - touched,
        "truck": time.process_time() - ended,
        "truck_steps": float(len(truck.equilibrium.steps)),
        "softer": large.deflection / linear.deflection,
        "harmonics": large.harmonics,
    }


def main() -> None:
    """Run the tables."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--quick", action="store_true", help="only the mesh of about 5000 nodes with 40 harmonics")
    quick = parser.parse_args().quick
    print("| nodes | harmonics | assembly, s | contact at 3 kN, s | fields and loss, s | total, s | peak memory, MB |")
    print("|---|---|---|---|---|---|---|")
    cases = [(mesh, n) for mesh in MESHES[:3] for n in HARMONICS] + [(MESHES[3], 40)]
    goal: dict[str, float] = {}
    for (along, through), n in [(MESHES[2], 40)] if quick else cases:
        row = by_harmonics(along, through, n)
        parts = " | ".join(f"{row[name]:.2f}" for name in ("assembly", "contact", "loss", "total"))
        print(f"| {row['nodes']:.0f} | {n} | {parts} | {row['peak']:.0f} |", flush=True)
        if (along, n) == (MESHES[2][0], 40):
            goal = row
    real = real_tyre()
    print(
        f"\npassenger radial, {real['nodes']:.0f} nodes, 40 harmonics: inflation {real['inflation']:.1f} s, footprint "
        f"{real['footprint']:.1f} s, loss {real['loss']:.1f} s, together {real['total']:.1f} s; {real['peak']:.0f} MB; "
        f"{real['deflection'] * 1e3:.2f} mm, coefficient {real['coefficient']:.4f}"
    )
    solid = against_hexahedra()
    ratio = solid["hexahedra_s"] / solid["harmonics_s"]
    print(
        f"\nhexahedra with {solid['unknowns']:.0f} unknowns: {solid['hexahedra_s']:.1f} s, by harmonics "
        f"{solid['harmonics_s']:.2f} s, {ratio:.0f} times less; load {solid['load_ratio']:.4f} of theirs"
    )
    large = in_large_motion()
    print(
        f"\npassenger in large motion, {large['harmonics']:.0f} harmonics: inflation {large['inflation']:.1f} s of "
        f"processor time, footprint {large['large']:.1f} s, {large['large'] / large['linear']:.0f} times the linear "
        f"one, deflection {large['softer']:.3f} of it; truck inflated in {large['truck']:.1f} s, "
        f"{large['truck_steps']:.0f} load steps"
    )
    summary = {"seconds": round(goal["total"], 2), "peak_MB": round(goal["peak"]), "hexahedra": round(ratio, 1)}
    summary["large_motion_over_linear"] = round(large["large"] / large["linear"], 1)
    print(json.dumps({**summary, "real_tyre_seconds": round(real["total"], 2)}))


if __name__ == "__main__":
    main()
