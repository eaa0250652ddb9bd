"""How much the mesh matters: every sensor of the shipped NASA studies against a fine quadratic mesh.

    python benchmarks/mesh_convergence.py [--quick]
    python benchmarks/mesh_convergence.py --work      # error over processor time of linear and quadratic elements

Prints a table (that of docs/evidence/sections-and-meshes.md) and, as its last line, one JSON object: the largest
deviation of any sensor over each run, K, and the largest difference between the two meshers at default size. With
--work it writes docs/evidence/tables/mesh-work.csv and docs/pictures/mesh-work.png instead.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from typing import Any

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
#: Sizes of the curves of error over time, mm, and of their reference.
WORK = {"P1": (6.0, 4.0, 3.0, 2.0, 1.5, 1.0, 0.75), "P2": (12.0, 8.0, 6.0, 4.0, 3.0, 2.0, 1.5)}
FINEST = {"mesh.element": "P2", "mesh.size": "0.6 mm"}
#: A run counts with the least time of so many.
REPEAT = 3


def work() -> list[dict[str, Any]]:
    """Largest deviation of a sensor, and least processor time of a run, by study, element and size."""
    rows = []
    for name in STUDIES:
        study = tf.study(name)
        fine = study.replace(FINEST).run().readings
        for element, sizes in WORK.items():
            for size in sizes:
                seconds = []
                for _ in range(REPEAT):
                    began = time.process_time()
                    result = study.replace({"mesh.element": element, "mesh.size": f"{size} mm"}).run()
                    seconds.append(time.process_time() - began)
                deviation = float((result.readings - fine).abs().max().max())
                unknowns = result.history.values.shape[1]
                rows.append(
                    {
                        "study": name,
                        "element": element,
                        "size_mm": size,
                        "unknowns": unknowns,
                        "processor_s": min(seconds),
                        "deviation_K": deviation,
                    }
                )
                print(*rows[-1].values(), flush=True)
    return rows


def save_work(rows: list[dict[str, Any]]) -> None:
    """Write the table and the picture of error over time."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import pandas as pd

    docs = Path(__file__).resolve().parents[1] / "docs"
    table = pd.DataFrame(rows)
    table.to_csv(docs / "evidence/tables/mesh-work.csv", index=False, float_format="%.3g", lineterminator="\n")
    figure, panels = plt.subplots(1, len(STUDIES), figsize=(9, 3.8), sharey=True, layout="constrained")
    styles = {"P1": ("#c8553d", "s--", "linear"), "P2": ("#1f6f8b", "o-", "quadratic")}
    for axes, name in zip(panels, STUDIES, strict=True):
        for element, (color, style, label) in styles.items():
            part = table[(table["study"] == name) & (table["element"] == element)]
            axes.loglog(part["processor_s"], part["deviation_K"], style, color=color, ms=4, label=label)
            for row in part.itertuples():
                axes.annotate(
                    f"{row.size_mm:g}", (row.processor_s, row.deviation_K), (4, 3), textcoords="offset points", size=8
                )
        axes.set(title=name, xlabel="processor time of a run, s")
        axes.set_xticks([0.05, 0.1, 0.2, 0.5, 1.0], ["0.05", "0.1", "0.2", "0.5", "1"])
        axes.minorticks_off()
        axes.grid(which="major", color="#dddddd")
    panels[0].set_ylabel("largest error of a sensor, K")
    panels[0].legend(frameon=False, title="elements; size in mm")
    figure.savefig(docs / "pictures/mesh-work.png", dpi=130)


def main() -> None:
    """Run the table."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--quick", action="store_true", help="only the default element and size")
    parser.add_argument("--work", action="store_true", help="error over processor time: a table and a picture")
    given = parser.parse_args()
    if given.work:
        save_work(work())
        return
    quick = given.quick
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
