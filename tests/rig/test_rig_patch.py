"""The axisymmetric patch: against a closed form, against itself by differences, against a curved patch in 3D."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from cases import TIMES
from curved_patch import CurvedPatch, TrueLayer, Truth
from scipy.special import erfc

from tyrefem.heating_test.clock import Clock, since_switch
from tyrefem.heating_test.grid import Fineness, PatchGrid, graded
from tyrefem.heating_test.parameters import at, parameters_of
from tyrefem.heating_test.readings import matched, view
from tyrefem.heating_test.twin import Twin
from tyrefem.measured import MeasuredRun
from tyrefem.rig import Patch, PatchLayer, Property, load, simulate

COARSE = Fineness(3, 6, 3)


def rubber(thickness: float) -> PatchLayer:
    return PatchLayer("rubber", thickness, 1150.0, Property(0.25), Property(1700.0))


def patch(thickness: float, radius: float, **changes: object) -> Patch:
    numbers = {"curvature": 0.0, "spot_radius": 5e-3, "profile": "uniform", "absorbed": 0.5, "ambient": 20.0}
    return Patch((rubber(thickness),), radius, **{**numbers, "length": 0.1, **changes})  # type: ignore[arg-type]


def test_centre_of_a_disc_on_a_half_space() -> None:
    """Carslaw & Jaeger 10.5: T = 2 q sqrt(a t)/k [1/sqrt(pi) - ierfc(R/(2 sqrt(a t)))] under an even disc."""
    heated = patch(0.05, 0.08, outer_film=0.0, inner_film=0.0, emissivity=0.0)
    grid = heated.grid(Fineness(5, 10, 30))
    times = np.array([0.0, 3.0, 10.0, 30.0, 100.0, 300.0])
    rise = heated.heated(grid, times, 0.01).values @ grid.at(0.0, 0.0).toarray()[0] - 20.0
    diffusivity, q = 0.25 / (1150 * 1700), 0.5 / (np.pi * 5e-3**2)
    x = 5e-3 / (2 * np.sqrt(diffusivity * times[1:]))
    ierfc = np.exp(-(x**2)) / np.sqrt(np.pi) - x * erfc(x)
    exact = 2 * q * np.sqrt(diffusivity * times[1:]) / 0.25 * (1 / np.sqrt(np.pi) - ierfc)
    assert rise[1:] == pytest.approx(exact, rel=4e-3)


@pytest.mark.parametrize("profile", ["uniform", "gaussian"])
@pytest.mark.parametrize("curvature", [0.0, 4.0])
def test_absorbed_heat_is_stored_or_lost(profile: str, curvature: float) -> None:
    heated = patch(0.012, 0.05, profile=profile, curvature=curvature)
    history = heated.heated(heated.grid(COARSE), np.array([0.0, 200.0]), 0.05)
    budget = history.budget
    stored = sum(float(v[-1]) for v in budget.stored.values())
    lost = budget.lost_by_condition
    beam = [
        float(v[-1])
        for (name, i), v in lost.items()
        if (name, i) == (("spot", 0) if profile == "uniform" else ("outer", 2))
    ]
    others = sum(float(v[-1]) for v in lost.values()) - beam[0]
    assert beam == pytest.approx([-0.5 * 200.0], rel=1e-9)
    assert stored + others == pytest.approx(100.0, rel=1e-6)
    assert others > 0.05 * stored


def test_shells_have_the_volume_of_a_sphere_s_cap() -> None:
    R, reach, thick = 0.2, 0.05, 0.015
    grid = PatchGrid.make(["a", "b"], [0.008, 0.007], reach, 1 / R, 5e-3, Fineness(8, 16, 4))
    cone = 2 * np.pi * (1 - np.cos(reach / R)) / 3
    assert grid.operators.weight.sum() == pytest.approx(cone * (R**3 - (R - thick) ** 3), rel=1e-3)
    assert grid.operators.surface("inner").area == pytest.approx(3 * cone * (R - thick) ** 2, rel=1e-3)


def test_points_are_where_they_should_be() -> None:
    """A field that is quadratic in (along, depth) is read exactly."""
    grid = patch(0.01, 0.04, curvature=3.0).grid(COARSE)
    s, d = np.array([0.0, 3.3e-3, 0.02, 0.04]), np.array([0.0, 1.1e-3, 9e-3, 0.01])
    nodes = np.arange(grid.operators.size)
    along = np.array([grid.at(x, y) @ nodes for x, y in zip(s, d, strict=True)])
    assert along.shape == (4, 1)
    number = grid._number
    lines = np.interp(np.arange(number.shape[0]) / 2, np.arange(grid.along.size), grid.along)
    deep = np.interp(np.arange(number.shape[1]) / 2, np.arange(grid.depths.size), grid.depths)
    values = np.empty(nodes.size)
    values[number] = 1 + 2e3 * lines[:, None] ** 2 - 30 * deep[None, :] + 1e4 * lines[:, None] * deep[None, :] ** 2
    assert grid.at(s, d) @ values == pytest.approx(1 + 2e3 * s**2 - 30 * d + 1e4 * s * d**2)


def test_a_camera_beside_the_mark_sees_the_spot_where_it_stands() -> None:
    """Spot and camera both 3 mm along: the camera sees the middle; the spot's distance is what counts otherwise."""
    card, _ = load("trtlab")
    grid = patch(0.015, 0.04).grid(COARSE)
    field = 100.0 - 1e5 * grid.operators.points[0] ** 2
    beside = card.sensors["outer"].model_copy(update={"aside": 3e-3, "window": 0.0})
    where = {"spot_along": 3e-3, "spot_across": 0.0}
    assert float((view("outer", beside, grid, where) @ field)[0]) == pytest.approx(100.0)
    where = {"spot_along": 0.0, "spot_across": 4e-3}
    assert float((view("outer", beside, grid, where) @ field)[0]) == pytest.approx(100.0 - 1e5 * 25e-6)
    wide = beside.model_copy(update={"aside": 0.0, "window": 4e-3})
    mean = float((view("outer", wide, grid, {"spot_along": 0.0, "spot_across": 1e-3}) @ field)[0])
    assert mean == pytest.approx(100.0 - 1e5 * (1e-6 + 2e-3**2 / 2))


