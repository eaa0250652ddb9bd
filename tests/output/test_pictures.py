"""Pictures: written whole, not blank, with the run's numbers on them and no label over another."""

from __future__ import annotations

import io
import itertools
import json
from dataclasses import replace

import numpy as np
import pytest
import tomli_w
from matplotlib.figure import Figure

import tyrefem
from tyrefem.errors import InputError
from tyrefem.library import load
from tyrefem.reports.figures import pictures, write_pictures
from tyrefem.reports.figures.budget import _energies, budget_figure, waterfall
from tyrefem.reports.figures.cells import linear_cells, triangles
from tyrefem.reports.figures.heat_source import ZoneHeat, heat_source_figure, scale_top, zone_heat
from tyrefem.reports.figures.histories import histories_figure
from tyrefem.reports.figures.mesh import mesh_figure, section_figure
from tyrefem.reports.figures.strain import along, strain_figure
from tyrefem.reports.figures.style import spread
from tyrefem.reports.figures.temperature import temperature_figure

STANDARD = {
    "temperature.png", "histories.png", "heat-budget.png", "heat-source.png", "strain-cycle.png", "mesh.png",
}  # fmt: skip


def image(png):
    from matplotlib.image import imread

    return imread(io.BytesIO(png), format="png")


def texts(figure):
    from matplotlib.text import Text

    return [text.get_text() for text in figure.findobj(Text) if text.get_text()]


def boxes(figure, axes):
    """Places on paper of the labels written on axes."""
    renderer = figure.canvas.get_renderer()
    figure.draw_without_rendering()
    return [text.get_window_extent(renderer) for text in axes.texts if text.get_text()]


def overlaps(figure, axes):
    areas = boxes(figure, axes)
    return [(a, b) for i, a in enumerate(areas) for b in areas[:i] if a.padded(-1.0).overlaps(b.padded(-1.0))]


@pytest.mark.parametrize("run", ["result", "quadratic", "standing", "stopped", "phased"])
def test_every_picture_is_written_and_not_blank(run, request, tmp_path):
    result = request.getfixturevalue(run)
    paths = write_pictures(result, tmp_path)
    assert {path.name for path in paths} >= STANDARD
    assert sorted(tmp_path.iterdir()) == sorted(paths)
    for path in paths:
        content = path.read_bytes()
        assert content.startswith(b"\x89PNG")
        pixels = image(content)
        assert min(pixels.shape[:2]) > 300
        assert pixels[..., :3].std() > 0.03, f"{path.name} is blank"
        # Nothing may run off the paper: the outermost pixels stay white.
        for edge in (pixels[0], pixels[-1], pixels[:, 0], pixels[:, -1]):
            assert edge[..., :3].min() > 0.99, f"{path.name} is cut off"


def test_pictures_are_drawn_once(result):
    assert pictures(result) is pictures(result)


def test_the_hottest_moment_gets_its_own_picture_when_it_is_not_the_end(result, phased):
    assert "temperature-hottest.png" in pictures(phased)
    assert "temperature-hottest.png" not in pictures(result)


def test_a_folder_that_cannot_be_written_is_named(result, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="file"):
        write_pictures(result, tmp_path / "file")


def test_temperature_shows_readings_and_the_hottest_point(result):
    figure = temperature_figure(result)
    shown = texts(figure)
    for name in result.sensor_places:
        assert f"{name} {result.readings[name].iloc[-1]:.1f} °C" in shown
    assert f"hottest {result.history.values[-1].max():.1f} °C" in shown
    assert set(result.study.section.regions) <= set(shown)
    assert "temperature after 120 s" in shown
    assert not overlaps(figure, figure.axes[0])


def test_temperature_at_another_time(result):
    i = len(result.times) // 2
    shown = texts(temperature_figure(result, float(result.times[i])))
    assert f"hottest {result.history.values[i].max():.1f} °C" in shown
    assert f"temperature after {result.times[i]:.4g} s" in shown


def test_colours_cover_exactly_the_computed_temperatures(result):
    figure = temperature_figure(result)
    low, high = figure.axes[0].collections[0].get_clim()
    values = result.history.values[-1]
    assert (low, high) == (values.min(), values.max())


def test_forty_thermocouples_do_not_overlap(study):
    many = {
        f"sensors.t{k:02d}": {"s": f"{0.1 + 0.13 * k:.2f} in", "depth": f"{0.05 + 0.09 * (k % 4)} in"}
        for k in range(32)
    }
    crowded = study.replace(many | {"drive.duration": "10 s"}).run()
    for figure in (temperature_figure(crowded), histories_figure(crowded)):
        axes = figure.axes[0]
        # At this density only the columns' line pitch is left: no two labels of a column closer than their text.
        areas = sorted(boxes(figure, axes), key=lambda box: box.y0)
        pairs = [(a, b) for i, a in enumerate(areas) for b in areas[:i] if a.padded(-1.5).overlaps(b.padded(-1.5))]
        assert not pairs


