"""A tyre rolled step by step in time, in three dimensions, settles to the steady state by harmonics."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.example_tyre import PlainTyre
from tyrefem.mechanics.footprint.harmonics import Harmonics
from tyrefem.mechanics.rolling.rolling_in_steps import RollingInSteps
from tyrefem.mechanics.rolling.rolling_motion import RollingMotion
from tyrefem.mechanics.rolling.steady_rolling import RollingLoads, SteadyRolling
from tyrefem.mechanics.rolling.tread_influence import TreadInfluence
from tyrefem.mechanics.rolling.wheel_of_hexahedra import WheelOfHexahedra
from tyrefem.mechanics.solid.body import Prestressed

DEFLECTION = 0.02


@pytest.fixture(scope="module")
def state() -> Prestressed:
    return PlainTyre(half=False).state(along=4)


@pytest.fixture(scope="module")
def wheel(state: Prestressed) -> WheelOfHexahedra:
    return WheelOfHexahedra(state, 60)


@pytest.fixture(scope="module")
def tyre(state: Prestressed) -> SteadyRolling:
    return SteadyRolling(Pressing(state), 0.0, 1.0)


@pytest.mark.parametrize(("n", "close"), [(0, 1e-6), (1, 2e-3), (3, 2e-3)])
def test_compliance_of_a_wave_is_that_of_the_harmonic(
    state: Prestressed, wheel: WheelOfHexahedra, n: int, close: float
) -> None:
    """Forces cos(n t), weighted by Simpson's rule as a smooth load on quadratic elements, against K_n^-1.

    A belt that hardly stretches makes coarse hexahedra a little too stiff in bending round the wheel.
    """
    points = TreadInfluence(Pressing(state).tread)
    order = np.lexsort((points.places[0].round(9), points.places[1].round(9)))
    assert points.places[:, order] == pytest.approx(wheel.places, abs=1e-9)
    exact = points._of(Harmonics(state), n)[0][:, 0][np.ix_(order, order)]
    levels = np.arange(2 * wheel.sectors)
    weights = wheel.level * np.where(levels % 2, 4 / 3, 2 / 3)
    # At level 0: the load lies on level -d.
    radial = np.zeros_like(exact)
    for d in levels:
        radial += wheel.influence[d % 2, d, :, 0, :, 0] * weights[-d] * math.cos(n * d * wheel.level)
    assert np.abs(radial - exact).max() < close * np.abs(exact).max()


def test_influence_is_reciprocal(wheel: WheelOfHexahedra) -> None:
    compliance = wheel.compliance(3, 5)
    size = compliance.shape[0] * compliance.shape[1] * 3
    square = compliance.reshape(size, size)
    assert np.abs(square - square.T).max() < 1e-9 * np.abs(square).max()


@pytest.mark.parametrize(("degrees", "slip", "turns"), [(4.0, -0.02, 0.5), (0.0, 0.02, 1.0)])
def test_it_settles_to_the_steady_state(
    tyre: SteadyRolling, wheel: WheelOfHexahedra, degrees: float, slip: float, turns: float
) -> None:
    given = RollingLoads(deflection=DEFLECTION, torque=0.0)
    angle, travel = math.radians(degrees), tyre.roll(RollingMotion(), given, 120).travel
    travel /= (1 + slip) * math.cos(angle)
    steady = tyre.roll(RollingMotion(angle), RollingLoads(deflection=DEFLECTION, travel=travel), 120)
    rolling = RollingInSteps(wheel, DEFLECTION, travel, angle, 1.0, substeps=6)
    states = rolling.run(turns)
    values, change = rolling.steady(states)
    assert change < 2e-3
    level = np.hypot(*steady.force[:2])
    assert np.abs(values[:2] - steady.force[:2]).max() < 0.03 * level
    assert values[2] == pytest.approx(steady.force[2], rel=0.003)
    assert abs(values[3] - steady.moment[2]) < 0.03 * max(abs(steady.moment[2]), 0.01 * level)
    assert values[5] == pytest.approx(steady.friction_power, rel=0.03)
    # The tyre stood without shear.
    assert np.abs(states[0].values[[0, 1, 4]]).max() < 1e-6 * states[0].values[2]


def test_friction_turns_the_power_of_the_axle_into_heat(wheel: WheelOfHexahedra) -> None:
    angle = math.radians(6.0)
    rolling = RollingInSteps(wheel, DEFLECTION, 0.315, angle, 0.7, substeps=4)
    (forward, left, up, _, torque, power), _ = rolling.steady(rolling.run(0.4))
    assert math.hypot(forward, left) <= 0.7 * up * (1 + 1e-9)
    axle = torque / rolling.travel - forward * math.cos(angle) - left * math.sin(angle)
    assert power == pytest.approx(axle, rel=0.01)


def test_impossible_values_are_refused(state: Prestressed, wheel: WheelOfHexahedra) -> None:
    with pytest.raises(InputError, match="full section"):
        WheelOfHexahedra(PlainTyre().state(along=3), 40)
    with pytest.raises(InputError, match="three sectors"):
        WheelOfHexahedra(state, 2)
    with pytest.raises(InputError, match="1 or more"):
        RollingInSteps(wheel, DEFLECTION, 0.3, 0.0, 1.0, substeps=0)
    with pytest.raises(InputError, match="between 0 and pi/2"):
        RollingInSteps(wheel, DEFLECTION, 0.3, 0.0, 1.0, window=2.0)
