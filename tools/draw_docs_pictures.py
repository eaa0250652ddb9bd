"""Draw the pictures of docs/ that no command draws (run from the root).

`python tools/draw_docs_pictures.py [NAME ...]`: all of them, or some: modes, reduced-error, realtime-drive,
realtime-step, realtime-certificate, cost, installed, construction-wrap, life-planes, hidden-laws, plan-shares. Each
takes less than a minute.
The other pictures are those of the commands that stand above them, of benchmarks/ and of tools/make_effects_page.py.
"""

from __future__ import annotations

import csv
import io
import os
import re
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

import tyrefem as tf
from tyrefem.output import atomic_path
from tyrefem.reports.figures.style import FONT, QUIET, Label, add_axes, figure, line_ends, line_style, png, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PICTURES = Path("docs/pictures")
STUDY = "nasa-22x5.5-8pr"
BOX = {"drive.speed": ("10 mph", "30 mph"), "drive.load": ("2000 lbf", "3500 lbf")}
COARSE = {"mesh.size": "6 mm"}


def _axes(x: str, y: str, width: float = 5.6) -> tuple[Figure, Axes]:
    drawn = figure(width + 2.0, 3.2)
    axes = add_axes(drawn, 0.75, 0.5, width - 0.5, 2.5)
    axes.set_xlabel(x, fontsize=FONT)
    axes.set_ylabel(y, fontsize=FONT)
    tidy(axes)
    return drawn, axes


def _surrogate() -> Any:
    from tyrefem.reduced.surrogate import surrogate
    from tyrefem.variants.plan import plan_of

    return surrogate(plan_of(tf.study(STUDY).replace(COARSE), BOX, sample="sobol", count=256))


def modes() -> Figure:
    """The first four POD modes of a reduced model on the half section."""
    from tyrefem.reports.figures.cells import triangles

    model = _surrogate().model
    points = np.asarray(model.operators.points) * 1e3
    cells, _ = triangles(model.operators)
    drawn = figure(7.6, 3.0)
    for number in range(4):
        axes = add_axes(drawn, 0.1 + 1.88 * number, 0.1, 1.7, 2.5)
        values = model.V[:, number] / np.abs(model.V[:, number]).max()
        axes.tripcolor(points[1], points[0], cells, values, cmap="RdBu_r", vmin=-1, vmax=1, shading="gouraud")
        axes.set_aspect("equal")
        axes.set_axis_off()
        axes.set_title(f"mode {number + 1} of {model.size}", fontsize=FONT)
    return drawn


def reduced_error() -> Figure:
    """Reduced readings less those of full runs, at four places of the box that training has not seen."""
    from tyrefem.reduced.answers import reduced_outcomes
    from tyrefem.reduced.variant import Variant

    trained = _surrogate()
    places = [("12 mph", "3300 lbf"), ("17 mph", "2300 lbf"), ("23 mph", "3000 lbf"), ("28 mph", "2600 lbf")]
    studies = [trained.model.base.study.replace({"drive.speed": v, "drive.load": load}) for v, load in places]
    drawn, axes = _axes("time [s]", "largest error of the sensors [mK]")
    labels = []
    for number, variant in reduced_outcomes(trained.model, studies):
        assert isinstance(variant, Variant)
        full = tf.study(STUDY).replace({**COARSE, "drive.speed": places[number][0], "drive.load": places[number][1]})
        expected, table = full.run().readings, variant.result.readings
        sensors = list(full.card.sensors)
        error = 1e3 * (table[sensors] - expected[sensors]).abs().max(axis=1).to_numpy()
        style = line_style(number)
        axes.plot(expected["time_s"], error, lw=1.2, **style)
        labels.append(Label(", ".join(places[number]), 600.0, float(error[-1]), color=style["color"]))
    axes.set_ylim(0)
    axes.set_xlim(0, 600)
    line_ends(axes, labels, room=1.7)
    return drawn


def _model(folder: str) -> Any:
    from tyrefem.realtime.certificate import export
    from tyrefem.realtime.tyre import RealTimeTyre

    path = Path(folder) / "tyre.npz"
    export(tf.study(STUDY).replace(COARSE), path)
    return RealTimeTyre(path)


