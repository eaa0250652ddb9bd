"""Every phase has its name in a picture, nothing is said of what is not there, and pictures come as PDF too."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.errors import InputError
from tyrefem.output.file import made_by_this_tool, mark_archive, results_file
from tyrefem.reports.figures.budget import budget_figure
from tyrefem.reports.figures.heat_source import heat_source_figure
from tyrefem.reports.figures.histories import histories_figure
from tyrefem.reports.figures.phases import LINE, named
from tyrefem.reports.figures.road import sliding_figure
from tyrefem.reports.figures.style import add_axes, figure, picture, title
from tyrefem.reports.figures.temperature import temperature_figure
from tyrefem.reports.words import history_files

pytestmark = pytest.mark.fast


@pytest.fixture(scope="module")
def skid() -> tf.Result:
    """Six phases, two of them one and four seconds of 460."""
    return tf.study("nasa-brake-yaw-skid", {"mesh.size": "12 mm"}).run()


@pytest.fixture(scope="module")
def landing() -> tf.Result:
    """A wheel that touches down: load from 0, slip to 0, no wheel locked."""
    phases = [
        {"name": "roll", "speed": "20 mph", "duration": "20 s"},
        {
            "name": "landing", "speed": "120 mph", "duration": "2 s", "load": {"from": "0 lbf", "to": "2700 lbf"},
            "slip_ratio": {"from": 1, "to": 0},
        },
    ]  # fmt: skip
    return tf.study("nasa-brake-yaw-skid", {"mesh.size": "12 mm", "drive.phases": phases}).run()


@pytest.fixture(scope="module")
def cold() -> tf.Result:
    """A tyre that stands at the temperature of everything about it."""
    return tf.study("nasa-22x5.5-8pr", {"mesh.size": "12 mm", "drive.speed": "0 mph", "drive.duration": "60 s"}).run()


def written(drawn):
    from matplotlib.text import Text

    return [text.get_text() for text in drawn.findobj(Text) if text.get_text()]


@pytest.mark.parametrize("drawn", [histories_figure, budget_figure])
def test_every_phase_is_named_beside_the_others(drawn, skid: tf.Result) -> None:
    made = drawn(skid)
    names = {phase.name for phase in skid.phases}
    (axes,) = [axes for axes in made.axes if names & {text.get_text() for text in axes.texts}]
    labels = [text for text in axes.texts if text.get_text() in names]
    assert {text.get_text() for text in labels} == names
    renderer = made.canvas.get_renderer()
    made.draw_without_rendering()
    places = [text.get_window_extent(renderer).padded(-1.0) for text in labels]
    assert not any(a.overlaps(b) for a, b in itertools.combinations(places, 2))


def test_more_phases_than_fit_name_the_longest() -> None:
    many = [(f"phase {i}", float(i), float(i + 1)) for i in range(99)] + [("long", 99.0, 200.0)]
    names = named(many, 2.0)
    assert "long" in {name.text for name in names}
    upright = sorted(name.x for name in names if name.upright)
    assert all(b - a > 0.99 * LINE for a, b in itertools.pairwise(upright))


def test_a_landing_has_no_locked_wheel_in_its_legend(landing: tf.Result, skid: tf.Result) -> None:
    locked = "half-space under a locked wheel"
    assert landing.sliding is not None
    assert skid.sliding is not None
    assert locked not in written(sliding_figure(landing.sliding))
    assert locked in written(sliding_figure(skid.sliding))


def test_the_contact_pressure_of_a_landing_is_that_of_its_end(landing: tf.Result) -> None:
    assert landing.sliding is not None
    (phase,) = landing.sliding.phases
    series = landing.sliding.series
    assert phase.pressure == series.contact_pressure_Pa.iloc[-1] == series.contact_pressure_Pa.max()


def test_no_heat_closes_to_nothing(cold: tf.Result, tmp_path: Path) -> None:
    budget = cold.heat_budget
    assert budget.empty
    assert budget.closing == "no heat is exchanged"
    assert budget.imbalance < 1e-3
    assert "no heat is exchanged" in " ".join(written(budget_figure(cold)))
    assert "share of the" not in " ".join(written(budget_figure(cold)))
    # Rounding errors are no history: the axis is of 25 °C, not of 1e-11 K around it.
    low, high = histories_figure(cold).axes[0].get_ylim()
    assert (low, high) == pytest.approx((24.5, 25.52))
    assert "no heat is exchanged" in cold.report(tmp_path / "report.html").read_text()


def test_a_tyre_that_cools_has_a_budget(standing: tf.Result) -> None:
    assert not standing.heat_budget.empty
    assert standing.heat_budget.imbalance < 1e-6


def test_an_even_temperature_has_no_hottest_point(cold: tf.Result, skid: tf.Result) -> None:
    assert not [text for text in written(temperature_figure(cold)) if text.startswith("hottest")]
    assert [text for text in written(temperature_figure(skid)) if text.startswith("hottest")]


def test_strain_energy_of_a_tyre_that_stands_is_said_to_be_if_it_rolled(cold: tf.Result) -> None:
    assert any("if it rolled" in text for text in written(heat_source_figure(cold)))


def test_numbers_of_the_waterfall_have_room(skid: tf.Result) -> None:
    drawn = budget_figure(skid)
    drawn.draw_without_rendering()
    renderer, axes = drawn.canvas.get_renderer(), drawn.axes[0]
    right = axes.get_window_extent(renderer).x1
    assert len(axes.texts) > 3
    assert all(text.get_window_extent(renderer).x1 <= right + 1 for text in axes.texts)


def test_a_long_title_is_written_smaller_and_whole() -> None:
    drawn = figure(10.0, 3.0)
    words = "205/55R16 passenger radial, rolling resistance test of ISO 28580: 80 % of load index 91, 210 kPa, 80 km/h"
    title(drawn, words)
    assert drawn.texts[0].get_text() == words
    drawn.draw_without_rendering()
    assert drawn.texts[0].get_window_extent(drawn.canvas.get_renderer()).x1 < drawn.bbox.x1


@pytest.mark.parametrize(("suffix", "begins"), [(".png", b"\x89PNG"), (".pdf", b"%PDF"), (".svg", b"<?xml")])
def test_a_picture_is_written_in_each_form_the_same_every_time(suffix: str, begins: bytes, tmp_path: Path) -> None:
    contents = []
    for _ in range(2):
        drawn = figure(4.0, 3.0)
        add_axes(drawn, 0.5, 0.5, 3.0, 2.0).plot([0, 1], [1, 0])
        contents.append(picture(drawn, suffix))
    assert contents[0] == contents[1]
    assert contents[0].startswith(begins)
    file = tmp_path / f"x{suffix}"
    file.write_bytes(contents[0])
    assert made_by_this_tool(file)


#: Files of a person that only speak of this tool.
FOREIGN = {
    "notes.html": b"<html><body>My notes on tyrefem runs</body></html>",
    "figure.svg": b"<svg><text>tyrefem and measured, drawn by me</text></svg>",
    "mesh.vtk": b"# vtk DataFile Version 3.0\na mesh for tyrefem\nASCII\n",
    "mesh.msh": b"$Comments\nfor tyrefem\n$EndComments\n",
    "mesh.vtu": b"<!-- for tyrefem --><VTKFile/>",
    "page.pdf": b"%PDF /Title (tyrefem)",
    "numbers.npz": b"tyrefem.npy",
    "study.toml": b"# a study for tyrefem\n",
}


@pytest.mark.parametrize("name", FOREIGN)
def test_a_file_of_a_person_that_speaks_of_this_tool_is_kept(name: str, tmp_path: Path) -> None:
    file = tmp_path / name
    file.write_bytes(FOREIGN[name])
    assert not made_by_this_tool(file)
    with pytest.raises(InputError, match="replace it with --force"), results_file(file, (file.suffix,)):
        raise AssertionError("it was opened")
    assert file.read_bytes() == FOREIGN[name]


def test_an_archive_is_known_by_its_comment(tmp_path: Path) -> None:
    file = tmp_path / "tyre.npz"
    np.savez(file, tyrefem=np.arange(3))
    assert not made_by_this_tool(file)
    mark_archive(file)
    assert made_by_this_tool(file)


def test_names_of_pictures_fit_a_file_system() -> None:
    files = history_files(["x" * 300, "x" * 300, "\N{GREEK SMALL LETTER OMEGA}" * 300, "A", "a"])
    assert all(len(file.encode()) <= 255 for file in files)
    assert len({file.casefold() for file in files}) == len(files)
