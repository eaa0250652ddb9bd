"""Reduced models over the shape of a section: one topology, interpolated operators, certificates, refusals."""

from __future__ import annotations

import numpy as np
import pytest

from tyrefem import study
from tyrefem.api import Study
from tyrefem.conduction.points import located
from tyrefem.geometry.meshing.topology import OtherTopologyError, Topology, common_counts
from tyrefem.reduced.model import NotReducibleError, ReducedModel
from tyrefem.reduced.packed_model import ReducedTask, pack, perform_reduced
from tyrefem.reduced.shaped_model import ShapedModel, fill, on_tyre, within
from tyrefem.reduced.shapes import counts_of, tyre_of, with_shapes
from tyrefem.reduced.surrogate import Surrogate, surrogate, temperature_error
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.variants.execution import SweepSettings
from tyrefem.variants.outcomes import Answered
from tyrefem.variants.plan import Plan, plan_of
from tyrefem.variants.samples import changes_at
from tyrefem.variants.task import perform

BOX = {
    "section.thickness_scale.tread": (0.8, 1.3),
    "section.crown_radius": ("3.4 in", "3.6 in"),
    "section.cord_angle": ("33 deg", "37 deg"),
    "materials.tread.loss_tangent.value": {"factor": [0.8, 1.2]},
}
#: A shape inside the box, at none of its corners.
SHAPE = {"section.thickness_scale.tread": 0.93, "section.crown_radius": "3.53 in", "section.cord_angle": "34 deg"}


@pytest.fixture(scope="module")
def tyre() -> Study:
    coarse = {"mesh.size": "10 mm", "drive.duration": "200 s", "output.every": "20 s"}
    plies = {"along": "0.4 W/m/K", "across": "0.25 W/m/K", "source": "a test of plies that conduct along themselves"}
    return study("nasa-22x5.5-8pr", {**coarse, "materials.carcass.conductivity": plies})


@pytest.fixture(scope="module")
def plan(tyre: Study) -> Plan:
    return plan_of(tyre, BOX, sample="sobol", count=48)


@pytest.fixture(scope="module")
def base(plan: Plan) -> RollingTyre:
    return tyre_of(plan.study, counts_of(plan))


@pytest.fixture(scope="module")
def model(plan: Plan, base: RollingTyre) -> ReducedModel:
    """Smooth modes, not of snapshots: what is interpolated are the operators."""
    r, z = base.problem.operators.points
    V = np.column_stack([np.ones(len(r)), r / 0.28, z / 0.07, (r / 0.28) * (z / 0.07), np.sin(60 * r), np.cos(50 * z)])
    samples = {zone.name: np.arange(0, len(base.problem.operators.dofs(zone.name)), 9) for zone in base.schedule.zones}
    nodes = sum(len(base.problem.operators.dofs(zone)) for zone in samples)
    rows = np.random.default_rng(1).random((nodes, sum(map(len, samples.values())))) / nodes
    even = ReducedModel(base, V, samples, rows, {region: base.problem.operators.dofs(region) for region in base.bodies})
    places = np.random.default_rng(2).random((24, len(plan.varied)))
    return with_shapes(even, [plan.study.replace(changes_at(plan.varied, place)) for place in places])


@pytest.fixture(scope="module")
def trained(plan: Plan) -> Surrogate:
    return surrogate(plan, tolerance=0.5)


def test_the_mesh_of_another_shape_has_its_areas_and_surfaces(base: RollingTyre, tyre: Study) -> None:
    other = RollingTyre(tyre.replace(SHAPE), base)
    section, mesh = other.study.section, other.mesh
    assert mesh.mesh.t is base.mesh.mesh.t
    for region in section.regions:
        assert mesh.area(region) == pytest.approx(section.area(region), rel=2e-2)
    # Every corner node lies on the section, and those of the road on its outer face.
    s, depth = section.locate(mesh.mesh.p.T)
    assert depth.min() > -1e-12
    road = np.unique(mesh.mesh.facets[:, mesh.mesh.boundaries["road"]])
    np.testing.assert_allclose(depth[road], section.rubber_thickness(s[road]), atol=1e-12)
    assert mesh.quality["scaled_jacobian"] > 0.5


