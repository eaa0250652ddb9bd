"""Estimates follow what the code does: nodes counted, time steps by the order of the method, bytes of what is kept."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

import tyrefem
from tyrefem import library
from tyrefem.conduction.operators import operators_of
from tyrefem.estimates import work as estimate
from tyrefem.estimates.work import duration
from tyrefem.geometry.meshing import build
from tyrefem.geometry.meshing.expected import expected_nodes
from tyrefem.simulation.estimate import RunEstimate

NASA = "nasa-22x5.5-8pr"
STUDIES = sorted(library.names("study"))


@pytest.mark.parametrize("name", STUDIES)
def test_no_shipped_study_is_long_or_large(name: str) -> None:
    study = tyrefem.study(name)
    expected = RunEstimate.of(study).total
    cases = len(study.campaign().cases) if study.is_campaign else 1
    # Footprints in large motion take a minute or two each, and a GiB or two.
    large = study.card.mechanics.strain == "fem"
    most_time, most_memory = (estimate.LONG, 2**31) if large else (estimate.LONG / 10, 2**29)
    assert 0.1 < expected.time * cases < most_time
    assert 2**24 < expected.memory < most_memory


@pytest.mark.parametrize("name", STUDIES)
def test_unknowns_are_those_of_the_mesh(name: str) -> None:
    study = tyrefem.study(name)
    unknowns = operators_of(study.mesh().mesh, study.card.mesh.element).size
    assert 1 <= RunEstimate.of(study).unknowns / unknowns < 1.1


@pytest.mark.parametrize("changes", [{"mesh.section": "full"}, {"mesh.through": 9}, {"mesh.size": "1.2 mm"}])
def test_nodes_of_other_meshes(changes: dict[str, str | int]) -> None:
    study = tyrefem.study(NASA, changes)
    mesh = study.card.mesh
    assert expected_nodes(study.section, mesh.size, through=mesh.through) == study.mesh().n_nodes


@pytest.mark.usefixtures("needs_gmsh")
@pytest.mark.parametrize(("name", "through"), [(NASA, 3), ("passenger-205-55r16", 1)])
def test_nodes_of_gmsh_are_known_to_a_third(name: str, through: int) -> None:
    section = tyrefem.study(name).section
    for size in (6e-3, 2e-3):
        made = build(section, size=size, mesher="gmsh", through=through).n_nodes
        assert 0.67 < expected_nodes(section, size, mesher="gmsh", through=through) / made < 1.5


def test_what_cannot_be_counted_is_estimated_without_counting() -> None:
    section = tyrefem.study(NASA).section
    assert expected_nodes(section, 1e-9) == pytest.approx(2 * section.area() / 1e-18)
    assert expected_nodes(section, 1e-300) == math.inf
    assert expected_nodes(section, 3e-3, through=10**9) > 1e18


def test_steps_grow_with_the_cube_root_of_the_tolerance() -> None:
    study = tyrefem.study(NASA, {"mesh.size": "12 mm"})
    made = []
    for tolerance in (1.0, 1e-3):
        result = study.replace({"numerics.tolerance": f"{tolerance} K"}).run()
        made.append(result.history.steps.accepted)
        assert 0.4 < estimate.steps(1, tolerance) / made[-1] < 2.5
    assert made[1] / made[0] == pytest.approx(10, rel=0.3)


def test_history_is_counted_with_its_copies() -> None:
    result = tyrefem.study(NASA, {"mesh.size": "12 mm", "output.every": "1 s"}).run()
    values = result.history.values
    assert estimate.history(values.shape[1], values.shape[0]) == 3 * values.nbytes
    expected = RunEstimate.of(result.study)
    assert len(result.times) <= expected.readings < 1.1 * len(result.times)


@given(st.floats(1e-3, 1.0), st.floats(1e-3, 1.0))
def test_what_would_fit_fits_and_little_less_does_not(low: float, least: float) -> None:
    size = estimate.smallest(lambda number: number >= least, low * least, 2.0)
    assert size is not None
    assert least <= size <= 1.15 * max(least, low * least)


def test_nothing_fits() -> None:
    assert estimate.smallest(lambda _: False, 1.0, 2.0) is None


@pytest.mark.parametrize("hottest", [25.0, 300.0, 2000.0])
def test_the_smallest_tolerance_is_some_hundred_roundings(hottest: float) -> None:
    least = estimate.smallest_tolerance(hottest)
    assert 200 < least / math.ulp(max(hottest, 100.0)) < 900


def test_large_motion_says_what_it_takes_and_what_the_quick_look_would() -> None:
    large = RunEstimate.of(tyrefem.study("passenger-205-55r16", {"mechanics.motion": "large"}))
    assert large.beginning.startswith(", first its strain cycles in large motion: about ")
    words = large.quick_look(lambda run: run.mechanics.time)
    linear = RunEstimate.of(tyrefem.study("passenger-205-55r16", {"mechanics.motion": "linear"}))
    assert words == f'; mechanics.motion = "linear" is the quick look: {duration(linear.mechanics.time)}'
    arcs = RunEstimate.of(tyrefem.study(NASA, {"mechanics.motion": "large"}))
    for run in (linear, arcs):
        assert (run.beginning, run.quick_look(lambda _: 1.0)) == ("", "")
    # Nothing is gained where temperatures take the time.
    assert large.quick_look(lambda run: run.mechanics.time + 1e6) == ""


def test_a_law_that_does_not_press_is_not_counted_as_large_motion() -> None:
    barrel, linear, large = (
        RunEstimate.of(tyrefem.study(NASA).replace({"mechanics.strain": law, "mechanics.motion": motion}))
        for law, motion in (("barrel", "large"), ("fem", "linear"), ("fem", "large"))
    )
    assert barrel.mechanics == linear.mechanics
    assert barrel.beginning == ""
    assert large.mechanics.time > 3 * barrel.mechanics.time
