"""VTK files, read back by VTK itself and by meshio: they hold what the result holds."""

from __future__ import annotations

import ast
import logging
import re
import sys
import zlib
from types import SimpleNamespace

import meshio
import numpy as np
import pytest
import pyvista

from tyrefem.reports import view3d
from tyrefem.reports.figures.style import temperature_map
from tyrefem.reports.grids import pyvista_grid
from tyrefem.reports.paraview import script
from tyrefem.reports.temperature_colours import COLOURS
from tyrefem.reports.vtk import saved_times, write_series
from tyrefem.reports.vtu import VtuFile, compressed


@pytest.fixture(scope="module", params=["result", "quadratic"])
def run(request):
    return request.getfixturevalue(request.param)


@pytest.fixture(scope="module")
def series(run, tmp_path_factory):
    return run.to_vtk(tmp_path_factory.mktemp("vtk"))


def numbers_in(file):
    """Kind of number -> name -> number, as a comment of a .vtu or .pvd file says."""
    head = file.read_bytes().partition(b"-->")[0].decode("utf-8")
    kinds = {"region": {}, "zone": {}}
    for kind, number, name in re.findall(r"^ +(region|zone) (\d+) = (.+)$", head, re.MULTILINE):
        kinds[kind][name] = int(number)
    return kinds


def read(series, number):
    return pyvista.read(series.with_name(f"{series.stem}_{number:04d}.vtu"))


def test_the_collection_gives_every_saved_time(run, series):
    reader = pyvista.get_reader(str(series))
    assert reader.time_values == pytest.approx(list(run.field_times))
    reader.set_active_time_value(reader.time_values[-1])
    grid = reader.read()[0]
    assert grid["temperature_degC"] == pytest.approx(run.history.values[-1])


def test_temperatures_at_the_nodes(run, series):
    for number, i in enumerate(saved_times(run)):
        grid = read(series, number)
        assert (grid["temperature_degC"] == run.history.values[i]).all()
        r, z = run.history.points
        assert (grid.points[:, 0] == z).all()
        assert (grid.points[:, 1] == r).all()
        assert grid.n_cells == run.tyre.mesh.n_elements
        assert grid.field_data["TimeValue"][0] == run.times[i]


def test_regions_zones_and_their_areas(run, series):
    grid = read(series, 0)
    sized = grid.compute_cell_sizes()
    normals = grid.extract_surface(algorithm="dataset_surface", nonlinear_subdivision=0).compute_normals(
        auto_orient_normals=False, consistent_normals=False
    )
    assert (normals.cell_data["Normals"][:, 2] > 0.99).all(), "cells must face the viewer"
    for kind, names in (
        ("region", run.study.section.regions), ("zone", [zone.name for zone in run.tyre.schedule.zones]),
    ):  # fmt: skip
        numbers = numbers_in(series)[kind]
        assert list(numbers) == list(names)
        assert numbers == numbers_in(series.with_name(f"{series.stem}_0000.vtu"))[kind]
        assert sorted(numbers.values()) == list(range(1, len(names) + 1))
        for name, number in numbers.items():
            area = sized["Area"][grid[kind] == number].sum()
            assert area == pytest.approx(run.tyre.mesh.area(name), rel=1e-9)


def test_cell_data_give_the_power_back(run, series):
    """Sum of q 2 pi r A over the cells is the power generated, within the rule of cell means on a coarse mesh."""
    grid = read(series, len(saved_times(run)) - 1)
    areas = grid.compute_cell_sizes()["Area"]
    radii = grid.cell_centers().points[:, 1]
    power = (grid["heat_source_W_m3"] * 2 * np.pi * radii * areas).sum()
    factor = 2 if run.study.section.half else 1
    assert factor * power == pytest.approx(run.heat_budget.power("generated")[-1], rel=0.03)
    for zone in run.tyre.schedule.zones:
        here = grid["zone"] == numbers_in(series)["zone"][zone.name]
        energy = run.tyre.sources[zone.name].energy_density(
            run.tyre.problem.points(zone.name), float(run.times[-1]) - 1e-6
        )
        inside = grid["strain_energy_J_m3"][here]
        assert energy.min() * (1 - 1e-9) <= inside.min()
        assert inside.max() <= energy.max() * (1 + 1e-9)


