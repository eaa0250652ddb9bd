"""What `tyrefem press` writes of a tyre: the revolved VTK, cord tensions, places of the strain cycle, camber."""

from __future__ import annotations

import csv
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import pyvista

from tyrefem import study
from tyrefem.errors import InputError
from tyrefem.geometry.meshing import build, write
from tyrefem.mechanics.footprint.cord_cycle import cord_cycles
from tyrefem.mechanics.footprint.footprint import Footprint
from tyrefem.mechanics.footprint.press import Pressed, press
from tyrefem.reports.figures.footprint import strain_history_figure
from tyrefem.reports.press import RevolvedTyre, titled_places, write_files
from tyrefem.reports.press_places import cycle_places, read_place

STUDY = "nasa-22x5.5-8pr"
COARSE = {"mesh.size": "12 mm", "mechanics.motion": "linear"}


@pytest.fixture(scope="module")
def pressed() -> Pressed:
    return press(study(STUDY, COARSE), deflection=0.015)


@pytest.fixture(scope="module")
def grid(pressed: Pressed, tmp_path_factory: pytest.TempPathFactory) -> pyvista.UnstructuredGrid:
    path = RevolvedTyre(pressed).write(tmp_path_factory.mktemp("vtk") / "tyre.vtu")
    assert [file.name for file in path.parent.iterdir()] == ["tyre.vtu"]
    return pyvista.read(path)


def test_the_revolved_tyre_is_whole_and_not_folded(pressed: Pressed, grid: pyvista.UnstructuredGrid) -> None:
    """Every region keeps its volume (rubber hardly compresses); the surface is closed like a torus."""
    volumes = grid.compute_cell_sizes()["Volume"]
    assert volumes.min() > 0
    section = pressed.study.section
    for region in section.regions:
        here = grid["region"] == section.regions.index(region) + 1
        # Straight sides of 6 degrees take off 0.2 %, those of coarse elements the rest.
        assert volumes[here].sum() == pytest.approx(2 * section.volume(region), rel=0.02)
    surface = grid.extract_surface(algorithm="dataset_surface").clean()
    assert surface.n_points - surface.extract_all_edges().n_cells + surface.n_cells == 0


def test_words_tell_whether_the_tolerance_is_met(pressed: Pressed) -> None:
    error, words = pressed.footprint.error, f"{pressed.footprint.harmonics}, error {pressed.footprint.error:.2%} "
    assert pressed.accuracy == f"{words}(allowed 2%)"
    missed = replace(pressed, tolerance=0.5 * error).accuracy
    assert missed.startswith(f"{words}(more than the {50 * error:.3g}% wanted")


def test_the_axes_turn_and_do_not_mirror(pressed: Pressed) -> None:
    """Forward, down and left are right-handed; so are their images in the file, x axial, y up and z forward."""
    forward, down, left = RevolvedTyre(pressed).in_space(np.eye(3)).T
    assert np.linalg.det(np.stack([forward, down, left])) == pytest.approx(1)
    assert left.tolist() == [1, 0, 0]
    assert forward.tolist() == [0, 0, 1]


def test_the_flat_is_flat_and_carries_the_load(pressed: Pressed, grid: pyvista.UnstructuredGrid) -> None:
    """Where pressure acts the tread lies on the road; pressure times the area's projection is the load."""
    touching = grid["contact_pressure_Pa"] > 0
    height = grid.points[touching][:, 1] + pressed.footprint.loaded_radius
    assert np.abs(height).max() < 0.04 * pressed.footprint.deflection
    assert np.ptp(grid.points[touching][:, 2]) == pytest.approx(pressed.footprint.length, rel=0.35)
    # Nothing hangs through the road.
    assert grid.points[:, 1].min() > -pressed.footprint.loaded_radius - 0.04 * pressed.footprint.deflection
    surface = grid.extract_surface(algorithm="dataset_surface").compute_normals(
        point_normals=False, auto_orient_normals=True
    )
    faces = surface.point_data_to_cell_data().compute_cell_sizes()
    carried = -(faces["contact_pressure_Pa"] * faces["Area"] * faces["Normals"][:, 1]).sum()
    assert carried == pytest.approx(pressed.footprint.load, rel=0.1)