def test_the_reference_shape_is_its_mesh(base: RollingTyre) -> None:
    assert base.topology is not None
    np.testing.assert_allclose(base.topology.points(base.study.section), base.mesh.mesh.p, atol=1e-15)


def test_a_whole_section_is_carried_over_on_both_sides(tyre: Study) -> None:
    whole = tyre.replace({"mesh.section": "full"})
    other = whole.replace(SHAPE).section
    topology = Topology(whole.section, 0.01, 3, common_counts(whole.section, [other], 0.01, 3))
    p = topology.points(other)
    mirrored = p * [[1.0], [-1.0]]
    assert set(map(tuple, p.T.round(12))) == set(map(tuple, mirrored.T.round(12) + 0.0))
    assert (topology.elements >= 0).all()


def test_operators_of_a_fresh_shape_are_those_assembled(model: ReducedModel, tyre: Study) -> None:
    """Interpolated operators and operators assembled on the shape's mesh and projected agree to 1e-5."""
    other = RollingTyre(tyre.replace(SHAPE), model.base)
    fast = on_tyre(model, other)
    assert isinstance(fast, ShapedModel)
    assert fast.coefficients is not None
    fill([fast])
    exact = ShapedModel(other, model.V, model.samples, model.nodes_from_samples, model.hot, reference=model)
    for region in model.base.bodies:
        for a, b in (
            (fast.mass[region], exact.mass[region]),
            (sum(fast.conduction[region]), sum(exact.conduction[region])),
            (fast.stored_row[region], exact.stored_row[region]),
        ):
            np.testing.assert_allclose(a, b, atol=1e-5 * np.abs(b).max())
    assert "carcass" in model.shapes.directed  # type: ignore[union-attr]
    np.testing.assert_allclose(
        fast.conduction["carcass"][1],
        exact.conduction["carcass"][1],
        atol=1e-5 * np.abs(exact.conduction["carcass"][1]).max(),
    )
    np.testing.assert_allclose(fast.load, exact.load, atol=1e-5 * np.abs(exact.load).max())
    np.testing.assert_allclose(fast.power, exact.power, atol=1e-5 * np.abs(exact.power).max())
    for side, (R, r, area) in exact.surfaces.items():
        np.testing.assert_allclose(fast.surfaces[side][0], R, atol=1e-6 * np.abs(R).max())
        np.testing.assert_allclose(fast.surfaces[side][1], r, atol=1e-6 * np.abs(r).max())
        assert fast.surfaces[side][2] == pytest.approx(area, rel=1e-6)


def test_an_even_temperature_conducts_nothing_in_any_shape(model: ReducedModel, tyre: Study) -> None:
    """Interpolated slopes of the even field are zero, whatever the error of the tensors: energy is conserved."""
    fast = on_tyre(model, RollingTyre(tyre.replace(SHAPE), model.base))
    fill([fast])
    for pair in fast.conduction.values():
        for K in pair:
            assert np.abs(K[0]).max() < 1e-10 * max(np.abs(K).max(), 1e-300)


def test_points_are_found_by_the_grid(model: ReducedModel, tyre: Study) -> None:
    other = RollingTyre(tyre.replace(SHAPE), model.base)
    fast, section = on_tyre(model, other), other.study.section
    rng = np.random.default_rng(3)
    s = rng.uniform(0.001, 0.99 * section.line.length, 60)
    points = section.place(s, section.rubber_thickness(s) * rng.uniform(0.1, 0.9, 60))
    expected = located(other.problem.operators, points).value() @ model.V
    np.testing.assert_allclose(fast.rows(points), expected, atol=1e-9)
    np.testing.assert_allclose(fast.points, other.problem.operators.points, atol=1e-14)


