"""A factor on the heat that depends on place only is evaluated once per set of points, with the same heat."""

from __future__ import annotations

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.effects import catalogue
from tyrefem.effects.combined import Acting
from tyrefem.simulation.rolling_tyre import RollingTyre

SHAPE = catalogue()["heat-shape"]
#: Choices of effects that name no variants.
PLACES = {"missing-heat": {"station": "20 mm", "width": "9 mm"}, "heat-shape": {"half_waves": 1}}


@pytest.fixture(scope="module")
def tyre() -> RollingTyre:
    return RollingTyre(tf.study("nasa-22x5.5-8pr").replace({"mesh.size": "8 mm"}))


def points_of(tyre: RollingTyre) -> np.ndarray:
    """(2, 40) m: points from crown to bead in the middle of the wall."""
    section = tyre.study.section
    s = np.linspace(0.0, 0.95 * section.line.length, 40)
    return np.asarray(section.place(s, section.rubber_thickness(s) / 2)).T


def test_the_product_of_half_waves_is_that_of_each(tyre: RollingTyre) -> None:
    entries = [{"half_waves": n, "log_factor": x} for n, x in ((0, 0.2), (1, -0.4), (3, 0.1))]
    shapes = tuple(SHAPE.check(entry) for entry in entries)
    kept = Acting(tyre, shapes).source("any", lambda x, t, T: 2.0 + 0.1 * T)

    def each(x: np.ndarray, t: float, T: np.ndarray) -> np.ndarray:
        factors = [shape.heat_factor(tyre, "any", x, t, T) for shape in shapes]
        return np.asarray((2.0 + 0.1 * T) * np.prod(factors, axis=0))

    points = points_of(tyre)
    T = np.linspace(20.0, 90.0, points.shape[1])
    for t, temperatures in ((0.0, T), (10.0, T + 5.0)):
        np.testing.assert_allclose(kept(points, t, temperatures), each(points, t, temperatures), rtol=1e-13)
    moved = points * 0.999
    np.testing.assert_allclose(kept(moved, 0.0, T), each(moved, 0.0, T), rtol=1e-13)
    assert np.ptp(kept(points, 0.0, np.zeros_like(T))) > 0.1


def test_every_factor_of_place_is_the_same_at_all_times_and_temperatures(tyre: RollingTyre) -> None:
    points = points_of(tyre)
    cold, hot = (np.full(points.shape[1], value) for value in (10.0, 120.0))
    lasting = [effect for effect in catalogue().values() if effect.of_place]
    assert SHAPE in lasting
    for effect in lasting:
        entry = effect.check({"half_waves": 2, "log_factor": 0.3})
        first, last = (entry.heat_factor(tyre, "any", points, t, T) for t, T in ((0.0, cold), (500.0, hot)))
        np.testing.assert_array_equal(first, last)


def test_heat_said_to_be_without_temperature_is_the_same_cold_and_hot(tyre: RollingTyre) -> None:
    points = points_of(tyre)
    cold, hot = (np.full(points.shape[1], value) for value in (10.0, 120.0))
    zone, compared, t = tyre.schedule.zones[0].name, 0, 300.0
    for effect in catalogue().values():
        acts = effect.overrides("heat_addend") or effect.overrides("heat_factor")
        if not acts or effect.heat_of_temperature or effect.refusal(tyre.study):
            continue
        choice = next(iter(effect.variants(tyre.study)), {}) or PLACES.get(effect.name, {})
        sizes = {
            name: prior.scale if prior.unit == "1" else f"{prior.scale!r} {prior.unit}"
            for name, prior in ((each.name, each.prior) for each in effect.parameters())
        }
        acting = effect.check({**choice, **sizes})
        for port in ("heat_addend", "heat_factor"):
            first, last = (getattr(acting, port)(tyre, zone, points, t, T) for T in (cold, hot))
            np.testing.assert_array_equal(first, last)
        compared += 1
    assert compared >= 6