def test_slopes_are_those_of_differences() -> None:
    """The tangent problem against central differences, with a conductivity that is linear in temperature."""
    card, _ = load("trtlab")
    card = card.model_copy(update={"phases": card.phases.model_copy(update={"heating": 120.0, "cooling": 40.0})})
    sensors = tuple(card.sensors)
    parameters = parameters_of(card, sensors)
    twin, clock, run = Twin(card, sensors, COARSE), Clock(card.phases, 220.0), card.runs["high"]
    x = np.where(["specific_heat_slope" in name for name in parameters.names], 0.0, 0.4)
    fields = twin.fields(parameters.values(x), run, clock)
    base = twin.readings_of_fields(parameters.values(x), clock, fields)
    slopes = twin.slopes(parameters, x, run, clock, fields, base)
    for name in ("tread.conductivity", "tread.specific_heat_slope", "outer_film"):
        i = parameters.names.index(name)
        up, down = (twin.readings(parameters.values(at(x, i, step)), run, clock) for step in (0.1, -0.1))
        expected = (up - down) / 0.2
        assert slopes[:, :, i] == pytest.approx(expected, abs=0.02 * np.abs(expected).max() + 1e-4), name


def test_times_of_a_table_are_met_to_a_hundredth_of_a_kelvin() -> None:
    """Splines in logarithmic time reproduce what a step in flux gives: sqrt(t) and decay."""
    card, _ = load("trtlab")
    clock = Clock(card.phases, card.phases.end)
    assert since_switch(1050.0)[-1] == pytest.approx(1050.0)
    t = clock.times - 60.0
    rise = 100.0 * np.sqrt(t / 1050) * (t <= 1050) + 100.0 * np.exp(-(t - 1050) / 100) * (t > 1050)
    wanted = np.array([0.0, 59.0, 75.0, 300.0, 1105.0, 1300.0, 1600.0])
    s = wanted - 60.0
    exact = np.where(s <= 1050, 100.0 * np.sqrt(np.maximum(s, 0) / 1050), 100.0 * np.exp(-(s - 1050) / 100))
    assert clock.matrix(wanted) @ rise == pytest.approx(exact, abs=0.01)
    assert clock.matrix(wanted).sum(axis=1) == pytest.approx(np.ones(7))