def test_displacements_lead_back_to_the_tyre_as_built(pressed: Pressed, grid: pyvista.UnstructuredGrid) -> None:
    """Points less displacements are rings of the undeformed mesh; energy lost in the cells is that of a revolution."""
    x, y, z = (grid.points - grid["displacement_m"]).T
    r, nodes = np.hypot(y, z), pressed.tyre.body.rings.nodes
    assert r.max() == pytest.approx(nodes[0].max(), rel=1e-6)
    assert r.min() == pytest.approx(nodes[0].min(), rel=1e-6)
    assert np.abs(x).max() == pytest.approx(nodes[1].max(), rel=1e-6)
    volumes = grid.compute_cell_sizes()["Volume"]
    assert pressed.loss is not None
    assert (grid["loss_J_m3"] * volumes).sum() == pytest.approx(pressed.loss.energy, rel=0.02)
    # The mean over the wheel of e : C' : e / 2 by angles is its sum by harmonics (Parseval).
    stored = (grid["strain_energy_J_m3"] * volumes).sum()
    assert stored == pytest.approx(pressed.loss.stored_by_harmonic.sum(), rel=0.03)


def test_a_fine_mesh_is_written_coarser(pressed: Pressed) -> None:
    coarse, fine = RevolvedTyre(pressed, most_points=1), RevolvedTyre(pressed)
    assert 4 * len(coarse.cells) == len(fine.cells)
    assert len(coarse.displacements[1]) < 0.4 * len(fine.displacements[1])


def test_cord_tension_is_the_derivative_of_the_cords_law(pressed: Pressed) -> None:
    """Tension less that of inflation: the large-displacement law under a small part of the strain, scaled up."""
    tyre, part = pressed.tyre, 1e-5
    cycles = cord_cycles(tyre, pressed.cycle, count=73)
    assert len(cycles) > 0
    for cycle in cycles:
        assert cycle.plus == pytest.approx(cycle.minus[::-1], rel=1e-9)
        layer = tyre.body.parts[cycle.region].cords[0]
        members = np.asarray(tyre.body.mesh.subdomains[cycle.region])
        points = tyre.body.rings.points[:, members]
        place = np.unravel_index(
            int(np.hypot(*(points - np.reshape(cycle.place, (2, 1, 1)))).argmin()), points.shape[1:]
        )
        e = pressed.cycle.strain(np.zeros(1), members)[..., 0]
        # In the middle of the footprint both shears with theta are zero: cords at + and - angle stretch alike.
        small = np.zeros((3, 3, *e.shape[1:]))
        small[0, 0], small[1, 1], small[2, 2] = e[:3]
        small[0, 1] = small[1, 0] = e[3] / 2
        here = tyre.deformation[:, :, members]
        later = here + part * np.einsum("ij...,jk...->ik...", small, here)
        law = layer.stress_in_layer if cycle.unit == "Pa" else layer.tension
        change = (law(later) - law(here))[place] / part
        assert cycle.plus[36] - cycle.inflated == pytest.approx(change, rel=1e-3, abs=1e-3 * abs(cycle.plus).max())


def test_places_of_the_strain_cycle(pressed: Pressed) -> None:
    (worst,) = cycle_places(pressed)
    assert pressed.loss is not None
    assert pressed.loss.density[worst.element, worst.point] == pressed.loss.density.max()
    region, near = cycle_places(pressed, ["sidewall", "275 mm, -2 cm"])
    assert region.region == "sidewall"
    inside = pressed.tyre.body.mesh.subdomains["sidewall"]
    assert pressed.loss.density[region.element, region.point] == pressed.loss.density[inside].max()
    assert math.hypot(near.place[0] - 0.275, near.place[1] - 0.02) < 0.006
    for text, words in (
        ("treat", "nor a region; did you mean 'tread'"),
        ("1 m, 2 m", "is not in the section, whose nearest point is"),
        ("275, 20 mm", "'275' has no unit"),
        ("1 mm, 2 mm, 3 mm", "is not a place"),
    ):
        with pytest.raises(InputError, match=words) as caught:
            read_place(pressed.study.section, text)
        assert caught.value.field == "at"