def test_meshio_reads_them_too(run, series):
    mesh = meshio.read(series.with_name(f"{series.stem}_0000.vtu"))
    kinds = {("quad", "P1"): "quad", ("quad", "P2"): "quad9", ("tri", "P1"): "triangle", ("tri", "P2"): "triangle6"}
    assert list(mesh.cells_dict) == [kinds[run.tyre.mesh.cell, run.study.card.mesh.element]]
    assert mesh.point_data["temperature_degC"] == pytest.approx(run.history.values[0])


def test_only_whole_files_with_relative_paths(series):
    text = series.read_text()
    assert str(series.parent) not in text
    kinds = (".pvd", ".vtu", ".py")
    assert all(file.suffix in kinds and not file.name.startswith(".") for file in series.parent.iterdir())
    assert "region 3 = tread" in text


def test_no_arrays_but_those_of_the_run(series):
    """Names are a comment: ParaView lists what there is to see, and the time."""
    assert list(read(series, 0).field_data.keys()) == ["TimeValue"]
    collection = pyvista.get_reader(str(series)).read()[0]
    assert collection.point_data.keys() == ["temperature_degC"]
    assert collection.cell_data.keys() == ["region", "zone", "heat_source_W_m3", "strain_energy_J_m3"]


def test_interrupted_runs_end_with_what_was_reached(stopped, tmp_path):
    series = stopped.to_vtk(tmp_path)
    times = pyvista.get_reader(str(series)).time_values
    assert times[-1] == stopped.times[-1] < stopped.study.card.drive.end
    assert "interrupted" in series.read_text()


@pytest.mark.parametrize("segments", [12, 24])
def test_the_ring_is_closed_and_has_the_regions_volumes(run, segments, tmp_path):
    series = write_series(run, tmp_path, revolved=True, segments=segments)
    assert series.name == f"{run.study.name}.pvd"
    last = len(saved_times(run)) - 1
    ring = pyvista.read(series.with_name(f"{series.stem}-revolved_{last:04d}.vtu"))
    volumes = ring.compute_cell_sizes()["Volume"]
    assert volumes.min() > 0
    # A polygon of n corners in place of the circle: area (n / 2 pi) sin(2 pi / n) of the disc's.
    facets = segments / (2 * np.pi) * np.sin(2 * np.pi / segments)
    mesh = run.tyre.mesh
    for region in run.study.section.regions:
        number = numbers_in(series)["region"][region]
        volume = volumes[ring["region"] == number].sum()
        assert volume == pytest.approx(facets * mesh.volume(region), rel=1e-4)
    assert ring["temperature_degC"].reshape(segments, -1) == pytest.approx(
        np.tile(run.history.values[-1], (segments, 1))
    )
    # Closed: every radial plane is inside, so the surface is that of a torus with Euler number 0.
    surface = ring.extract_surface(algorithm="dataset_surface").clean()
    assert surface.is_manifold
    assert surface.n_points - surface.extract_all_edges().n_cells + surface.n_cells == 0


def test_a_crashing_renderer_gives_none_and_one_line(series, tmp_path, monkeypatch, caplog):
    crash = tmp_path / "crash.sh"
    crash.write_text("#!/bin/sh\nkill -SEGV $$\n")
    crash.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(crash))
    with caplog.at_level(logging.WARNING):
        assert view3d.screenshot(series, tmp_path / "out" / "3d.png") is None
    assert len(caplog.records) == 1
    assert series.name in caplog.text
    assert "code -11" in caplog.text
    assert list((tmp_path / "out").iterdir()) == []


def test_a_renderer_that_hangs_is_given_up(series, tmp_path, monkeypatch, caplog):
    hang = tmp_path / "hang.sh"
    hang.write_text("#!/bin/sh\nexec sleep 60\n")
    hang.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(hang))
    with caplog.at_level(logging.WARNING):
        assert view3d.screenshot(series, tmp_path / "3d.png", timeout=0.3) is None
    assert "longer than 0.3 s" in caplog.text


def test_a_picture_that_was_drawn_is_kept(series, tmp_path, monkeypatch):
    draws = tmp_path / "draws.sh"
    draws.write_text('#!/bin/sh\nprintf \'picture of %s\' "$3" > "$4"\n')
    draws.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(draws))
    png = view3d.screenshot(series, tmp_path / "3d.png")
    assert png == tmp_path / "3d.png"
    assert series.name in png.read_text()


