"""Free rolling with loss: balance of offset and loss, no loss and no speed as today, direction, strains that lag."""

from __future__ import annotations

import functools
import math
from dataclasses import replace

import numpy as np
import pytest

from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.compliance import TreadCompliance
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.example_tyre import PlainTyre
from tyrefem.mechanics.footprint.loss import RevolutionLoss
from tyrefem.mechanics.footprint.road import Road
from tyrefem.mechanics.footprint.strain_harmonics import StrainHarmonics
from tyrefem.mechanics.rolling.free_rolling import LossyTyre, rolling_resistance
from tyrefem.mechanics.rolling.lagging_strains import LaggingFootprint, LaggingStrains
from tyrefem.mechanics.rolling.lossy_harmonics import LossyHarmonics
from tyrefem.mechanics.rolling.tread_influence import TreadInfluence
from tyrefem.mechanics.solid.body import Prestressed
from tyrefem.mechanics.solid.spin import rolled

DEFLECTION = 0.015


@functools.lru_cache(4)
def state(half: bool = True, spin: float = 0.0) -> Prestressed:
    still = PlainTyre(half=half).state(along=6)
    return rolled(still, np.full(still.bulk.shape, 1100.0), spin)


def rolling(
    tangent: float, *, spin: float = 0.0, drum: float = math.inf, half: bool = True, rising: float = 0.0
) -> LossyTyre:
    """A tyre whose tan delta rises with frequency^``rising`` from its value at 10 Hz."""
    turning = state(half, spin)
    count = len(turning.bulk)
    lossy = LossyHarmonics(
        turning, angular_speed=spin or 20.0, tangents=lambda f: np.full(count, tangent * (f / 10.0) ** rising)
    )
    return LossyTyre(turning, Road(drum), lossy)


@pytest.mark.parametrize(
    ("spin", "drum", "tangent", "rising"),
    [(0.0, math.inf, 0.15, 0.0), (70.0, math.inf, 0.15, 0.1), (70.0, 1.7, 0.3, 0.0), (0.0, 1.7, 0.05, 0.1),
     (70.0, math.inf, 0.5, 0.0)],
)  # fmt: skip
def test_the_axle_puts_in_what_the_rubber_loses(spin: float, drum: float, tangent: float, rising: float) -> None:
    """Torque by the offset of the pressure = energy lost per revolution / 2 pi, within 1 %."""
    resistance = rolling_resistance(rolling(tangent, spin=spin, drum=drum, rising=rising), 180, DEFLECTION)
    assert resistance.by_offset == pytest.approx(resistance.by_loss, rel=1e-2)
    assert resistance.offset > 0
    assert resistance.balance == pytest.approx(2 * np.pi * resistance.torque / resistance.dissipated - 1)


def test_twice_the_loss_is_twice_the_resistance_of_little_loss() -> None:
    little, twice = (rolling_resistance(rolling(tangent), 120, DEFLECTION) for tangent in (0.01, 0.02))
    assert twice.by_loss == pytest.approx(2 * little.by_loss, rel=2e-3)
    assert twice.by_offset == pytest.approx(2 * little.by_offset, rel=1e-2)


@pytest.mark.parametrize("drum", [math.inf, 1.7])
@pytest.mark.parametrize("half", [True, False])
def test_without_loss_it_is_the_footprint_of_today(drum: float, half: bool) -> None:
    for spin in (0.0, 60.0):
        today = Pressing(state(half, spin), Road(drum)).at_deflection(DEFLECTION, 30)
        now = rolling(0.0, spin=spin, drum=drum, half=half).at_deflection(DEFLECTION, 30)
        assert now.load == pytest.approx(today.load, rel=1e-9)
        assert now.rolling_radius == pytest.approx(today.rolling_radius, rel=1e-9)
        assert abs(now.offset) < 1e-12
        assert now.dissipated == 0
        assert now.amplitudes.imag == pytest.approx(0, abs=1e-12)
        assert now.amplitudes.real == pytest.approx(today.amplitudes, abs=1e-9 * np.abs(today.amplitudes).max())
        middle = len(now.grid.angles) // 2
        assert now.pressure[middle : middle + 4] == pytest.approx(today.pressure[:4], rel=1e-8, abs=1e-3)


def test_without_loss_the_balance_is_even() -> None:
    resistance = rolling_resistance(rolling(0.0), 60, DEFLECTION)
    assert resistance.by_loss == 0
    assert resistance.balance == 0