def realtime_drive() -> Figure:
    """Outputs of the exported model in a drive whose speed and road jump."""
    from tyrefem.realtime.tyre import Inputs

    with tempfile.TemporaryDirectory() as folder:
        tyre = _model(folder)
    tyre.reset(20.0)
    rows = []
    for second in range(900):
        speed, road = (9.0, 30.0) if second < 300 else (12.0, 55.0) if second < 600 else (0.0, 30.0)
        rows.append(tyre.step(1.0, Inputs(speed, 12e3, 572e3, 25.0, road)).copy())
    drawn, axes = _axes("time [s]", "temperature [°C]")
    table, labels = np.array(rows), []
    for column, name in enumerate(tyre.names):
        if tyre.units[column] == "degC":
            style = {"color": QUIET, "ls": "-"} if name == "contained-air" else line_style(column)
            axes.plot(1 + np.arange(900), table[:, column], lw=1.2, **style)
            labels.append(Label(name, 900.0, float(table[-1, column]), color=style["color"]))
    for start, text in ((0, "9 m/s, road 30 °C"), (300, "12 m/s, road 55 °C"), (600, "standing")):
        axes.text(start + 10, axes.get_ylim()[1], text, fontsize=FONT, color=QUIET)
        axes.axvline(start, color=QUIET, lw=0.6)
    axes.set_xlim(0, 900)
    line_ends(axes, labels, room=1.7)
    return drawn


def realtime_step() -> Figure:
    """The decay of a mode over a step: exp(-z), and the error of what one inverse makes of it."""
    from tyrefem.realtime.tyre import GAMMA, PHI

    z = np.logspace(-3, 4, 800)
    rational = 1 - z * sum(b / (1 + GAMMA * z) ** (j + 1) for j, b in enumerate(PHI))
    drawn, axes = _axes("rate of the mode × step, z", "decay over a step")
    axes.semilogx(z, np.exp(-z), lw=1.2, **line_style(0))
    axes.semilogx(z, 1e3 * (rational - np.exp(-z)), lw=1.2, **line_style(1))
    ends = [Label("exp(-z)", 1e4, 0.03, color=line_style(0)["color"])]
    line_ends(axes, [*ends, Label("1000 × error", 1e4, -0.03, color=line_style(1)["color"])], room=1.7)
    return drawn


def realtime_certificate() -> Figure:
    """Largest error of every temperature against fresh full runs."""
    with tempfile.TemporaryDirectory() as folder:
        certificate = _model(folder).about["certificate"]
    drawn, axes = _axes("largest error against fresh full runs [K]", "")
    names = [name for name in certificate["steady"] if name != "rolling_resistance"][::-1]
    rows = np.arange(len(names))
    for shift, kind, label in ((0.2, "steady", "steady inputs"), (-0.2, "driven", "steps and ramps")):
        axes.barh(rows + shift, [certificate[kind][name] for name in names], 0.36, label=label)
    axes.axvline(certificate["tolerance"], color=QUIET, ls="--", lw=0.8)
    axes.set_yticks(rows, names)
    axes.set_position((0.2, 0.16, 0.62, 0.78))
    axes.legend(fontsize=FONT, frameon=False)
    return drawn


def cost() -> Figure:
    """Processor seconds of a run over the unknowns of its mesh, and what was estimated before."""
    from tyrefem.simulation.estimate import RunEstimate

    unknowns, seconds, expected = [], [], []
    for size in (8.0, 6.0, 4.0, 3.0, 2.0, 1.5, 1.0):
        study = tf.study(STUDY).replace({"mesh.size": f"{size} mm"})
        began = time.process_time()
        study.run()
        seconds.append(time.process_time() - began)
        unknowns.append(RunEstimate.of(study).unknowns)
        expected.append(RunEstimate.of(study).total.time)
    drawn, axes = _axes("unknowns", "processor time [s]")
    axes.loglog(unknowns, seconds, marker="o", lw=1.2, ms=4, **line_style(0))
    axes.loglog(unknowns, expected, lw=1.2, **line_style(1))
    for axis, ticks in ((axes.xaxis, (1000, 3000, 10_000, 30_000)), (axes.yaxis, (0.1, 0.3, 1, 3, 10))):
        axis.set_ticks([], minor=True)
        axis.set_ticks(ticks, [f"{tick:,}" for tick in ticks])
    labels = [("measured", seconds, 0), ("estimated before", expected, 1)]
    line_ends(axes, [Label(n, unknowns[-1], v[-1], color=line_style(i)["color"]) for n, v, i in labels], room=1.7)
    return drawn


