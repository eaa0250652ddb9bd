"""The closed forms against finite elements: one-dimensional strips under a constant flux for the time of a contact."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import skfem

from tyrefem.boundaries import friction_names as sliding
from tyrefem.boundaries.friction_names import ICE, RUBBER, TEAK, Solid
from tyrefem.conduction import Conduction, Fixed, Flux, History, Material

#: Relative error of a rise. Measured: 1e-5 at most.
AGREES = 1e-4
STRESS, SPEED, LENGTH = 30e3, 0.5, 0.04


def depths(solid: Solid, time: float) -> np.ndarray:
    """Nodes from the surface to 12 diffusion lengths, the first 1/200 of one away."""
    reach = np.sqrt(solid.diffusivity * time)
    return np.concatenate([[0.0], np.geomspace(reach / 200, 12 * reach, 60)])


def strip(x: np.ndarray, track: Solid, condition: Any) -> Conduction:
    """A planar strip that is insulated but for its surface at x = 0."""
    mesh = skfem.MeshQuad.init_tensor(x, np.array([0.0, 1e-3]))
    mesh = mesh.with_subdomains({"track": lambda p: p[0] > -1}).with_boundaries({"surface": lambda p: p[0] == 0.0})
    material = Material(track.conductivity, track.heat_capacity)
    return Conduction(mesh, {"track": material}, {"surface": condition}, axisymmetric=False, element="P2")


def surface(history: History) -> np.ndarray:
    return np.asarray(history.at([(0.0, 0.5e-3)])[:, 0])


@pytest.mark.parametrize("track", [TEAK, ICE], ids=["teak", "ice"])
def test_surface_of_a_strip_follows_the_square_root_of_time(track: Solid) -> None:
    dwell = LENGTH / SPEED
    flux = sliding.heat_flux(STRESS * LENGTH, SPEED, LENGTH, 1.0)
    times = np.linspace(0.0, dwell, 5)
    edge = sliding.exit_rise_of_stress(STRESS, SPEED, LENGTH, track)
    solved = strip(depths(track, dwell), track, Flux(flux)).transient(times, 0.0, tolerance=edge * 1e-4)
    expected = [sliding.surface_rise(flux, t, track) for t in times]
    assert surface(solved)[1:] == pytest.approx(expected[1:], rel=AGREES)
    assert expected[-1] == pytest.approx(edge, rel=1e-12)


@pytest.mark.parametrize("behind", [0.005, 0.015, 0.1])
def test_surface_falls_off_behind_the_pad_as_equation_4(behind: float) -> None:
    dwell, end = LENGTH / SPEED, (LENGTH + behind) / SPEED
    edge = sliding.exit_rise_of_stress(STRESS, SPEED, LENGTH, TEAK)

    def under_the_pad(x: np.ndarray, t: float) -> np.ndarray:
        return np.full(x.shape[1:], STRESS * SPEED if t < dwell else 0.0)

    problem = strip(depths(TEAK, end), TEAK, Flux(under_the_pad))
    solved = problem.transient([0.0, end], 0.0, tolerance=edge * 1e-4, breakpoints=[dwell])
    assert surface(solved)[-1] / edge == pytest.approx(sliding.fall_off(behind, LENGTH), rel=AGREES)


@pytest.mark.parametrize(("slider", "track"), [(RUBBER, TEAK), (RUBBER, ICE)], ids=["teak", "ice"])
def test_two_solids_share_the_heat_of_their_interface_as_equation_5(slider: Solid, track: Solid) -> None:
    dwell, flux = LENGTH / SPEED, STRESS * SPEED
    x = np.concatenate([-depths(slider, dwell)[:0:-1], depths(track, dwell)])
    mesh = skfem.MeshQuad.init_tensor(x, np.array([0.0, 1e-3]))
    sides: dict[str, Callable[[np.ndarray], np.ndarray]] = {"slider": lambda p: p[0] < 0, "track": lambda p: p[0] > 0}
    mesh = mesh.with_subdomains(sides).with_boundaries({"contact": lambda p: p[0] == 0.0}, boundaries_only=False)
    materials = {"slider": slider, "track": track}
    problem = Conduction(
        mesh,
        {name: Material(solid.conductivity, solid.heat_capacity) for name, solid in materials.items()},
        {"contact": Flux(flux)},
        axisymmetric=False,
        element="P2",
    )
    expected = sliding.shared_rise(flux, dwell, slider, track)
    solved = problem.transient([0.0, dwell], 0.0, tolerance=expected * 1e-4)
    assert surface(solved)[-1] == pytest.approx(expected, rel=AGREES)
    stored = {}
    width = 1e-3
    for name, solid in materials.items():
        side = solved.points[0] <= 0 if name == "slider" else solved.points[0] >= 0
        order = np.argsort(solved.points[0][side])
        along, values = solved.points[0][side][order], solved.values[-1][side][order]
        stored[name] = solid.heat_capacity * np.trapezoid(values, along) * width
    share = stored["track"] / sum(stored.values())
    assert share == pytest.approx(sliding.share_into(track, slider), abs=1e-5)
    # The trapezoidal sum over the graded nodes is 7e-4 too large.
    assert sum(stored.values()) == pytest.approx(flux * dwell * width, rel=2e-3)


def test_flux_into_a_slider_held_at_a_temperature_gives_equation_9() -> None:
    """Equation 7, K theta/sqrt(pi k T), is what a strip takes whose surface is held; over F_0 it is equation 9."""
    slid, flux = 1.0, STRESS * SPEED
    total, dwell = slid / SPEED, LENGTH / SPEED
    held = sliding.surface_rise(flux, dwell, TEAK)
    problem = strip(depths(RUBBER, total), RUBBER, Fixed(held))
    solved = problem.transient([0.0, total], 0.0, tolerance=held * 1e-4)
    into = -solved.field(1).flux_through("surface") / 1e-3
    assert into / flux == pytest.approx(sliding.share_into_slider(LENGTH, slid, RUBBER, TEAK), rel=AGREES)
