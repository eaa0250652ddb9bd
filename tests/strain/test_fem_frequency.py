"""Every harmonic of the strain law "fem" at its own frequency, and the one cycle of the report beside it."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.mechanics.cycle_schedule import CycleSchedule
from tyrefem.mechanics.finite_elements import FiniteElements
from tyrefem.mechanics.footprint.loss import RevolutionLoss
from tyrefem.mechanics.footprint.strain_harmonics import StrainHarmonics
from tyrefem.mechanics.strain_cycle import ORDERS, by_order
from tyrefem.simulation.rolling_tyre import RollingTyre

REGIONS = ("carcass", "tread", "sidewall", "bead")
POWER = {"law": "power", "exponent": 0.25, "reference": "10 Hz", "source": "test"}
PRONY = {
    "law": "prony",
    "equilibrium": "1 MPa",
    "series": [["0.4 MPa", "0.1 ms"], ["0.2 MPa", "3 ms"], ["0.2 MPa", "30 ms"]],
    "shift": {"c1": 8.86, "c2": "101.6 delta_degC", "reference": "20 degC"},
    "source": "test",
}


def study(frequency: dict[str, Any] | None, **changes: Any) -> tf.Study:
    base = {"mechanics.strain": "fem", "mechanics.motion": "linear", "mesh.size": "10 mm", "drive.duration": "60 s"}
    base |= changes
    cards = {} if frequency is None else {f"materials.{r}.loss_tangent.frequency": frequency for r in REGIONS}
    return tf.study("nasa-22x5.5-8pr", {**base, **cards})


@functools.cache
def pressed() -> FiniteElements:
    cycle = RollingTyre(study(None)).schedule.cycles[0][0]
    assert isinstance(cycle, FiniteElements)
    return cycle


def test_orders_share_harmonics_and_keep_their_sum() -> None:
    harmonics = np.random.default_rng(1).random((55, 3))
    parts = by_order(harmonics)
    assert parts.sum(axis=0) == pytest.approx(harmonics[1:].sum(axis=0))
    exponent, n = 0.3, np.arange(1, 55)[:, None]
    exact = (n**exponent * harmonics[1:]).sum(axis=0)
    weights = np.array(ORDERS[: len(parts)])[:, None] ** exponent
    assert (weights * parts).sum(axis=0) == pytest.approx(exact, rel=1e-3)
    omega = n / 7.0
    maxwell, each = omega / (1 + omega**2), np.array(ORDERS[: len(parts)])[:, None] / 7.0
    lost = (each / (1 + each**2) * parts).sum(axis=0)
    assert lost == pytest.approx((maxwell * harmonics[1:]).sum(axis=0), rel=4e-3)
    assert by_order(harmonics[:2]) == pytest.approx(harmonics[1:2])


@pytest.mark.parametrize("frequency", [POWER, PRONY])
def test_the_heat_is_that_of_every_harmonic_at_its_own_frequency(frequency: dict[str, Any]) -> None:
    """q = f sum_n n pi tan d(n f, T) e_n : C' : e_n at the Gauss points, with a temperature of their own each."""
    tyre = RollingTyre(study(frequency), None, schedule())
    cycle, region = pressed(), "tread"
    members = cycle.tyre.body.mesh.subdomains[region]
    x = cycle.tyre.body.rings.points[:, members].reshape(2, -1)
    T = np.linspace(20.0, 90.0, x.shape[1])
    law = tyre.study.materials[region].loss_tangent
    temperature = np.full(cycle.tyre.body.rings.weights.shape, 25.0)
    temperature[members] = T.reshape(len(members), -1)
    reference = RevolutionLoss(
        StrainHarmonics(cycle.footprint), {region: law.over_frequency}, tyre.speed(0.0), temperature
    )
    heat = tyre.hysteresis[region](x, 0.0, T)
    assert heat == pytest.approx(reference.frequency * reference.density[members].ravel(), rel=4e-3)
    alike = RollingTyre(study(None), None, schedule()).hysteresis[region](x, 0.0, T)
    assert np.abs(heat / alike - 1).mean() > 0.05


def test_one_cycle_loses_what_the_footprints_own_account_of_the_reports_convention_does() -> None:
    changes = {"mechanics.revolution": "one-cycle"}
    pressed_cycle = pressed()
    single = FiniteElements(
        pressed_cycle.tyre, pressed_cycle.footprint, pressed_cycle.case, pressed_cycle.factor, one_cycle=True
    )
    laws = {region: study(None).materials[region].loss_tangent.over_frequency for region in REGIONS}
    tyre = RollingTyre(study(None, **changes), None, schedule(single))
    reference = RevolutionLoss(StrainHarmonics(pressed_cycle.footprint), laws, tyre.speed(0.0), 25.0)
    density = reference.frequency * reference.one_cycle_density("nasa")
    for region in REGIONS:
        members = pressed_cycle.tyre.body.mesh.subdomains[region]
        x = pressed_cycle.tyre.body.rings.points[:, members].reshape(2, -1)
        heat = tyre.hysteresis[region](x, 0.0, np.full(x.shape[1], 25.0))
        assert heat == pytest.approx(density[members].ravel(), rel=1e-4)


def schedule(cycle: FiniteElements | None = None) -> CycleSchedule:
    """The drive with the strain cycle that was solved already."""
    strain_cycle = pressed() if cycle is None else cycle
    return CycleSchedule(study(None).card.drive, ((0.0,),), ((strain_cycle.solved_case,),), ((strain_cycle,),))


def test_a_report_style_law_of_one_cycle_takes_the_revolutions_frequency() -> None:
    """The arcs know one cycle per revolution: tan d at v / (2 pi r_r)."""
    changes = {"mechanics.strain": "arcs", "drive.duration": "60 s"}
    tyre, alike = RollingTyre(study(POWER, **changes)), RollingTyre(study(None, **changes))
    x, T = tyre.problem.points("II"), np.full(tyre.problem.points("II").shape[1], 60.0)
    f = tyre.speed(0.0) / (2 * np.pi * tyre.schedule.cases[0][0].rolling_radius)
    ratio = tyre.hysteresis["II"](x, 0.0, T) / alike.hysteresis["II"](x, 0.0, T)
    assert ratio == pytest.approx((f / 10.0) ** 0.25, rel=1e-9)
