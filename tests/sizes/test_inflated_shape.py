"""Under pressure a section made from its size grows and keeps its shape: the carcass line stays one in equilibrium."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import griddata
from scipy.optimize import least_squares

from tyrefem.geometry.meshing import build
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.solid.inflation import Inflation, inflate
from tyrefem.sizes import draw_size
from tyrefem.sizes.meridian import SizedMeridian, bias_meridian, radial_meridian


def inflated(size: str, mesh_size: float) -> Inflation:
    rules = draw_size(size).rules
    drive = {
        "speed": "60 km/h",
        "load": rules["rated_load"].text,
        "pressure": rules["rated_pressure"].text,
        "duration": "60 s",
        "ambient": "25 degC",
    }
    study = StudyData("sized", {"title": size, "section": size, "materials": {}, "drive": drive}, None, Path())
    return inflate(study, mesh=build(study.section, size=mesh_size, through=1))


def grown(line: SizedMeridian, crown: float, width: float) -> SizedMeridian:
    """The line in equilibrium on the same rim whose crown and half width are larger, m."""
    half, rim = line.half_width + width, (line.rim, line.offset, line.bend)
    if line.membrane.lift:
        return bias_meridian(line.crown + crown, half, *rim, None)[0]
    return radial_meridian(line.crown + crown, line.crown_radius, half, *rim)


def deviations(size: str, mesh_size: float) -> tuple[np.ndarray, tuple[float, float]]:
    """Distance of the inflated carcass line from the nearest grown line in equilibrium, m; its growth."""
    line, state = draw_size(size).meridian, inflated(size, mesh_size)
    r, z, _ = line.at(np.linspace(0.0, line.flange_s, 140))
    places = np.stack([r, z], axis=1)
    moved = np.stack([griddata(state.body.rings.nodes.T, part, places) for part in state.displacement], axis=1)
    inflated_line = (places + moved)[np.isfinite(moved).all(axis=1)]

    def away(growth: np.ndarray) -> np.ndarray:
        other = grown(line, *growth)
        r, z, phi = other.at(np.linspace(0.0, other.length, 1500))
        gap = inflated_line[:, None] - np.stack([r, z], axis=1)
        nearest = np.hypot(gap[..., 0], gap[..., 1]).argmin(axis=1)
        close = gap[np.arange(len(nearest)), nearest]
        return close[:, 0] * np.sin(phi[nearest]) + close[:, 1] * np.cos(phi[nearest])

    start = [float(moved[0, 0]), float(np.nanmax(moved[:, 1]))]
    growth = least_squares(lambda x: 1e3 * away(x), start, diff_step=1e-3, x_scale=1e-3).x
    return away(growth), (float(growth[0]), float(growth[1]))


@pytest.mark.parametrize(
    ("size", "mesh_size"),
    [
        ("205/60R15", 7e-3),
        ("255/40R17", 7e-3),
        ("22x5.5 8PR", 7e-3),
        ("22x5.5 12PR", 8e-3),
        ("LT245/75R16", 8e-3),
    ],
)
def test_the_inflated_line_is_one_in_equilibrium(size: str, mesh_size: float) -> None:
    """Beyond growth at the crown and in width it moves by less than 1 mm, from the crown to the flange."""
    away, (crown, width) = deviations(size, mesh_size)
    assert 0 < crown < 0.008
    assert 0 < width < 0.006
    assert np.abs(away).max() < 1e-3
    assert np.sqrt((away**2).mean()) < 0.5e-3


def test_a_line_out_of_equilibrium_is_told() -> None:
    """The measure tells lines apart: an elliptic wall of the same crown, width and flange is more than 2 mm off."""
    line = draw_size("205/60R15").meridian
    s = np.linspace(line.join_s, line.flange_s, 200)
    r, z, _ = line.at(s)
    middle = (r.max() + r.min()) / 2
    round_wall = np.sqrt(np.maximum(((r.max() - r.min()) / 2) ** 2 - (r - middle) ** 2, 0.0))
    other = z[0] + (line.half_width - z[0]) * round_wall / round_wall.max()
    assert np.abs(other - z).max() > 2e-3
