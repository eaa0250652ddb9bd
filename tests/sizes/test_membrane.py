"""Carcass lines in equilibrium: balance of the membrane, closed forms, exact lengths."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from tyrefem.geometry.spline import SplineLine
from tyrefem.sizes import draw_size
from tyrefem.sizes.crown import BeltedCrown
from tyrefem.sizes.membrane import Membrane
from tyrefem.sizes.meridian import SizedMeridian

pytestmark = pytest.mark.fast
SIZES = ("205/60R15", "255/40R17", "LT245/75R16", "295/80R22.5", "22x5.5 8PR", "40x14", "46x17R20")


@pytest.mark.parametrize("lift", [0.0, np.cos(np.radians(36)) / 0.26])
def test_the_line_balances_the_pressure(lift: float) -> None:
    """N_phi kappa_phi + N_theta kappa_theta = p, curvature by differences of the line itself."""
    membrane = Membrane(0.21, 0.015 * (np.sqrt(1 - (lift * 0.26) ** 2) if lift else 1.0), lift)
    top = np.arcsin(min(float(membrane.sine(0.25)), 0.99))
    phi, r, _, s = membrane.run(top, -0.8, 4001)
    bend = -np.gradient(phi, s)
    cotangent = (lift * r) ** 2 / (1 - (lift * r) ** 2)
    pressure = membrane.tension(r) * (bend + cotangent * np.sin(phi) / r)
    assert np.abs(pressure[2:-2] - 1).max() < 1e-5
    assert np.abs(membrane.residual(r)).max() < 1e-12


@pytest.mark.parametrize("lift", [0.0, np.cos(np.radians(36)) / 0.26])
def test_the_axial_pull_is_the_pressure_on_the_ring(lift: float) -> None:
    """2 pi r N_phi sin(phi) = pi p (r^2 - r_m^2)."""
    membrane = Membrane(0.21, 0.012, lift)
    r = np.linspace(0.18, 0.25, 40)
    assert 2 * r * membrane.tension(r) * membrane.sine(r) == pytest.approx(r**2 - 0.21**2, abs=1e-15)


def test_the_radial_line_is_the_integral_of_tan_phi() -> None:
    membrane = Membrane(0.25, 0.3**2 - 0.25**2)

    def slope(r: float) -> float:
        sine = float(membrane.sine(r))
        return sine / np.sqrt(1 - sine**2)

    first, last = np.arcsin(float(membrane.sine(0.29))), 0.0
    z = membrane.run(first, last, 30)[2][-1]
    assert z == pytest.approx(quad(slope, 0.25, 0.29)[0], rel=1e-10)


def test_bias_plies_agree_with_their_differential_equation() -> None:
    """dr/ds = -cos phi, dz/ds = sin phi, dphi/ds = -(p/N_phi - cot^2(alpha) sin(phi)/r), the balance as a shell's."""
    crown, angle, widest = 0.262, np.radians(34), 0.208
    lift = np.cos(angle) / crown
    membrane = Membrane(widest, (crown**2 - widest**2) * np.sin(angle), lift)

    def rates(_: float, x: np.ndarray) -> list[float]:
        r, _, phi = x
        # Tension along a cord is constant where the membrane is in balance: r N_phi sin(alpha) = p A/2.
        tension = membrane.constant / (2 * r * np.sqrt(1 - (lift * r) ** 2))
        cotangent = (lift * r) ** 2 / (1 - (lift * r) ** 2)
        return [-np.cos(phi), np.sin(phi), -(1 / tension - cotangent * np.sin(phi) / r)]

    _, r, z, s = membrane.run(np.pi / 2, -0.7, 80)
    answer = solve_ivp(rates, (0, s[-1]), [crown, 0.0, np.pi / 2], rtol=1e-11, atol=1e-13)
    assert answer.y[0, -1] == pytest.approx(r[-1], abs=1e-8)
    assert answer.y[1, -1] == pytest.approx(z[-1], abs=1e-8)
    assert answer.y[2, -1] == pytest.approx(-0.7, abs=1e-7)


@pytest.mark.parametrize("size", SIZES)
def test_the_line_is_smooth_ends_on_the_seat_and_keeps_its_length(size: str) -> None:
    line = draw_size(size).meridian
    _, r, z, phi = line._line
    assert np.hypot(np.diff(r), np.diff(z)).sum() == pytest.approx(line.length, rel=1e-4)
    assert np.abs(np.diff(phi)).max() < 0.05
    heel = np.array(line.rim.heel)
    normal = np.array([np.sin(phi[-1]), np.cos(phi[-1])])
    assert np.array([r[-1], z[-1]]) + line.offset * normal == pytest.approx(heel, abs=1e-9)
    assert phi[-1] == line.rim.taper