def test_a_clock_that_is_early_has_its_last_readings_computed() -> None:
    """A table until 200 s whose laser was switched on 12 s before: its last reading is that of 212 s, not of 200 s."""
    card, _ = load("trtlab")
    phases = card.phases.model_copy(update={"clock_sd": 5.0})
    times = np.arange(0.0, 201.0, 10.0)
    run = MeasuredRun("low", times, pd.DataFrame(dict.fromkeys(card.sensors, times)))
    test = matched(card.model_copy(update={"phases": phases}), run, list(card.sensors))
    since = test.series[0].at(-12.0) @ test.clock.times
    assert since[times > 60.0] == pytest.approx(times[times > 60.0] + 12.0, abs=0.05)
    assert test.clock.end == 200.0
    assert matched(card, run, list(card.sensors)).clock.times[-1] == pytest.approx(200.0)
    # Simulated, too: cooling goes on to the last reading.
    short = card.phases.model_copy(update={"heating": 30.0, "cooling": 30.0})
    early = {"low.clock": -25.0, "high.clock": 0.0}
    done = simulate(card.model_copy(update={"phases": short}), every=10.0, values=early, fineness=Fineness(2, 5, 2))
    last = done.runs["low"].temperatures["outer"].to_numpy()[-3:]
    assert (np.diff(last) < -0.1).all()


def test_a_warm_rim_is_reported_after_any_cooling() -> None:
    """A patch of 12 mm is far too small, also if its rim is cold again at the end of the test."""
    card, _ = load("trtlab")
    update = {"patch": card.patch.model_copy(update={"radius": 0.012}), "runs": {"high": card.runs["high"]}}
    for cooling in (0.0, 20_000.0):
        phases = card.phases.model_copy(update={"heating": 300.0, "cooling": cooling})
        small = card.model_copy(update={**update, "phases": phases})
        (words,) = simulate(small, every=100.0, fineness=Fineness(2, 5, 2)).words
        assert words.endswith("patch.radius should be larger.")


def test_a_layer_may_have_a_single_element() -> None:
    assert graded(7.0, 1, 1.0).tolist() == [0.0, 7.0]
    assert PatchGrid.make(["rubber"], [0.01], 0.05, 0.0, 5e-3, Fineness(1, 1, 1)).depths.tolist() == [0.0, 0.01]


def test_lag_of_a_ramp() -> None:
    """A first-order sensor follows a ramp one lag behind."""
    card, _ = load("trtlab")
    clock = Clock(card.phases, card.phases.end)
    ramp = clock.times - clock.times[0]
    late = ramp > 60.0
    assert clock.lagged(ramp, 5.0)[late] == pytest.approx(ramp[late] - 5.0, abs=1e-3)


def test_round_shells_stand_for_a_doubly_curved_crown() -> None:
    """A 3D torus patch of 300 mm and 180 mm radius: shells of the mean curvature are right, a flat patch is not."""
    card, _ = load("trtlab")
    layers = (TrueLayer(8e-3, 1150.0, 0.25, 1700.0), TrueLayer(7e-3, 1200.0, 0.3, 1500.0))
    radii = (0.30, 0.18)
    truth = CurvedPatch(Truth(layers, radii=radii, lines=(0.0, 2.5, 5.0, 8.0, 16.0)))
    times = TIMES[TIMES <= 1110.0]
    real = truth.clean(0.5, times)
    misses = []
    for curvature in (radii, (None, None)):
        crown = card.patch.model_copy(update={"circumferential_radius": curvature[0], "lateral_radius": curvature[1]})
        twin = Twin(card.model_copy(update={"patch": crown}), tuple(card.sensors))
        clock = Clock(card.phases, 1110.0)
        parameters = parameters_of(card, tuple(card.sensors))
        values = {**parameters.values(np.zeros(len(parameters))), "spot_across": 0.0}
        seen = clock.matrix(times) @ twin.readings(values, card.runs["low"], clock)
        misses.append(np.abs(seen[-1] - real[-1]))
    assert max(misses[0]) < 0.2
    assert misses[1][0] > 3 * misses[0][0]
    assert misses[1][0] > 0.4


@pytest.mark.parametrize("spot", [7.5e-3, 15e-3, 19e-3])
def test_nodes_that_are_even_but_for_rounding(spot: float) -> None:
    """Beyond the spot of a patch 2.35 times as wide."""
    edge = spot / 2
    length, first = float(f"{2.35 * edge * 1e3:.6g}") * 1e-3 - edge, 0.6 * edge / 4
    np.testing.assert_allclose(graded(length, 9, first), np.linspace(0.0, length, 10), rtol=1e-6)