def test_histories_end_labels_and_phases(phased):
    figure = histories_figure(phased)
    shown = texts(figure)
    for name in phased.sensor_places:
        assert f"{name} {phased.readings[name].iloc[-1]:.1f} °C" in shown
    assert f"contained air {phased.gas_temperature[-1]:.1f} °C" in shown
    assert {"roll", "stand"} <= set(shown)
    speed = next(axes for axes in figure.axes if axes.get_ylabel() == "speed [m/s]").lines[0]
    assert speed.get_ydata().max() == pytest.approx(40 * 0.44704)
    assert speed.get_ydata()[-1] == 0
    assert not overlaps(figure, figure.axes[0])


def test_constant_speed_needs_no_panel(result):
    figure = histories_figure(result)
    assert len(figure.axes) == 1
    assert any("8.94 m/s" in text for text in texts(figure))


@pytest.mark.parametrize("run", ["result", "standing", "phased"])
def test_the_waterfall_comes_back_to_the_residual(run, request):
    budget = request.getfixturevalue(run).heat_budget
    bars = waterfall(budget)
    assert bars[0].start == 0
    assert all(before.end == after.start for before, after in itertools.pairwise(bars))
    assert bars[-1].end == pytest.approx(budget.residual[-1], abs=1e-6 * max(abs(bar.start) for bar in bars))
    top = max(bar.end for bar in bars if bar.kind == "generated")
    assert top == pytest.approx(budget.total("generated"))


def test_budget_names_every_entry(result):
    shown = texts(budget_figure(result))
    for kind, word in (("generated", "generated in"), ("stored", "stored in"), ("lost", "lost to")):
        names = [name for k, name in result.heat_budget.energies if k == kind]
        assert names
        assert all(f"{word} {name}" in shown for name in names)


def test_a_share_that_rounds_to_nothing_has_no_sign(result):
    budget = result.heat_budget
    entries = [(kind, name) for kind, name in budget.energies if kind == "stored"]
    cooled = {key: -1e-9 * series if key == entries[-1] else series for key, series in budget.energies.items()}
    axes = Figure().subplots()
    _energies(axes, waterfall(replace(budget, energies=cooled)), budget)
    numbers = [text.get_text() for text in axes.texts]
    assert any("(0.0 %)" in text for text in numbers)
    assert not any("-0.0" in text for text in numbers)


def test_heat_source_powers_add_up_to_the_drag(result):
    zones = zone_heat(result, len(result.times) - 1)
    total = sum(zone.power for zone in zones)
    assert total == pytest.approx(result.rolling_resistance.force * 8.9408, rel=1e-6)
    shown = texts(heat_source_figure(result))
    for zone in zones:
        assert f"{zone.name}: {zone.title}" in shown
        assert any(f"({100 * zone.power / total:.1f} %)" in text for text in shown)


def strip(values, widths):
    """A zone of strips 1 m high, each of its own value."""
    edges = np.concatenate([[0.0], np.cumsum(widths)])
    points = np.concatenate([[[a, 0], [b, 0], [b, 1], [a, 1]] for a, b in itertools.pairwise(edges)]).T
    corners = np.concatenate(
        [[[4 * i, 4 * i + 1, 4 * i + 2], [4 * i, 4 * i + 2, 4 * i + 3]] for i in range(len(widths))]
    )
    nodal = np.repeat(values, 4)
    return ZoneHeat("one", "one", np.asarray(points, dtype=float), corners, nodal, nodal, 1.0)


@pytest.mark.parametrize(("peak_width", "top"), [(0.005, 2.0), (0.05, 50.0)])
def test_a_colour_scale_spans_99_percent_of_the_area(peak_width, top):
    zone = strip([1.0, 2.0, 50.0], [0.5, 0.5 - peak_width, peak_width])
    assert scale_top([zone], [zone.energy]) == top


def test_heat_in_a_sliver_only_still_has_a_scale():
    zone = strip([0.0, 3.0], [0.999, 0.001])
    assert scale_top([zone], [zone.source]) == 3.0


def test_a_peak_beyond_the_heat_scale_is_told_by_an_arrow_and_its_value(result, monkeypatch):
    from tyrefem.reports.figures import heat_source

    zones = zone_heat(result, len(result.times) - 1)
    highest = max(range(len(zones)), key=lambda n: zones[n].source.max())
    peaked = zones[highest].source.copy()
    peaked[int(peaked.argmax())] = 1e9
    zones[highest] = replace(zones[highest], source=peaked)
    monkeypatch.setattr(heat_source, "zone_heat", lambda *_: zones)
    bars = [axes for axes in heat_source_figure(result).axes if "heat source q" in axes.get_ylabel()]
    assert len(bars) == 1
    assert float(bars[0].get_ylabel().split(", peak ")[1]) > 1000 * bars[0].get_ylim()[1]


