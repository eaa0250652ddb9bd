"""The hottest point of a transient keeps the maximum principle, where elements overshoot after a jump."""

from __future__ import annotations

import numpy as np
import pytest
import skfem

from tyrefem.conduction import Conduction, Film, Fixed, Flux, Material, Reservoir

pytestmark = pytest.mark.fast

LENGTH, CONDUCTIVITY, CAPACITY = 0.03, 0.25, 2e6


def slab(element: str, left: object = (), sources: dict | None = None, **more: object) -> Conduction:
    mesh = skfem.MeshQuad.init_tensor(np.linspace(0.0, LENGTH, 13), np.linspace(0.0, 0.01, 3))
    mesh = mesh.with_subdomains({"slab": lambda x: x[0] >= 0}).with_boundaries({"left": lambda x: x[0] < 1e-9})
    conditions = {"left": left} if left else {}
    regions = {"slab": Material(CONDUCTIVITY, CAPACITY)}
    return Conduction(mesh, regions, conditions, sources, axisymmetric=False, element=element, **more)


@pytest.mark.parametrize("element", ["P1", "P2"])
@pytest.mark.parametrize("left", [Film(2e4, 25.0), Fixed(25.0)])
def test_a_body_that_is_suddenly_cooled_is_never_hotter_than_it_was(element: str, left: object) -> None:
    run = slab(element, left).transient([0.0, 10.0], 120.0, tolerance=0.01)
    assert run.maximum.temperature <= 120.02
    assert run.region_maximum["slab"].temperature <= 120.02


@pytest.mark.parametrize("element", ["P1", "P2"])
def test_a_sink_that_jumps_down_between_phases_leaves_the_hottest_point_where_it_was(element: str) -> None:
    def sink(x: np.ndarray, t: float) -> float:
        return 25.0 + 95.0 * t / 300.0 if t < 300.0 else 25.0

    run = slab(element, Film(2e4, sink)).transient([0.0, 300.0, 400.0], 25.0, tolerance=0.01, breakpoints=[300.0])
    assert run.maximum.temperature == pytest.approx(120.0, abs=0.5)
    assert run.maximum.point[0] < 0.003
    assert abs(run.maximum.time - 300.0) < 1.0


def test_a_source_heats_an_insulated_body_without_limit() -> None:
    run = slab("P2", sources={"slab": lambda x, t, T: np.full(T.shape, 1e5 * t / 100)}).transient([0.0, 100.0], 25.0)
    assert run.maximum.temperature == pytest.approx(25.0 + 0.5 * 1e5 * 100.0 / CAPACITY, abs=0.02)


def test_a_flux_heats_a_surface_as_the_half_space_has_it() -> None:
    run = slab("P2", Flux(2e4)).transient([0.0, 60.0], 25.0)
    rise = 2 * 2e4 * np.sqrt(60.0 / (np.pi * CONDUCTIVITY * CAPACITY))
    assert run.maximum.temperature == pytest.approx(25.0 + rise, rel=0.01)


def test_a_flux_that_begins_within_a_phase_heats_as_well() -> None:
    run = slab("P2", Flux(lambda x, t: 2e3 * max(t - 20.0, 0.0))).transient([0.0, 60.0], 25.0)
    assert run.maximum.temperature == pytest.approx(run.values[-1].max(), abs=1e-9)


def test_a_hot_reservoir_heats_a_body_to_its_own_temperature_at_most() -> None:
    problem = slab("P2", Film(2e4, "bath"), reservoirs={"bath": Reservoir(1e5, initial=90.0)})
    run = problem.transient([0.0, 600.0], 20.0)
    assert 85.0 < run.maximum.temperature < 90.02