def test_half_and_full_section_agree() -> None:
    half, full = (rolling(0.2, half=half, spin=40.0).at_deflection(DEFLECTION, 36) for half in (True, False))
    assert full.load == pytest.approx(half.load, rel=1e-6)
    assert full.torque == pytest.approx(half.torque, rel=1e-6)
    assert full.dissipated == pytest.approx(half.dissipated, rel=1e-6)


def test_a_load_is_met_and_pressure_moves_to_the_front() -> None:
    result = rolling(0.3).at_load(2000.0, 60, DEFLECTION)
    assert result.load == pytest.approx(2000.0, rel=1e-7)
    along = result.pressure.sum(axis=1) @ result.grid.angles
    assert along > 0


def test_inertia_softens_and_shape_stays() -> None:
    """At constant shape K_n - W^2 M_n is softer than K_n."""
    still, turning = (rolling(0.1, spin=spin).at_deflection(DEFLECTION, 36).load for spin in (0.0, 70.0))
    assert 0.9 * still < turning < 0.99 * still


def test_strains_lag_and_their_loss_is_that_of_the_stiffness() -> None:
    """Loss by e_n : C' : e_n of the complex strains = pi n U* K'' U of the complex stiffness."""
    tyre = rolling(0.25, rising=0.1)
    lagging = tyre.at_deflection(DEFLECTION, 36)
    today = Pressing(tyre.state).at_deflection(DEFLECTION, 36)
    travel = lagging.rolling_radius
    names = ("pressing", "grid", "deflection", "load", "known_stiffness", "forces", "direction", "displacement", "gaps")
    footprint = LaggingFootprint(**{name: getattr(today, name) for name in names}, rolling=lagging, travel=travel)
    cycle = LaggingStrains(footprint)
    law = {region: lambda f, _: np.asarray(0.25 * (f / 10.0) ** 0.1) for region in tyre.state.mesh.subdomains}
    loss = RevolutionLoss(cycle, law, 20.0 * travel)
    assert loss.energy == pytest.approx(lagging.dissipated, rel=1e-9)
    assert loss.rolling_resistance == pytest.approx(lagging.dissipated / (2 * np.pi * travel), rel=1e-9)
    # Without loss strains are even or odd; the lag turns them by less than tan delta on average.
    angles = np.linspace(-0.5, 0.5, 21)
    even = StrainHarmonics(today).strain(angles)
    late = cycle.strain(angles)
    change = np.abs(late - even).max()
    assert 0.01 * np.abs(even).max() < change < 0.5 * np.abs(even).max()
    assert cycle.largest_energy(60).max() == pytest.approx(StrainHarmonics(today).largest_energy(60).max(), rel=0.25)


def test_beyond_its_critical_speed_the_tread_has_no_solution() -> None:
    """Without loss and far beyond, no contact problem is left: an error, not a number."""
    with pytest.raises(InputError, match=r"critical speed|settle|no stiffness"):
        rolling(0.0, spin=600.0).at_deflection(DEFLECTION, 36)


def test_the_other_way_round() -> None:
    """K'' < 0 (material that runs the other way) moves the pressure back by as much."""
    tyre = rolling(0.2)
    back = replace(tyre.harmonics, tangents=lambda f: np.full(len(tyre.state.bulk), -0.2))
    forwards, backwards = (LossyTyre(tyre.state, lossy=lossy) for lossy in (tyre.harmonics, back))
    first, second = (turning.at_deflection(DEFLECTION, 36) for turning in (forwards, backwards))
    assert second.offset == pytest.approx(-first.offset, rel=1e-9)
    assert second.load == pytest.approx(first.load, rel=1e-9)


def test_half_and_full_section_agree_under_any_force() -> None:
    """Points of the whole tread: symmetric and antisymmetric motions both lose."""
    half, full = (
        TreadInfluence(TreadCompliance(rolling(0.3, half=half, spin=40.0).harmonics)).kernel(8, 3)
        for half in (True, False)
    )
    assert half == pytest.approx(full, abs=1e-6 * np.abs(full).max())
    lossless = TreadInfluence(TreadCompliance(rolling(0.0, spin=40.0).harmonics)).kernel(8, 3)
    # Loss tells a point in front from a point behind; also for forces along the axis.
    for component in range(3):
        ahead, behind = half[1, component, :, component], half[3, component, :, component]
        assert np.abs(ahead - behind).max() > 1e-3 * np.abs(ahead).max()
        assert lossless[1, component, :, component] == pytest.approx(
            lossless[3, component, :, component], abs=1e-9 * np.abs(ahead).max()
        )