def test_a_grid_in_memory_is_the_one_in_the_file(run, series):
    last = len(saved_times(run)) - 1
    grid, file = pyvista_grid(run, saved_times(run)[last]), read(series, last)
    assert (grid.points == file.points).all()
    assert (grid.cells == file.cells).all()
    assert (grid.celltypes == file.celltypes).all()
    for name in file.point_data.keys() + file.cell_data.keys():
        assert (grid[name] == file[name]).all()
    assert list(grid.field_data["region_names"]) == list(run.study.section.regions)


def test_the_ring_is_compressed_once(run, tmp_path, monkeypatch):
    """Points and cells for all times together, values for one segment: this is what takes the time."""
    sizes = []
    compress = zlib.compress
    monkeypatch.setattr(zlib, "compress", lambda data, level: sizes.append(len(data)) or compress(data, level))
    segments = 36
    series = write_series(run, tmp_path, revolved=True, segments=segments)
    ring = pyvista.read(series.with_name(f"{series.stem}-revolved_0000.vtu"))
    fixed = 4 * ring.n_points * 3 + ring.n_cells * (4 * (ring.cells[0] + 1) + 1)
    changing = (4 * ring.n_points + 4 * 4 * ring.n_cells) / segments * len(saved_times(run))
    plane = sum(file.stat().st_size for file in tmp_path.glob("*.vtu") if "revolved" not in file.name) * 20
    assert sum(sizes) < fixed + changing + plane


@pytest.mark.parametrize("block", [16, 64, 1 << 16])
def test_any_block_is_read_back(block, tmp_path):
    data = np.arange(50, dtype="<f4").tobytes()
    lengths = np.frombuffer(compressed(data, block)[: 4 * (3 + -(-len(data) // block))], "<u4")
    assert lengths[0] == -(-len(data) // block)
    assert lengths[1] == block
    assert lengths[2] == len(data) % block
    points = np.zeros((4, 3))
    points[:, :2] = [[0, 0], [1, 0], [1, 1], [0, 1]]
    file = VtuFile(points, np.array([[0, 1, 2, 3]]), "quad")
    grid = pyvista.read(file.write(tmp_path / "a.vtu", {"v": np.arange(12.0).reshape(4, 3)}, {"n": np.array([7])}))
    assert (grid["v"] == np.arange(12.0).reshape(4, 3)).all()
    assert grid["n"].tolist() == [7]


@pytest.mark.parametrize("revolved", [False, True])
def test_the_script_for_paraview_is_python_and_shows_the_files_beside_it(run, tmp_path, revolved):
    """It was tried in ParaView 5.11, which the tests do not have."""
    series = write_series(run, tmp_path, revolved=revolved, segments=12)
    shown = series.with_name(f"{series.stem}-revolved.pvd") if revolved else series
    tree = ast.parse(shown.with_suffix(".py").read_text(encoding="utf-8"))
    values = {
        node.targets[0].id: ast.literal_eval(node.value)
        for node in tree.body
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name) and node.targets[0].id.isupper()
    }
    assert values["STEM"] == shown.stem
    assert (tmp_path / f"{values['STEM']}.pvd").is_file()
    temperatures = run.history.values[saved_times(run)]
    assert values["LOW"] == pytest.approx(temperatures.min(), abs=0.01)
    assert values["HIGH"] == pytest.approx(temperatures.max(), abs=0.01)
    assert values["REGIONS"] == list(run.study.section.regions)
    assert values["TITLE"] == run.study.title
    assert ("Reflect" in ast.unparse(tree)) == run.study.section.half


def test_a_title_of_rare_signs_is_the_same_in_the_script(run):
    title = "tyre \N{RACING CAR} \"A\" \\ 'B' {x}\n2"
    study = SimpleNamespace(title=title, section=run.study.section)
    lines = script(SimpleNamespace(study=study, history=run.history), "tyre", [0], solid=False).splitlines()
    assert ast.literal_eval(next(line for line in lines if line.startswith("TITLE = "))[8:]) == title


def test_colours_of_the_script_are_those_of_the_pictures() -> None:
    shown, places = temperature_map(), np.linspace(0.0, 1.0, len(COLOURS))
    expected = [(place, *shown(place)[:3]) for place in places]
    assert np.array(COLOURS) == pytest.approx(np.array(expected), abs=6e-5)
