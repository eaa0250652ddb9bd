"""How much the mesh matters: every sensor of the shipped NASA studies against a fine quadratic mesh.

    python benchmarks/mesh_convergence.py [--quick]

Prints a table (that of docs/evidence/sections-and-meshes.md) and, as its last line, one JSON object: the largest
deviation of any sensor over each run, K, and the largest difference between the two meshers at default size.
"""

from __future__ import annotations

import argparse
import json
import time

import tyrefem as tf

STUDIES = ("nasa-22x5.5-8pr", "nasa-22x5.5-12pr")
REFERENCE = {"mesh.element": "P2", "mesh.size": "1 mm"}
MESHES = [
    (mesher, element, size)
    for mesher in ("mapped", "gmsh")
    for element, sizes in (("P1", ("4 mm", "2 mm", "1 mm")), ("P2", ("4 mm", "3 mm", "2 mm")))
    for size in sizes
]
DEFAULT = ("P2", "3 mm")


def main() -> None:
    """Run the table."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--quick", action="store_true", help="only the default element and size")
    quick = parser.parse_args().quick
    meshes = [mesh for mesh in MESHES if not quick or mesh[1:] == DEFAULT]
    worst: dict[str, float] = {}
    apart: dict[str, float] = {}
    print("| study | mesher | element | size | nodes | unknowns | largest deviation of a sensor, K | run, s |")
    print("|---|---|---|---|---|---|---|---|")
    for name in STUDIES:
        study = tf.study(name)
        fine = study.replace(REFERENCE).run().readings
        at_default = {}
        for mesher, element, size in meshes:
            began = time.perf_counter()
            result = study.replace({"mesh.mesher": mesher, "mesh.element": element, "mesh.size": size}).run()
            seconds = time.perf_counter() - began
            readings = result.readings
            deviation = float((readings - fine).abs().max().max())
            worst[f"{name} {mesher} {element} {size}"] = round(deviation, 4)
            if (element, size) == DEFAULT:
                at_default[mesher] = readings
            unknowns = result.history.values.shape[1]
            nodes = result.tyre.mesh.n_nodes
            print(
                f"| {name} | {mesher} | {element} | {size} | {nodes} | {unknowns} | {deviation:.3f} | {seconds:.2f} |"
            )
        apart[name] = round(float((at_default["mapped"] - at_default["gmsh"]).abs().max().max()), 4)
    print(json.dumps({"deviation_K": worst, "meshers_apart_K": apart}))


if __name__ == "__main__":
    main()
