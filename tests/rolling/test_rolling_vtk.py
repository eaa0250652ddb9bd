"""The whole rolling tyre as a VTK file: closed, on the road, with the forces, energies and friction of the state."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import pyvista
from scipy.spatial import cKDTree

from tyrefem import study
from tyrefem.api import RollingWheel
from tyrefem.reports.figures.rolling import contact_figure
from tyrefem.reports.revolved_rolling import RevolvedRolling

STUDY = "nasa-22x5.5-8pr"
COARSE = {"mesh.size": "12 mm", "mechanics.motion": "linear"}


def rolled(section: str = "half", motion: str = "linear") -> RollingWheel:
    coarser = {"mesh.size": "16 mm"} if motion == "large" else {}
    tyre = study(STUDY, COARSE | coarser | {"mesh.section": section})
    return tyre.roll(slip_angle=math.radians(4), camber=math.radians(3), slip=0.02, motion=motion, tolerance=1.0)


@pytest.fixture(scope="module", params=["linear", "large"])
def leaning(request: pytest.FixtureRequest) -> RollingWheel:
    return rolled(motion=request.param)


@pytest.fixture(scope="module")
def grid(leaning: RollingWheel, tmp_path_factory: pytest.TempPathFactory) -> pyvista.UnstructuredGrid:
    path = leaning.to_vtk(tmp_path_factory.mktemp("vtk") / "out")
    assert sorted(file.name for file in path.parent.iterdir()) == ["contact.vtu", "tyre.vtu"]
    return pyvista.read(path)


def test_colour_bars_point_to_values_beyond_their_end(leaning: RollingWheel) -> None:
    """Few points slide much faster than the others: the colours span the others, with a point for those."""
    axes = contact_figure(leaning).axes
    state = leaning.state
    for number, size in enumerate((state.pressure / 1e3, np.linalg.norm(state.traction, axis=-1) / 1e3)):
        end, touching = axes[2 * number + 1].get_ylim()[1], state.states > 0
        extended = axes[2 * number + 1]._colorbar.extend  # type: ignore[attr-defined]
        assert extended == ("max" if size[touching].max() > end else "neither")
    assert axes[-1].get_ylim()[1] < state.sliding_speed[touching].max()
    assert axes[-1]._colorbar.extend == "max"  # type: ignore[attr-defined]


def test_the_tyre_is_whole_and_not_folded(grid: pyvista.UnstructuredGrid) -> None:
    assert grid.compute_cell_sizes()["Volume"].min() > 0
    surface = grid.extract_surface(algorithm="dataset_surface").clean()
    assert surface.n_points - surface.extract_all_edges().n_cells + surface.n_cells == 0


def test_the_footprint_lies_on_the_road_and_carries_the_forces(
    leaning: RollingWheel, grid: pyvista.UnstructuredGrid
) -> None:
    """The contact's points are points of the tyre; pressure and traction times area are F_x, F_y, F_z."""
    state = leaning.state
    touching = grid["state"] > 0
    assert np.abs(grid.points[touching, 2]).max() < 0.02 * state.deflection
    assert grid.points[:, 2].min() > -0.02 * state.deflection
    places = state.places.T[state.contact.forces[:, 0] > 0]
    # Places of the contact are means over hats, those of the tyre are points.
    assert cKDTree(grid.points).query(places)[0].max() < 5e-4
    surface = grid.extract_surface(algorithm="dataset_surface")
    faces = surface.compute_normals(point_normals=False, auto_orient_normals=True).point_data_to_cell_data()
    area = faces.compute_cell_sizes()["Area"]
    assert -(faces["pressure_Pa"] * area * faces["Normals"][:, 2]).sum() == pytest.approx(state.force[2], rel=0.1)
    for component in (0, 1):
        carried = (faces["traction_Pa"][:, component] * area).sum()
        assert carried == pytest.approx(state.force[component], rel=0.15)


def test_values_of_the_contact_are_those_of_the_state(leaning: RollingWheel, grid: pyvista.UnstructuredGrid) -> None:
    state = leaning.state
    assert grid["pressure_Pa"].max() == pytest.approx(state.pressure.max(), rel=1e-6)
    assert np.linalg.norm(grid["sliding_m_s"], axis=1).max() == pytest.approx(state.sliding_speed.max(), rel=1e-6)
    assert set(np.unique(grid["state"])) == {0, 1, 2}
    assert not (grid["pressure_Pa"][grid["state"] == 0] > state.pressure.max()).any()


def test_displacements_lead_back_to_the_tyre_as_built(leaning: RollingWheel, grid: pyvista.UnstructuredGrid) -> None:
    """Points less displacements are rings about the leaning axle; the loss of the cells is that of a revolution."""
    state, nodes = leaning.state, leaning.wheel.pressed.tyre.body.rings.nodes
    x, y, z = (grid.points - grid["displacement_m"]).T
    camber = state.grid.road.camber
    up, left = z - state.loaded_radius, y - state.loaded_radius * math.tan(camber)
    axial, across = left * math.cos(camber) - up * math.sin(camber), left * math.sin(camber) + up * math.cos(camber)
    assert np.hypot(x, across).max() == pytest.approx(nodes[0].max(), rel=1e-6)
    assert np.hypot(x, across).min() == pytest.approx(nodes[0].min(), rel=1e-6)
    assert np.abs(axial).max() == pytest.approx(nodes[1].max(), rel=1e-5)
    losses = RevolvedRolling.of(leaning).losses
    volumes = grid.compute_cell_sizes()["Volume"]
    lost = sum(loss.energy for loss in losses) / len(losses)
    assert (grid["loss_J_m3"] * volumes).sum() == pytest.approx(lost, rel=0.02)
    stored = sum(loss.stored_by_harmonic.sum() for loss in losses) / len(losses)
    assert (grid["strain_energy_J_m3"] * volumes).sum() == pytest.approx(stored, rel=0.03)


def test_half_and_full_sections_are_the_same_tyre(leaning: RollingWheel) -> None:
    half, full = (
        RevolvedRolling.of(tyre) for tyre in (leaning, rolled("full", leaning.wheel.pressed.footprint.motion))
    )
    distance, nearest = cKDTree(half.displacements[1]).query(full.displacements[1])
    pressure, other = half.point_data["pressure_Pa"][nearest], full.point_data["pressure_Pa"]
    if leaning.wheel.pressed.balanced:
        # The loaded tyre's motions are known as far as forces need them: others of a half than of a full section.
        assert distance.max() < 5e-4
        assert np.abs(pressure - other).sum() < 0.03 * other.sum()
        assert half.strain_energy.sum() == pytest.approx(full.strain_energy.sum(), rel=0.01)
    else:
        assert distance.max() < 1e-5
        assert pressure == pytest.approx(other, rel=5e-3, abs=5e3)
        assert half.strain_energy.sum() == pytest.approx(full.strain_energy.sum(), rel=1e-3)


def test_a_warm_tyre_loses_less_and_has_its_temperature(leaning: RollingWheel, tmp_path: Path) -> None:
    warm = RevolvedRolling.of(leaning, lambda places: 60.0 + 100 * np.abs(places[1]))
    cold = RevolvedRolling.of(leaning)
    assert "temperature_degC" not in cold.cell_data
    assert 60.0 < warm.cell_data["temperature_degC"].min() < warm.cell_data["temperature_degC"].max() < 80.0
    assert warm.loss is not None
    assert cold.loss is not None
    assert warm.loss.sum() < 0.95 * cold.loss.sum()