def installed() -> Figure:
    """Size of every package of the default installation."""
    import importlib.metadata as metadata
    import tomllib

    from packaging.requirements import Requirement

    wanted = tomllib.loads(Path("pyproject.toml").read_text(encoding="utf-8"))["project"]["dependencies"]
    names = [*(Requirement(text).name for text in wanted), "vtk"]
    files = {name: metadata.distribution(name).files or [] for name in names}
    sizes = {name: sum(file.size or 0 for file in listed) / 1e6 for name, listed in files.items()}
    drawn, axes = _axes("installed size [MB]", "")
    ordered = sorted(sizes, key=lambda name: sizes[name])
    axes.barh(ordered, [sizes[name] for name in ordered], color=line_style(0)["color"])
    axes.set_xscale("log")
    axes.set_xlim(0.01)
    axes.set_position((0.2, 0.16, 0.7, 0.8))
    axes.tick_params(axis="y", labelsize=FONT - 2)
    return drawn


def construction_wrap() -> Figure:
    """Cords of the passenger's body ply round the bead, on the elements of both meshers."""
    from matplotlib.collections import LineCollection, PolyCollection

    from tyrefem.geometry.meshing import build

    section = tf.study("passenger-205-55r16").section
    colours = {
        "body-ply": "#9ecae1",
        "turn-up": "#a1d99b",
        "bead-wrap": "#fdae6b",
        "bead": "#bdbdbd",
        "apex": "#dadaeb",
    }
    drawn = figure(7.6, 4.0)
    for number, (mesher, words) in enumerate((("gmsh", "gmsh, triangles"), ("mapped", "mapped, quadrilaterals"))):
        mesh = build(section, mesher=mesher, size=4e-3, through=1)
        axes = add_axes(drawn, 0.7 + 3.7 * number, 0.45, 2.9, 3.2)
        corners = mesh.mesh.p[:, mesh.mesh.t].transpose(2, 1, 0)[..., ::-1] * 1e3
        for region in section.regions:
            cells = corners[mesh.mesh.subdomains[region]]
            axes.add_collection(
                PolyCollection(cells, facecolors=colours.get(region, "#f7f7f7"), edgecolors="0.5", lw=0.4)
            )
        plies = np.concatenate([mesh.mesh.subdomains[region] for region in ("body-ply", "bead-wrap", "turn-up")])
        middle = mesh.mesh.p[:, mesh.mesh.t[:, plies]].mean(axis=1)
        along = mesh.along_meridian(middle)
        ends = np.stack([middle - 4e-4 * along, middle + 4e-4 * along]).transpose(2, 0, 1)[..., ::-1] * 1e3
        axes.add_collection(LineCollection(ends, colors="#a50f15", lw=1.2))
        axes.set(xlim=(68, 94), ylim=(201, 229.5), aspect="equal", title=words)
        axes.set_xlabel("axial position z [mm]", fontsize=FONT)
        axes.set_ylabel("" if number else "radius r [mm]", fontsize=FONT)
        tidy(axes)
        if number == 0:
            for text, place in {"body ply": (68.5, 219.5), "bead": (73.9, 210), "turn-up": (85.5, 221.5)}.items():
                axes.text(*place, text, fontsize=FONT, weight="bold")
            axes.text(73.0, 201.4, "wrap", fontsize=FONT, weight="bold")
    return drawn


def life_planes() -> Figure:
    """Cracking energy over strain energy on planes turned about the third axis, for four strains of 5 %."""
    from tyrefem.fatigue.cracking_energy import CrackingEnergy, products, six

    e, modulus = 0.05, 1e6
    strains = {
        "pull along 0°": (np.diag([e, -e / 2, -e / 2]), modulus * e),
        "compression along 0°": (np.diag([-e, e / 2, e / 2]), -modulus * e),
        "equibiaxial pull": (np.diag([e, e, -2 * e]), 4 * modulus * e),
        "shear along 0°": (np.array([[0, e, 0], [e, 0, 0], [0, 0, 0.0]]), 0.0),
    }
    degrees = np.linspace(0, 180, 181)
    angle = np.radians(degrees)
    normals = np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=1)
    drawn, axes = _axes("normal of the plane from the first axis [°]", "cracking over strain energy")
    for number, (strain, pressure) in enumerate(strains.values()):
        stress = 2 * modulus * strain + pressure * np.eye(3)
        share = np.concatenate([np.linspace(0, 1, 50), np.linspace(1, 0, 50)[1:]])[:, None]
        peak = CrackingEnergy((share * six(stress))[None], (share * six(strain))[None]).on(products(normals)).peak[0]
        values = peak / ((stress * strain).sum() / 2)
        axes.plot(degrees, values, **line_style(number))
    axes.set_xlim(0, 180)
    axes.set_xticks(range(0, 181, 45))
    axes.legend(
        axes.lines, list(strains), fontsize=FONT - 1, loc="upper left", bbox_to_anchor=(1.01, 1.0), frameon=False
    )
    return drawn