def test_zones_keep_their_own_values_at_a_common_border(result):
    zones = {zone.name: zone for zone in zone_heat(result, len(result.times) - 1)}
    carcass, tread = zones["I"], zones["II"]
    places = {tuple(point.round(9)): i for i, point in enumerate(carcass.points.T)}
    shared = [(places[key], j) for j, point in enumerate(tread.points.T) if (key := tuple(point.round(9))) in places]
    assert len(shared) > 5
    assert all(abs(carcass.energy[i] - tread.energy[j]) > 0.05 * carcass.energy[i] for i, j in shared)


def test_section_dimensions(study):
    section = study.section
    shown = texts(section_figure(section, {"probe": study.section_place(study.sensors["crown-inner"])}))
    assert f"{section.overall_width * 1e3:.1f} mm" in shown
    assert any(f"outer diameter {section.outer_diameter * 1e3:.1f} mm" in text for text in shown)
    crown = float(section.total_thickness(0.0)) * 1e3
    assert f"crown: {crown:.1f} mm thick, r {section.outer_diameter * 500:.1f}" in shown
    assert {"probe", "road", "outside air", "rim", "contained air", *section.regions} <= set(shown)


def test_the_half_and_the_full_section_look_the_same(study):
    half, full = (texts(section_figure(s)) for s in (study.section.as_half(), study.section.as_full()))
    assert half == full


def test_strain_title_and_curves(study, result):
    shown = texts(strain_figure(study))
    phase = result.phases[0]
    words = f"deflection {phase.deflection * 1e3:.1f} mm, footprint {phase.footprint_length * 1e3:.0f} mm"
    assert any(words in text and f"{100 * phase.road_fraction:.1f} % of a revolution" in text for text in shown)
    assert "12.01 kN at 572.3 kPa" in " ".join(shown)
    cycle = result.tyre.schedule.cycles[0][0]
    s, hoop, _, energy = along(cycle, "carcass midline")
    # Midline of the crown: e_theta = -D / r, r the midline's radius (crown flat, barrel deformation).
    crown = s < cycle.section.line.shoulder_s
    radius = cycle.section.line.position(s[crown])[:, 0]
    assert hoop[crown] == pytest.approx(-phase.deflection / radius, rel=1e-9)
    assert np.isfinite(energy).all()
    assert np.nanmin(energy) >= 0


def test_a_tyre_without_load_has_no_strain(study):
    unloaded = strain_figure(study.replace({"drive.load": "0 lbf"}))
    assert any("deflection 0.0 mm" in text for text in texts(unloaded))


def test_mesh_counts(result):
    mesh = result.tyre.mesh
    shown = texts(mesh_figure(mesh))
    assert any(f"{mesh.n_nodes} nodes, {mesh.n_elements} quads" in text for text in shown)
    assert any(text.startswith(f"tread: {len(mesh.mesh.subdomains['tread'])} ") for text in shown)


@pytest.mark.parametrize("cell", ["quad", "tri"])
@pytest.mark.parametrize("element", ["P1", "P2"])
def test_cells_fill_the_mesh_without_gaps(study, cell, element):
    tyre = study.replace({"mesh.cell": cell, "mesh.element": element}).mesh()
    from tyrefem.conduction.operators import Operators

    operators = Operators(tyre.mesh, element)
    for cells, parent in (linear_cells(operators), (triangles(operators)[0].T, triangles(operators)[1])):
        x, y = operators.points[:, cells]
        areas = (x * np.roll(y, -1, axis=0) - y * np.roll(x, -1, axis=0)).sum(axis=0) / 2
        assert (areas > 0).all()
        assert np.bincount(parent, areas) == pytest.approx(np.abs(tyre.element_areas), rel=1e-9)


def test_spread_keeps_order_and_gap():
    wanted = np.array([5.0, 1.0, 1.1, 1.2, 9.0])
    placed = spread(wanted, 2.0)
    assert np.diff(np.sort(placed)).min() >= 2.0 - 1e-12
    assert (np.argsort(placed) == np.argsort(wanted)).all()
    # Least squares: the crowded block of four stays centred on where it wanted to be.
    assert placed[:4].mean() == pytest.approx(wanted[:4].mean())


def test_a_dollar_sign_in_the_name_of_a_region_is_no_formula(tmp_path):
    data, _, _ = load("section", "nasa-22x5.5-8pr", None)
    odd = json.loads(json.dumps(data).replace('"sidewall"', json.dumps(r"$\bad$")))
    (tmp_path / "odd.toml").write_text(tomli_w.dumps(odd), encoding="utf-8")
    cards = {"carcass": "nasa-carcass", "bead": "nasa-bead", "tread": "nasa-tread", r"$\bad$": "nasa-sidewall"}
    study = tyrefem.study(
        "nasa-22x5.5-8pr", {"section": str(tmp_path / "odd.toml"), "materials": cards, "mesh.size": "20 mm"}
    )
    for drawn in (mesh_figure(study.mesh()), section_figure(study.section)):
        drawn.draw_without_rendering()
        assert any(r"\bad" in text for text in texts(drawn))