def test_tables_hold_what_the_pictures_show(pressed: Pressed, tmp_path: Path) -> None:
    write_files(pressed, tmp_path, cycle_places(pressed, ["tread"]), pressed.curve(2), vtk=False)
    assert not (tmp_path / "tyre.vtu").exists()
    names = ("section", "section-loaded", "pressure", "load-deflection", "strain-cycle", "harmonics", "cord-tension")
    for name in names:
        assert (tmp_path / f"{name}.png").read_bytes().startswith(b"\x89PNG")
    assert pressed.loss is not None
    with (tmp_path / "harmonics.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == pressed.footprint.harmonics
    assert sum(float(row["loss_per_revolution_J"]) for row in rows) == pytest.approx(pressed.loss.energy, rel=1e-6)
    with (tmp_path / "strain-cycle.csv").open() as file:
        cycle = list(csv.DictReader(file))
    assert {row["region"] for row in cycle} == {"tread"}
    # The place before inflation in both, though the tread moves 3.7 mm outwards.
    picture = strain_history_figure(pressed.cycle, titled_places(pressed, cycle_places(pressed, ["tread"])), count=9)
    r, z = (1e3 * float(cycle[0][name]) for name in ("r_m", "z_m"))
    assert picture.axes[0].get_title(loc="left") == f"tread, tread (r {r:.0f}, z {z:.0f} mm)"
    # Shears with theta are odd in the angle, the rest even.
    for component, sign in (("e_tt", 1), ("e_rt", -1)):
        history = np.array([float(row[component]) for row in cycle])
        assert history == pytest.approx(sign * history[::-1], abs=1e-7)
    with (tmp_path / "cord-tension.csv").open() as file:
        assert {row["region"] for row in csv.DictReader(file)} == {"carcass", "bead"}


def centre_of_pressure(footprint: Footprint) -> float:
    """Axial place of the contact force, m."""
    z = np.tile(footprint.grid.tread.places[1], footprint.grid.n_angles)
    return float(np.average(z, weights=footprint.forces))


def test_camber_makes_the_section_whole_and_loads_one_side() -> None:
    press_result = press(study(STUDY, COARSE), deflection=0.015, camber=math.radians(3), tolerance=0.1)
    assert not press_result.study.section.half
    # A round crown rolls over to the side that comes down, by at most its radius (here 88 mm) times the angle.
    assert 1e-3 < centre_of_pressure(press_result.footprint) < 88e-3 * math.sin(math.radians(3))
    assert press_result.footprint.pressure_integral == pytest.approx(press_result.footprint.load, rel=1e-9)
    assert press_result.summary()["camber_rad"] == pytest.approx(math.radians(3))


def test_unequal_sides_come_as_a_mesh_of_the_whole_section(tmp_path: Path) -> None:
    """One side drawn 4 % wider: the contact force leaves the mid plane, which it does not in a symmetric tyre."""
    section = study(STUDY).section.as_full()
    mesh = build(section, size=24e-3, through=1).mesh
    mesh.doflocs[1] = np.where(mesh.p[1] > 0, 1.04 * mesh.p[1], mesh.p[1])
    file = write(mesh, tmp_path / "unequal.msh")
    changes = {"mesh.file": str(file), "mesh.section": "full", "mechanics.motion": "linear"}
    footprint = press(study(STUDY, changes), deflection=0.015, tolerance=0.1).footprint
    assert abs(centre_of_pressure(footprint)) > 2e-4
    assert footprint.pressure_integral == pytest.approx(footprint.load, rel=1e-9)
