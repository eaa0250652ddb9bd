"""Names in the pictures of a sweep are whole, with their units."""

from __future__ import annotations

import base64
import itertools
import re
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
from matplotlib.text import Text

import tyrefem as tf
from tyrefem.reports.sweep import cell
from tyrefem.reports.sweep_answer_figures import indices, tornado
from tyrefem.reports.sweep_figures import curves, pareto
from tyrefem.reports.template import rendered
from tyrefem.sweep.sweep import sweep
from tyrefem.variants.plan import plan_of

LONG = "materials.shoulder-cushion-of-the-second-belt.conductivity.along"


def test_a_tornado_names_its_numbers_whole_and_on_the_paper() -> None:
    rows = pd.DataFrame(
        {"number": [LONG], "tolerance": [0.2], "less": [-1.0], "more": [1.0], "range": [2.0], "nominal": [80.0]}
    )
    data = SimpleNamespace(of=lambda answer: rows, tolerance=lambda number: "±20 %")
    drawn = tornado(data, "hottest_degC")  # type: ignore[arg-type]
    table = pd.DataFrame({"number": [LONG], "first": [0.5], "total": [0.6], "first_95": [0.1], "total_95": [0.1]})
    for made in (drawn, indices(table, "hottest_degC")):
        (label,) = made.axes[0].get_yticklabels()
        assert label.get_text().startswith(LONG)
        made.draw_without_rendering()
        assert label.get_window_extent(made.canvas.get_renderer()).x0 > 0


def test_the_last_tick_of_a_tornado_is_on_the_paper() -> None:
    rows = pd.DataFrame(
        {
            "number": [LONG],
            "tolerance": [0.2],
            "less": [-9.5e-4],
            "more": [9.1e-4],
            "range": [1.86e-3],
            "nominal": [0.01],
        }
    )
    data = SimpleNamespace(of=lambda answer: rows, tolerance=lambda number: "±20 %")
    made = tornado(data, "rolling_resistance_coefficient")  # type: ignore[arg-type]
    made.axes[0].set_xlim(right=1e-3)
    made.draw_without_rendering()
    last = made.axes[0].get_xticklabels()[-1]
    assert last.get_window_extent(made.canvas.get_renderer()).x1 < made.bbox.x1


def test_names_on_a_crowded_pareto_front_do_not_cover_each_other() -> None:
    steps = np.arange(12)
    table = pd.DataFrame({"variant": [str(200 + k) for k in steps], "x": 0.006 + 1e-5 * steps, "y": 45.0 - 0.3 * steps})
    far = pd.DataFrame({"variant": ["1"], "x": [0.013], "y": [80.0]})
    rows = pd.concat([table, far], ignore_index=True).assign(feasible=True, failure="")
    plan = SimpleNamespace(limits={})
    made = pareto(SimpleNamespace(table=rows, overview=lambda _: rows, plan=plan), table, "x", "y")  # type: ignore[arg-type]
    made.draw_without_rendering()
    written = [text for text in made.axes[0].texts if text.get_text() in set(table["variant"])]
    assert len(written) == len(table)
    # The text alone, without the line that leads to its point.
    boxes = [Text.get_window_extent(text, made.canvas.get_renderer()) for text in written]
    assert [(a, b) for a, b in itertools.combinations(boxes, 2) if a.padded(-1).overlaps(b.padded(-1))] == []


def test_what_a_curve_stands_for_has_its_unit() -> None:
    study = tf.study("nasa-22x5.5-8pr", {"mesh.size": "12 mm", "drive.duration": "20 s"})
    vary = {"drive.speed": ["10 mph", "20 mph"], "drive.load": ["2000 lbf", "2700 lbf"]}
    swept = sweep(plan_of(study, vary, limits={"hottest_degC": {"below": 32}}), reduced="never")
    headings = swept.plan.row(0)
    (speed,) = [name for name in headings if "speed" in name]
    drawn = curves(swept, speed, "hottest_degC")
    legend = drawn.axes[0].get_legend()
    assert legend is not None
    assert legend.get_title().get_text() == "load [lbf]"
    # The limit is written where the legend does not stand.
    drawn.draw_without_rendering()
    (limit,) = drawn.axes[0].texts
    assert limit.get_text() == "limit 32"
    assert not limit.get_window_extent().overlaps(legend.get_window_extent())


def test_a_table_s_cells_are_short_and_have_no_exponent() -> None:
    values = (79.3731, -0.00010668, 12010, 123456.7, float("nan"), None, "carcass", True)
    assert [cell(value, 4) for value in values] == ["79.37", "-0.0001067", "12010", "123 457", "", "", "carcass", "yes"]


def test_the_page_knows_the_pictures_of_every_answer() -> None:
    """In a fresh process, where no test has imported the modules that draw them."""
    code = (
        "import tyrefem.reports.sweep as page\n"
        "print(*sorted(kind.__name__ for kind in page.figures.registry if kind is not object))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["Envelope", "Indices", "Optimum", "ParetoFront", "Responses", "Tornado"]


def test_every_picture_has_its_own_file_and_every_name_its_signs(tmp_path: Path) -> None:
    """Sensors whose names differ before a dot, in a slash or in capitals; dollar signs are no formula."""
    depths = {"T1.5": "2 mm", "T2.5": "8 mm", "in/out": "3 mm", "in-out": "5 mm", r"$\bad$": "6 mm", "TC Left": "7 mm"}
    sensors = {name: {"s": "0 mm", "depth": depth} for name, depth in depths.items()}
    study = tf.study("nasa-22x5.5-8pr", {"mesh.size": "14 mm", "drive.duration": "20 s", "sensors": sensors})
    answers = [f"{name}_degC" for name in depths]
    design = study.sweep({"drive.speed": ["10 mph", "20 mph"]}, answers=answers, reduced="never")
    design.save(tmp_path)
    files = sorted(file.name for file in (tmp_path / "pictures").iterdir() if file.is_file())
    assert len([file for file in files if file.startswith("curves-")]) == len(answers)
    assert {"curves-T1.5_degC-speed.png", "curves-T2.5_degC-speed.png"} < set(files)
    page = (tmp_path / "sweep.html").read_text(encoding="utf-8")
    shown = [base64.b64decode(data) for data in re.findall(r"data:image/png;base64,([^\"]+)", page)]
    assert sorted(shown) == sorted((tmp_path / "pictures" / file).read_bytes() for file in files)
    drawn = curves(design.swept, "drive.speed [mph]", "TC Left_degC")
    assert drawn.texts[0].get_text() == "TC Left over speed"


def test_the_page_says_how_many_failures_it_leaves_out() -> None:
    empty = {"how": "", "interrupted": "", "numbers": [], "parts": [], "variants": None, "assumed": [], "versions": {}}
    values = {"study": SimpleNamespace(name="tyre", title="tyre"), "title": "tyre", "explored": None, **empty}
    for count, left in ((30, []), (32, ["and 2 more"])):
        page = rendered("sweep.html", failed={f"v{n}": "burst" for n in range(count)}, **values)
        assert page.count(": burst") == 30
        assert re.findall(r"and \d+ more", page) == left
