"""The pressure map on the road: every force in whole on the cells, where it acts."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from tyrefem import study
from tyrefem.cli import main
from tyrefem.mechanics.footprint.press import Pressed, press
from tyrefem.mechanics.rolling.roll import RolledStudy, roll
from tyrefem.reports.pressure_map import PressureMap, _on_cells, _strips, pressed_map, rolled_map

STUDY = "nasa-22x5.5-8pr"
COARSE = {"mesh.size": "12 mm", "mechanics.motion": "linear"}


@pytest.fixture(scope="module")
def pressed() -> Pressed:
    return press(study(STUDY, COARSE), deflection=0.015)


@pytest.fixture(scope="module")
def rolled() -> RolledStudy:
    return roll(study(STUDY, COARSE), slip_angle=0.03, camber=0.02)


def centre(area: PressureMap) -> tuple[float, float]:
    """Centre of pressure, m."""
    total = area.pressure.sum()
    return float(area.pressure.sum(axis=1) @ area.x / total), float(area.pressure.sum(axis=0) @ area.y / total)


@pytest.mark.parametrize("cell", [2e-3, 5e-3, 2e-2])
def test_the_cells_carry_the_load(pressed: Pressed, cell: float) -> None:
    area = pressed_map(pressed.footprint, cell)
    assert area.load == pytest.approx(pressed.footprint.load, rel=1e-12)
    assert area.pressure.min() >= 0
    # A half was solved: both sides are alike, and so are front and rear.
    assert area.pressure == pytest.approx(area.pressure[::-1], abs=1e-6)
    assert area.pressure == pytest.approx(area.pressure[:, ::-1], abs=1e-6)


def test_the_cells_lie_where_the_tyre_touches(pressed: Pressed) -> None:
    area, footprint = pressed_map(pressed.footprint, 1e-3), pressed.footprint
    touched = area.pressure > 0.02 * footprint.mean_pressure
    assert np.ptp(area.x[touched.any(axis=1)]) == pytest.approx(footprint.length, rel=0.1)
    assert np.ptp(area.y[touched.any(axis=0)]) == pytest.approx(footprint.width, rel=0.1)
    # Fine cells have the pressure of the nodes, not the zigzag of their tributary widths.
    assert area.pressure.max() == pytest.approx(footprint.pressure.max(), rel=0.15)


def test_a_rolling_tyre_has_its_centre_of_pressure(rolled: RolledStudy) -> None:
    """On a flat road M_x = y F_z and M_y = -x F_z, (x, y) the centre of pressure."""
    area, state = rolled_map(rolled.state, 2e-3), rolled.state
    assert area.load == pytest.approx(state.force[2], rel=1e-9)
    x, y = centre(area)
    assert x == pytest.approx(-state.moment[1] / state.force[2], abs=1e-3)
    assert y == pytest.approx(state.moment[0] / state.force[2], abs=1e-3)


def test_one_force_is_a_hat_along_and_even_across() -> None:
    x = np.array([[-0.01], [0.0], [0.01]])
    forces = np.array([[0.0], [8.0], [0.0]])
    area = _on_cells(x, np.full((3, 1), 0.0), np.full((3, 1), 0.01), forces, 5e-3)
    assert area.x == pytest.approx([-0.0075, -0.0025, 0.0025, 0.0075])
    assert area.y == pytest.approx([0.0025, 0.0075])
    assert area.pressure * 25e-6 == pytest.approx(np.outer([1, 3, 3, 1], [0.5, 0.5]))


def test_strips_leave_grooves_free() -> None:
    z = np.array([0.0, 0.01, 0.02, 0.03, 0.04])
    low, high = _strips(z, np.array([1.0, 1.0, 1.0, 1.0, 1.0]), np.array([[0.02, 0.03]]))
    assert low == pytest.approx([0.0, 0.02 / 3, 0.04 / 3, 0.03, 0.035])
    assert high == pytest.approx([0.02 / 3, 0.04 / 3, 0.02, 0.035, 0.04])


def test_the_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    flags = ["--set", "mesh.size=12 mm", "--no-pictures", "--no-vtk", "--quiet", "--out"]
    assert main(["press", STUDY, "--motion", "linear", *flags, str(tmp_path / "press")]) == 0
    assert main(["roll", STUDY, *flags, str(tmp_path / "roll")]) == 0
    for folder in ("press", "roll"):
        with (tmp_path / folder / "footprint-pressure.csv").open(encoding="utf-8") as lines:
            rows = list(csv.DictReader(lines))
        assert list(rows[0]) == ["x_m", "y_m", "pressure_Pa"]
        assert sum(float(row["pressure_Pa"]) for row in rows) * 25e-6 == pytest.approx(2700 * 4.4482216, rel=1e-6)


def test_half_and_whole_section_have_one_map(pressed: Pressed) -> None:
    """The tread spreads along the axis under its load, whether the other half is solved or mirrored."""
    whole = press(study(STUDY, {**COARSE, "mesh.section": "full"}), deflection=0.015)
    maps = [pressed_map(each.footprint, 2e-3) for each in (pressed, whole)]
    assert maps[0].y == pytest.approx(maps[1].y)
    assert maps[0].pressure == pytest.approx(maps[1].pressure, abs=1e-6 * maps[0].pressure.max())