def test_newtons_method_inverts_bilinear_elements() -> None:
    rng = np.random.default_rng(4)
    corners = np.array([[0.0, 1.0, 1.2, -0.1], [0.0, 0.1, 1.0, 0.9]])[:, :, None] * np.ones(20)
    X = rng.random((2, 20))
    weights = np.array([(1 - X[0]) * (1 - X[1]), X[0] * (1 - X[1]), X[0] * X[1], (1 - X[0]) * X[1]])
    np.testing.assert_allclose(within(corners, np.einsum("cik,ik->ck", corners, weights)), X, atol=1e-12)


def test_fresh_shapes_are_met_within_the_tolerance(trained: Surrogate, plan: Plan) -> None:
    certificate = trained.certificate
    assert certificate.good
    assert certificate.own_mesh is not None
    assert certificate.error == max(certificate.worst, certificate.own_mesh)
    packed = pack(trained.model, plan.packed)
    outcomes = perform_reduced(ReducedTask(plan.variants[5:8]), packed)
    for number, outcome in enumerate(outcomes, 5):
        assert isinstance(outcome, Answered)
        full = perform(plan.task(number)).answers
        assert set(outcome.answers) == set(full)
        assert temperature_error(outcome.answers, full) < 0.5
        assert outcome.error is not None
        assert temperature_error(outcome.answers, full) <= certificate.error_of(outcome.error)
        for exact in ("mass_kg", "load_N", "deflection_m"):
            assert outcome.answers[exact] == pytest.approx(full[exact], rel=1e-12)
        assert outcome.answers["rolling_resistance_N"] == pytest.approx(full["rolling_resistance_N"], rel=5e-3)


def test_shapes_do_not_depend_on_their_company(trained: Surrogate, plan: Plan) -> None:
    studies = [plan.study.replace(plan.variants[number]) for number in (1, 2, 3)]
    together, alone = trained.answers(studies)[1].answers, trained.answers(studies[1:2])[0].answers
    assert temperature_error(together, alone) < 1e-2


def test_a_variant_of_a_shape_has_its_whole_result(trained: Surrogate, plan: Plan) -> None:
    from tyrefem.reduced.answers import reduced_outcomes
    from tyrefem.reduced.variant import Variant
    from tyrefem.variants.answers import answers

    ((_, variant),) = reduced_outcomes(trained.model, [plan.study.replace(plan.variants[4])])
    assert isinstance(variant, Variant)
    light, whole = answers(variant), answers(variant.result)
    for name, value in light.items():
        if name.endswith("_degC"):
            assert value == pytest.approx(whole[name], abs=1e-6)
    assert variant.result.heat_budget.imbalance < 1e-4


def test_meshes_that_differ_by_more_than_the_tolerance_are_full_runs(plan: Plan) -> None:
    """On a coarse mesh the common mesh and a variant's own differ: no reduced model hides that."""
    with pytest.raises(NotReducibleError, match=r"own meshes differ|validation runs"):
        surrogate(plan, tolerance=0.02, settings=SweepSettings(trials=1))


@pytest.mark.parametrize(
    ("changes", "vary", "reason"),
    [
        ({"mesh.cell": "tri"}, {"section.crown_radius": ("3.4 in", "3.6 in")}, "mapped"),
        ({}, {"section.bead_length": ("0.7 in", "0.9 in")}, "no common mesh: two of its marks"),
        ({}, {"section": ["nasa-22x5.5-8pr", "nasa-22x5.5-12pr"]}, "as a whole"),
    ],
)
def test_shapes_without_a_common_mesh_are_refused(
    tyre: Study, changes: dict[str, str], vary: dict[str, object], reason: str
) -> None:
    with pytest.raises(NotReducibleError, match=reason):
        surrogate(
            plan_of(
                tyre.replace(changes),
                vary,
                sample="grid" if "section" in vary else "sobol",
                count=None if "section" in vary else 16,
            )
        )


def test_a_shape_with_other_marks_has_no_mesh_of_the_topology(base: RollingTyre, tyre: Study) -> None:
    with pytest.raises(OtherTopologyError, match="marks"):
        _ = RollingTyre(tyre.replace({"section.rim_length": "0.7 in"}), base).mesh