@pytest.mark.parametrize("size", SIZES)
def test_the_points_of_a_file_give_the_line_again(size: str) -> None:
    """The spline through the points of the file is in balance, too, away from the ends of the membrane."""
    line = draw_size(size).meridian
    drawn = SplineLine(tuple(line.points(44)), 0.5 * line.length)
    assert drawn.length == pytest.approx(line.length, rel=2e-4)
    s = np.linspace(line.join_s + 0.1 * (line.flange_s - line.join_s), line.flange_s - 0.1 * line.length, 60)
    r, z = drawn.position(s).T
    exact_r, exact_z, phi = line.at(s)
    assert np.hypot(r - exact_r, z - exact_z).max() < 5e-5
    tension = line.membrane.tension(r)
    cotangent = (line.membrane.lift * r) ** 2 / (1 - (line.membrane.lift * r) ** 2)
    pressure = tension * (drawn.curvature(s) + cotangent * np.sin(phi) / r)
    assert np.abs(pressure - 1).max() < 0.03


def test_plies_hang_over_the_flange_of_a_narrow_rim() -> None:
    """C40x14-21: a rim of half the width. The plies leave it axially; bent evenly about the flange, beyond that
    direction. Both lines are in equilibrium."""
    drawn = draw_size("C40x14-21 24PR")
    assert drawn.rules["rim_width"].value < 0.55 * drawn.rules["section_width"].value
    even = draw_size("C40x14-21 24PR", {"bead_pressed": "0 mm"})
    assert -1.9 < even.meridian.leaves < -np.pi / 2
    assert even.meridian.leaves < drawn.meridian.leaves < -1.55
    for line in (drawn.meridian, even.meridian):
        s = np.linspace(0.0, line.flange_s, 200)
        assert np.abs(line.membrane.residual(line.at(s)[0])).max() < 1e-9
    assert draw_size("22x5.5 8PR").meridian.leaves > -1.55


@pytest.mark.parametrize("power", [2.0, 5.0])
def test_belt_and_plies_together_carry_the_pressure_under_the_belt(power: float) -> None:
    """N_phi kappa_phi + g p = p and 2 pi r N_phi sin phi = pi p (r^2 - r_m^2), curvature by differences of the line."""
    crown = BeltedCrown(0.3, 0.24, 0.07, 0.85, power)
    s, r, z, phi = crown.line
    tension = (r**2 - 0.24**2) / (2 * r * np.sin(phi))
    share = np.array([crown.share_at(place) for place in s])
    assert (-tension * np.gradient(phi, s) + share)[2:-2] == pytest.approx(1.0, abs=2e-3)
    assert np.gradient(r, s)[2:-2] == pytest.approx(-np.cos(phi[2:-2]), abs=1e-3)
    assert np.gradient(z, s)[2:-2] == pytest.approx(np.sin(phi[2:-2]), abs=1e-3)
    assert crown.radius == pytest.approx(tension[0] / (1 - 0.85))


@pytest.mark.parametrize(("size", "power"), [("295/80R22.5", "2"), ("46x17R20", "6")])
def test_the_belts_share_ends_at_the_belts_edge_without_a_jump(size: str, power: str) -> None:
    """Same width on the same rim; the curvature goes on behind the edge, where the arc's jumps to several times its."""
    radius = {"295/80R22.5": "708 mm", "46x17R20": "648 mm"}[size]
    arc, drawn = draw_size(size, {"crown_radius": radius}), draw_size(size, {"belt_power": power})
    line, rules = drawn.meridian, drawn.rules
    widest = max(rules[name].value for name in rules.numbers if "belt" in name and name.endswith("_width"))
    assert line.join_s == pytest.approx(widest / 2, abs=1e-6)
    assert line.half_width == pytest.approx(arc.meridian.half_width, abs=5e-6)
    assert rules["crown_radius"].value == pytest.approx(line.belted.radius)

    def jump(meridian: SizedMeridian) -> float:
        end, step = meridian.join_s, 1e-3
        phi = meridian.at(np.array([end - 2 * step, end - step, end + step, end + 2 * step]))[2]
        return float((phi[2] - phi[3]) / (phi[0] - phi[1]))

    assert 0.9 < jump(line) < 1.2
    assert jump(arc.meridian) > 4


@pytest.mark.parametrize(("size", "power"), [("295/80R22.5", 2.0), ("22x5.5R12 8PR", 6.0)])
def test_kinds_without_a_cap_ply_have_a_power_of_their_rules(size: str, power: float) -> None:
    """The truck's is solved for within 2 to 5, the aircraft radial's is 6; passengers have an arc."""
    drawn = draw_size(size)
    assert drawn.rules["belt_power"].value == power
    assert drawn.meridian.belted is not None
    passenger = draw_size("205/60R15")
    assert passenger.meridian.belted is None
    assert "belt_power" not in passenger.rules.numbers


def test_the_trucks_power_gives_the_crown_radius_of_its_rule() -> None:
    """Between 2 and 5 the crown is as flat as 2.4 nominal widths, to the hundredth of the power."""
    rules = draw_size("315/70R22.5").rules
    assert 2 < rules["belt_power"].value < 5
    assert rules["crown_radius"].value == pytest.approx(2.4 * 0.315, rel=0.01)
