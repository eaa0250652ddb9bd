"""Under pressure a section made from its size grows and keeps its shape: the carcass line stays one in equilibrium."""

from __future__ import annotations

import functools
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import griddata
from scipy.optimize import least_squares
from scipy.spatial import cKDTree

from tyrefem.geometry.meshing import build
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.solid.inflation import Inflation, inflate
from tyrefem.sizes import draw_size
from tyrefem.sizes.meridian import SizedMeridian, belted_meridian, bias_meridian, radial_meridian

#: Values of a table, hashable.
Entries = frozenset[tuple[str, str]]
NOTHING: Entries = frozenset()
EVEN: Entries = frozenset({("bead_pressed", "0 mm")})


@functools.cache
def inflated(size: str, mesh_size: float, own_parameters: Entries, other_materials: Entries) -> Inflation:
    parameters, materials = dict(own_parameters), dict(other_materials)
    rules = draw_size(size, parameters).rules
    drive = {
        "speed": "60 km/h",
        "load": rules["rated_load"].text,
        "pressure": rules["rated_pressure"].text,
        "duration": "60 s",
        "ambient": "25 degC",
    }
    section = {"size": size, "parameters": parameters} if parameters else size
    study = StudyData(
        "sized", {"title": size, "section": section, "materials": materials, "drive": drive}, None, Path()
    )
    return inflate(study, mesh=build(study.section, size=mesh_size, through=1))


def grown(line: SizedMeridian, crown: float, width: float, pressed: float = 0.0) -> SizedMeridian:
    """The line in equilibrium on the same rim whose crown and half width are larger, m, bent evenly about the flange;
    ``pressed``: m by which the plies come nearer to the flange."""
    offset = line.offset - pressed
    half, rim = line.half_width + width, (line.rim, offset, line.rim.radius + offset)
    if line.belted:
        return belted_meridian(line.crown + crown, line.belted.edge, line.belted.power, half, *rim)
    if line.membrane.lift:
        return bias_meridian(line.crown + crown, half, *rim, None)[0]
    return radial_meridian(line.crown + crown, line.crown_radius, half, *rim)


@functools.cache
def deviations(
    size: str,
    mesh_size: float,
    parameters: Entries = NOTHING,
    *,
    presses: bool = False,
    materials: Entries = NOTHING,
) -> tuple[np.ndarray, tuple[float, ...]]:
    """Distance of the inflated carcass line from the nearest grown line in equilibrium, m; its growth, and where it
    ``presses`` the bead's rubber also by how much."""
    line, state = draw_size(size, dict(parameters)).meridian, inflated(size, mesh_size, parameters, materials)
    r, z, _ = line.at(np.linspace(0.0, line.flange_s, 140))
    places = np.stack([r, z], axis=1)
    moved = np.stack([griddata(state.body.rings.nodes.T, part, places) for part in state.displacement], axis=1)
    inflated_line = (places + moved)[np.isfinite(moved).all(axis=1)]

    def away(growth: np.ndarray) -> np.ndarray:
        other = grown(line, *growth)
        r, z, phi = other.at(np.linspace(0.0, other.length, 1500))
        line_points = np.stack([r, z], axis=1)
        nearest = cKDTree(line_points).query(inflated_line)[1]
        close = inflated_line - line_points[nearest]
        return close[:, 0] * np.sin(phi[nearest]) + close[:, 1] * np.cos(phi[nearest])

    start = [float(moved[0, 0]), float(np.nanmax(moved[:, 1])), *([0.0] if presses else [])]
    growth = least_squares(lambda x: 1e3 * away(x), start, diff_step=1e-3, x_scale=1e-3).x
    return away(growth), tuple(float(value) for value in growth)


# Of every kind of tyre the narrow and the wide, the high and the low.
@pytest.mark.parametrize(
    ("size", "mesh_size"),
    [
        ("205/60R15", 9e-3),
        ("255/40R17", 9e-3),
        ("22x5.5 8PR", 9e-3),
        ("LT245/75R16", 10e-3),
        ("22x5.5R12 8PR", 8e-3),
        ("295/80R22.5", 14e-3),
        ("295/60R22.5", 16e-3),
        ("445/65R22.5", 16e-3),
        ("46x17R20", 20e-3),
        ("1400x530R23", 20e-3),
        ("H44.5x16.5-21", 20e-3),
        ("56x16 38PR", 14e-3),
    ],
)
def test_the_inflated_line_is_one_in_equilibrium(size: str, mesh_size: float) -> None:
    """Beyond growth at the crown and in width it moves by less than 1 mm, from the crown to the flange."""
    away, (crown, width) = deviations(size, mesh_size)
    radius = draw_size(size).meridian.crown
    assert 0 < crown < 0.035 * radius
    assert -0.001 < width < 0.007
    assert np.abs(away).max() < 1e-3
    assert np.sqrt((away**2).mean()) < 0.6e-3


def test_without_share_and_fabric_a_radial_moves_more() -> None:
    """With an arc under the belts the crown bulges; with a rim strip of rubber alone the plies press it further in."""
    size, soft_chafer = "22x5.5R12 8PR", frozenset({("chafer-fabric", "rubber-chafer")})
    away, (_, _, pressed) = deviations(size, 8e-3, EVEN, presses=True)
    arc, _ = deviations(size, 8e-3, EVEN | {("crown_radius", "210 mm")}, presses=True)
    _, (_, _, soft) = deviations(size, 8e-3, EVEN, presses=True, materials=soft_chafer)
    assert np.abs(away).max() < 0.3e-3
    assert np.sqrt((arc**2).mean()) > 2 * np.sqrt((away**2).mean())
    assert 0.3e-3 < pressed < 0.9 * soft


@pytest.mark.parametrize(("size", "mesh_size"), [("22x5.5R12 8PR", 8e-3), ("56x16 38PR", 14e-3)])
def test_pressed_plies_lie_evenly_about_the_flange(size: str, mesh_size: float) -> None:
    """Drawn evenly about it, plies come nearer to the flange; drawn further away by what they press, they do not."""
    _, (_, _, even) = deviations(size, mesh_size, EVEN, presses=True)
    _, (_, _, pressed) = deviations(size, mesh_size, presses=True)
    assert even > 0.5e-3
    assert abs(pressed) < 0.35 * even


def test_a_line_out_of_equilibrium_is_told() -> None:
    """The measure tells lines apart: an elliptic wall of the same crown, width and flange is more than 2 mm off."""
    line = draw_size("205/60R15").meridian
    s = np.linspace(line.join_s, line.flange_s, 200)
    r, z, _ = line.at(s)
    middle = (r.max() + r.min()) / 2
    round_wall = np.sqrt(np.maximum(((r.max() - r.min()) / 2) ** 2 - (r - middle) ** 2, 0.0))
    other = z[0] + (line.half_width - z[0]) * round_wall / round_wall.max()
    assert np.abs(other - z).max() > 2e-3
