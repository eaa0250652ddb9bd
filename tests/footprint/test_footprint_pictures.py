"""Pictures show what was computed."""

from __future__ import annotations

import numpy as np
import pytest

from tyrefem.materials.loss_tangent import OfTemperature
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.cord_cycle import CordCycle
from tyrefem.mechanics.footprint.example_tyre import PlainTyre
from tyrefem.mechanics.footprint.footprint import Footprint
from tyrefem.mechanics.footprint.loss import RevolutionLoss
from tyrefem.mechanics.footprint.strain_harmonics import StrainHarmonics
from tyrefem.reports.figures.footprint import (
    cord_tension_figure,
    deformed_figure,
    harmonics_figure,
    pressure_map,
    pressure_map_figure,
    strain_history_figure,
)


@pytest.fixture(scope="module")
def footprint() -> Footprint:
    return Pressing(PlainTyre().state(along=8)).at_deflection(0.02, 36)


def test_pressure_map_is_the_whole_footprint(footprint: Footprint) -> None:
    """Symmetric both ways; its integral by trapezoids is the load, less the edges of a coarse mesh."""
    x, z, pressure = pressure_map(footprint)
    assert pressure == pytest.approx(pressure[::-1, ::-1])
    integral = np.trapezoid(np.trapezoid(pressure, x, axis=1), z)
    assert integral == pytest.approx(footprint.load, rel=0.2)


def test_pictures_carry_the_numbers(footprint: Footprint) -> None:
    cycle = StrainHarmonics(footprint)
    loss = RevolutionLoss(cycle, {"tread": OfTemperature(0.1)}, 20.0)
    history = strain_history_figure(cycle, {"crown": (0.31, 0.0), "sidewall": (0.28, 0.1)}, count=37)
    drawn = [pressure_map_figure(footprint), history, harmonics_figure(loss), deformed_figure(footprint)]
    for picture in drawn:
        assert f"{footprint.load / 1e3:.3f} kN" in " ".join(text.get_text() for text in picture.texts)
    assert f"coefficient {loss.coefficient:.4f}" in " ".join(text.get_text() for text in drawn[2].texts)
    # Four more digits and a drum, as of a truck tyre: no line is cut.
    assert all(len(text.get_text()) < 100 and not text.get_text().endswith("...") for text in drawn[2].texts)
    # Rubber that loses nothing has its picture too: a sum of 0 %.
    lossless = harmonics_figure(RevolutionLoss(cycle, {}, 20.0))
    sums = [axes.lines[0].get_ydata() for axes in lossless.axes if axes.get_ylabel() == "sum [%]"]
    assert [values[-1] for values in sums] == pytest.approx([100.0, 0.0])
    shown = history.axes[0].lines[2].get_ydata()
    assert shown == pytest.approx(100 * cycle.at(0.31, 0.0, np.linspace(-np.pi, np.pi, 37))[2])


def test_long_names_of_layers_leave_the_legend_and_the_next_panel_free(footprint: Footprint) -> None:
    angles = np.linspace(-np.pi, np.pi, 37)
    straight, turned = np.exp(-(angles**2)), np.exp(-((angles - 0.3) ** 2))
    names = ["the shoulder cushion's inner layer of cords, the second from inside", "bead"]
    cords = [CordCycle(names[0], (0.3, 0.05), angles, turned, turned[::-1], 0.5, "N"),
             CordCycle(names[1], (0.2, 0.06), angles, straight, straight, 0.5, "N")]  # fmt: skip
    drawn = cord_tension_figure(footprint, cords)
    drawn.draw_without_rendering()
    renderer = drawn.canvas.get_renderer()  # type: ignore[attr-defined]
    (legend,) = drawn.legends
    assert [text.get_text() for text in legend.get_texts()] == ["+angle", "−angle", "cords", "inflated"]
    key, heads = legend.get_window_extent(renderer), [axes._left_title for axes in drawn.axes]  # type: ignore[attr-defined]
    assert not any(key.overlaps(text.get_window_extent(renderer)) for text in [*heads, *drawn.texts])
    assert heads[0].get_window_extent(renderer).x1 < drawn.axes[1].get_tightbbox(renderer).x0  # type: ignore[union-attr]
    assert drawn.axes[1].lines[0].get_color() not in [line.get_color() for line in drawn.axes[0].lines[:2]]