def _table(name: str) -> list[dict[str, str]]:
    with (Path("docs/evidence/tables") / f"{name}.csv").open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def hidden_laws() -> Figure:
    """Exponents and times of hidden laws: how far those of the law and of the draft's fit are off, over their sd."""
    number = re.compile(r"(?P<name>[a-z][a-z ]*) (?P<mean>-?[\d.]+) ± (?P<sd>[\d.]+)")
    hidden_number = re.compile(r"(?P<name>[a-z][a-z ]*) (?P<mean>-?[\d.]+)")
    names: list[str] = []
    points: list[tuple[int, int, float]] = []
    for row in _table("diagnosis-laws"):
        hidden = {each["name"]: float(each["mean"]) for each in hidden_number.finditer(row["law: hidden values"])}
        at = {name: len(names) + place for place, name in enumerate(hidden)}
        names += [
            f"{row['hidden']} {row['seed']}: {name.replace('slope of the loss over', 'loss over')}" for name in at
        ]
        for style, column in enumerate(("law: values", "draft: values")):
            points += [
                (style, at[each["name"]], (float(each["mean"]) - hidden[each["name"]]) / float(each["sd"]))
                for each in number.finditer(row[column])
            ]
    drawn = figure(7.6, 0.19 * len(names) + 0.9)
    axes = add_axes(drawn, 2.0, 0.5, 3.6, 0.19 * len(names) + 0.3)
    axes.axvspan(-2, 2, color="0.92", zorder=0)
    axes.axvline(0, color="0.6", lw=0.8)
    for style, (words, marker) in enumerate((("law of the first diagnosis", "o"), ("fit of the draft effect", "s"))):
        places = [(off, row) for kind, row, off in points if kind == style]
        axes.plot(*zip(*places, strict=True), marker, ms=4, color=line_style(style)["color"], label=words)
    axes.set_yticks(range(len(names)), names, fontsize=FONT - 1)
    axes.set_ylim(len(names) - 0.5, -0.5)
    axes.set_xlim(-4, 4)
    axes.set_xlabel("found less hidden value [standard deviations]", fontsize=FONT)
    tidy(axes)
    axes.legend(fontsize=FONT - 1, loc="upper left", bbox_to_anchor=(1.01, 1.0), frameon=False)
    return drawn


def plan_shares() -> Figure:
    """Share of confounded cases with the right name after one and two further runs, with 95 % intervals."""
    from tyrefem.diagnose.blind.criteria import Rate

    rows = [row for row in _table("diagnosis-plan-cases") if row["runs by plan"]]
    drawn, axes = _axes("further runs", "cases with the right name [%]", width=3.6)
    labels = []
    for number, (column, words) in enumerate((("runs by plan", "by plan"), ("runs at random", "at random"))):
        rates = [Rate(sum(row[column] in {str(n) for n in range(1, most + 1)} for row in rows), len(rows))
                 for most in (1, 2)]  # fmt: skip
        shares = np.array([[100 * rate.value, *(100 * x for x in rate.interval)] for rate in rates])
        x, style = np.array([1.0, 2.0]) + 0.04 * (2 * number - 1), line_style(number)
        axes.errorbar(
            x, shares[:, 0], abs(shares[:, 1:] - shares[:, :1]).T, marker="o", ms=4, lw=1.2, capsize=3, **style
        )
        labels.append(Label(words, float(x[-1]), float(shares[-1, 0]), color=style["color"]))
    axes.set(xlim=(0.7, 2.1), ylim=(0, 102), xticks=(1, 2))
    line_ends(axes, labels, room=1.7)
    return drawn


DRAWN: dict[str, Callable[[], Figure]] = {
    "modes": modes, "reduced-error": reduced_error, "realtime-drive": realtime_drive, "realtime-step": realtime_step,
    "realtime-certificate": realtime_certificate, "cost": cost, "installed": installed,
    "construction-wrap": construction_wrap, "life-planes": life_planes, "hidden-laws": hidden_laws,
    "plan-shares": plan_shares,
}  # fmt: skip


def main() -> None:
    """Draw the pictures that are named, or all."""
    from PIL import Image

    for name in sys.argv[1:] or DRAWN:
        image = Image.open(io.BytesIO(png(DRAWN[name]()))).convert("RGB")
        few = image.quantize(colors=96, method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
        with atomic_path(PICTURES / f"{name}.png") as temporary:
            few.save(temporary, format="PNG", optimize=True)
        print(name, flush=True)


if __name__ == "__main__":
    main()
