"""What a notebook shows: the verdict first, a picture and the facts, in one piece of HTML that cannot fail."""

from __future__ import annotations

import base64
import re
import subprocess
import sys
from collections.abc import Callable
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import tyrefem as tf
from tyrefem.api import Diagnosis
from tyrefem.effects import catalogue
from tyrefem.reports import notebook
from tyrefem.reports.figures.cells import triangles

QUICK = {"mesh.size": "12 mm", "drive.duration": "60 s"}
VOID = {"br", "img", "circle", "rect", "polygon", "meta"}


def quick() -> tf.Study:
    return tf.study("nasa-22x5.5-8pr", QUICK)


def stopped() -> tf.Result:
    def stop(time: float) -> None:
        if time > 30:
            raise KeyboardInterrupt

    return quick().run(stop, partial=True)


def diagnosis() -> Diagnosis:
    """Of readings that agree, with two candidates."""
    excluded = [name for name in catalogue() if name not in ("hot-road", "wet-road")]
    changes = {"mesh.size": "12 mm", "drive.duration": "120 s", "diagnosis.exclude": excluded}
    study = tf.study("nasa-22x5.5-8pr", changes)
    readings = study.run().readings
    times, noise = np.arange(5.0, 120.0, 10.0), np.random.default_rng(3)
    columns = {
        f"{name} [degC]": np.interp(times, readings["time_s"], readings[name]) + noise.normal(0.0, 0.1, len(times))
        for name in ("crown-inner", "crown-outer")
    }
    table = pd.DataFrame({"time [s]": times, **columns})
    return study.diagnose(table, largest=1, looks=1, rerun=False, verdict_only=True)


#: Object -> how it is made, and words of its first line.
OBJECTS: dict[str, tuple[Callable[[], Any], str]] = {
    "study": (quick, r"Ready to run: 22x5\.5 8PR aircraft tyre"),
    "radial": (lambda: tf.study("passenger-205-55r16"), "Ready to run: 205/55R16"),
    "result": (lambda: quick().run(), r"\d+\.\d °C at most, in the \w+ after 60 s; rolling resistance"),
    "interrupted": (stopped, r"Interrupted at \d+(\.\d+)? s\. "),
    "comparison": (
        lambda: tf.study("example-validation", {"mesh.size": "12 mm"}).compare(inputs=False),
        r"(Within|Beyond) the validation uncertainty: \d+ of 18 sensor histories",
    ),
    "sweep": (
        lambda: quick().sweep({"drive.speed": ["10 mph", "20 mph"], "drive.load": ["2000 lbf", "2700 lbf"]}),
        "Highest temperature: from",
    ),
    "optimum without a table": (
        lambda: quick().sweep(tornado={"tolerances": {"drive.load": "5 %"}}),
        "",
    ),
    "diagnosis": (diagnosis, "^no gap: "),
}


class Piece(HTMLParser):
    """Checks that all elements are closed, and collects the text and the attributes."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.texts: list[str] = []
        self.tags: set[str] = set()
        self.links: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.add(tag)
        self.links += [value or "" for name, value in attrs if name in ("src", "href")]
        if tag not in VOID or tag in ("polygon", "circle"):
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.add(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.texts.append(data)


@pytest.mark.parametrize("name", OBJECTS)
def test_the_verdict_is_first_then_a_picture_and_facts(name: str) -> None:
    make, words = OBJECTS[name]
    thing = make()
    html = thing._repr_html_()
    piece = Piece()
    piece.feed(html)
    assert not piece.open
    assert re.search(words, piece.texts[0])
    assert not piece.tags & {"script", "style", "link"}
    assert all(link.startswith("data:image/png;base64,") for link in piece.links)
    assert len(html) < 200_000
    facts = thing._facts()
    assert any(heading in piece.texts for heading in facts)
    if name != "optimum without a table":
        assert "svg" in piece.tags


def test_the_picture_of_a_result_is_a_png_on_nothing() -> None:
    """Transparent round the section, so that it is seen on light and dark."""
    (data,) = re.findall(r"base64,([\w+/=]+)", quick().run()._repr_html_())
    from io import BytesIO

    from matplotlib.image import imread

    pixels = imread(BytesIO(base64.b64decode(data)))
    assert pixels.shape[2] == 4
    assert pixels[-1, pixels.shape[1] // 2, 3] == 0.0
    assert pixels[..., 3].max() == 1.0


def test_the_picture_has_the_colours_of_the_pictures_and_the_values_of_the_field() -> None:
    from tyrefem.reports.figures.style import temperature_map
    from tyrefem.reports.raster import colour_table, raster

    table = temperature_map()(np.linspace(0, 1, 256))[:, :3] * 255
    assert np.abs(table - colour_table()).max() < 6
    result = quick().run()
    operators, values = result.tyre.problem.operators, np.asarray(result.history.values[-1])
    r, z = operators.points
    scale = 200 / np.ptp(r)
    places = np.column_stack([(z - z.min()) * scale, (r.max() - r) * scale])
    shape = (200, round(np.ptp(z) * scale))
    image = raster(places, triangles(operators)[0], values, shape)
    row, column = np.argwhere(np.isfinite(image))[::50].T
    points = [(r.max() - (y + 0.5) / scale, z.min() + (x + 0.5) / scale) for y, x in zip(row, column, strict=True)]
    assert len(points) > 50
    assert image[row, column] == pytest.approx(result.at(points)[-1], abs=0.5)


def test_a_page_of_a_result_needs_no_drawing_library() -> None:
    """In a fresh process: matplotlib and pyvista take longer to import than the page takes."""
    lines = (
        "import sys, tyrefem as tf",
        "study = tf.study('nasa-22x5.5-8pr', {'mesh.size': '12 mm', 'drive.duration': '60 s'})",
        "assert study._repr_html_() and study.run()._repr_html_()",
        "print([name for name in ('matplotlib', 'pyvista', 'vtkmodules') if name in sys.modules])",
    )
    done = subprocess.run([sys.executable, "-c", "\n".join(lines)], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_text_is_escaped() -> None:
    study = quick().replace({"title": "<script>alert('x')</script> & more"})
    html = study._repr_html_()
    assert "<script>" not in html
    assert "&lt;script&gt;" in html


def test_variants_that_never_reach_a_temperature_have_no_picture_of_it() -> None:
    """Ends of an axis without a number would be written as nan."""
    aims = {"time_to_limit_s": "max", "mass_kg": "min"}
    design = quick().sweep({"drive.speed": ["10 mph", "20 mph"]}, time_to="300 degC", pareto=aims, reduced="never")
    assert notebook.variants_picture(design) == ""


def test_a_failure_inside_leaves_the_text(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(_study: Any) -> str:
        raise RuntimeError("no picture")

    monkeypatch.setattr(notebook, "section_picture", fails)
    study = quick()
    assert study._repr_html_() is None
    assert "sensors" in repr(study)


def test_a_loaded_result_shows_the_same(tmp_path: Path) -> None:
    result = quick().run()
    result.save(tmp_path)
    back = tf.load(tmp_path)
    assert isinstance(back, tf.Result)
    first, second = (re.sub(r"base64,[\w+/=]+", "", thing._repr_html_()) for thing in (result, back))
    assert first == second
