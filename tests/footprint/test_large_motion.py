"""Large motion about the inflated state: the body's own forces, exact derivatives, balance far beyond the linear."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tyrefem.api import study
from tyrefem.errors import InputError
from tyrefem.geometry.meshing import build
from tyrefem.inputs.loading import TrR64
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.example_tyre import PlainTyre
from tyrefem.mechanics.footprint.footprint import Footprint
from tyrefem.mechanics.footprint.harmonic_balance import Balance
from tyrefem.mechanics.footprint.nonlinear import NonlinearForces
from tyrefem.mechanics.footprint.road import Road
from tyrefem.mechanics.solid.body_law import BodyLaw
from tyrefem.mechanics.solid.compounds import Compound
from tyrefem.mechanics.solid.inflation import Inflation, inflate

COARSE = 18e-3


@pytest.fixture(scope="module")
def bias() -> Inflation:
    """The 22x5.5 8PR, compressed cords and all."""
    tyre = study("nasa-22x5.5-8pr")
    return inflate(tyre, None, build(tyre.section, size=COARSE, through=1))


@pytest.fixture(scope="module")
def pressing(bias: Inflation) -> Pressing:
    return Pressing(bias.state)


@pytest.fixture(scope="module")
def pressed(pressing: Pressing) -> Footprint:
    """At its rated load."""
    return Balance(pressing, 16).at_load(12010.0)


def motion(pressing: Pressing, harmonics: int, size: float, seed: int) -> np.ndarray:
    """Random amplitudes that hold what is held."""
    u = size * np.random.default_rng(seed).normal(size=(harmonics + 1, pressing.harmonics.elements.n_dofs))
    u[:, pressing.harmonics.held] = 0.0
    u.reshape(harmonics + 1, -1, 3)[0, :, 2] = 0.0
    return u


@pytest.mark.parametrize("with_law", [True, False])
def test_the_product_is_the_derivative_of_the_forces(pressing: Pressing, with_law: bool) -> None:
    """Own compounds and cords, or Green's strain; with the following pressure and the rim's flange."""
    chosen = pressing if with_law else Pressing(replace(pressing.state, law=None))
    outside = NonlinearForces(chosen.harmonics, 5)
    u = 1.5 * chosen.at_deflection(0.02, 5).amplitudes
    v = motion(chosen, 5, 1e-6, 1)
    product = outside.at(u).product(v)
    h = 1e-2  # so small that few cords pass from tension to compression
    slope = (outside.forces(u + h * v) - outside.forces(u - h * v)) / (2 * h)
    free = chosen.harmonics.free
    assert np.abs(slope - product)[:, free].max() < 1e-5 * np.abs(product[:, free]).max()
    # The stiffness is symmetric in the work round the wheel, which counts n = 0 twice.
    w = motion(chosen, 5, 1e-6, 2)
    share = np.array([2.0, 1, 1, 1, 1, 1])[:, None]
    assert (share * w * product).sum() == pytest.approx((share * v * outside.at(u).product(w)).sum(), rel=1e-9)


def test_stress_and_tangent_by_vectors_are_those_of_the_tensors(bias: Inflation) -> None:
    """Yeoh's compound directly, and by the spatial tensors of any compound, which a vanishing c01 asks for."""
    law = bias.state.law
    assert isinstance(law, BodyLaw)

    def with_c01(c01: float) -> BodyLaw:
        parts = {
            name: replace(part, compound=Compound(5e5, c01, c20=-4e4, c30=2e4, bulk=5e7))
            for name, part in law.parts.items()
        }
        return replace(law, parts=parts)

    e, q = bias.body.rings.radii.shape
    gradient = 0.1 * np.random.default_rng(5).normal(size=(e, 9, q, 4))
    direct, general = (with_c01(c01).response(gradient) for c01 in (0.0, 1e-290))
    for name in ("stress", "tangent", "volume"):
        expected = getattr(general, name)
        assert getattr(direct, name) == pytest.approx(expected, abs=1e-11 * np.abs(expected).max())
    short = with_c01(0.0).response(gradient, np.float32)
    assert short.tangent.dtype == np.float32
    assert short.tangent == pytest.approx(direct.tangent, abs=1e-6 * np.abs(direct.tangent).max())


def test_without_motion_the_product_is_the_linear_stiffness(pressing: Pressing) -> None:
    rest = NonlinearForces(pressing.harmonics, 3).at(np.zeros((4, pressing.harmonics.elements.n_dofs)))
    assert np.abs(rest.forces).max() < 1e-9
    v = motion(pressing, 3, 1e-6, 3)
    linear = np.stack([pressing.harmonics.stiffness(n) @ part for n, part in enumerate(v)])
    free = pressing.harmonics.free
    # The dilatation is projected with the volumes before inflation, in the harmonics with those after it.
    assert np.abs(rest.product(v) - linear)[:, free].max() < 2e-3 * np.abs(linear[:, free]).max()


def test_a_motion_alike_all_round_has_the_forces_of_the_inflated_body(bias: Inflation, pressing: Pressing) -> None:
    """n = 0 in the large is `Body.residual`, to round-off; the flange acts as linearised there, so it is left out."""
    body = replace(bias.body, flanges=())
    state = replace(bias.state, support=None)
    u = motion(Pressing(state), 2, 2e-4, 4)
    u[1:] = 0.0
    forces = NonlinearForces(Pressing(state).harmonics, 2).forces(u).reshape(3, -1, 3)
    more = u[0].reshape(-1, 3)[:, :2].T
    exact = body.residual(bias.displacement + more, bias.pressure) - body.residual(bias.displacement, bias.pressure)
    free = np.zeros(2 * body.rings.n_nodes, dtype=bool)
    free[body.free] = True
    difference = (forces[0, :, :2].ravel() - exact)[free]
    assert np.abs(difference).max() < 1e-8 * np.abs(exact[free]).max()
    assert np.abs(forces[1:]).max() < 1e-9 * np.abs(forces[0]).max()


def test_the_8pr_deflects_under_its_rated_load_as_tr_r_64_says(pressing: Pressing, pressed: Footprint) -> None:
    """The linearised tyre is a quarter too stiff; in large motion deflection and slope are TR R-64's."""
    chosen = study("nasa-22x5.5-8pr")
    law, rating = TrR64(), chosen.section.rating
    assert rating is not None
    expected = law.deflection(12010.0, pressing.state.pressure, rating)
    assert pressed.load == pytest.approx(12010.0, rel=1e-3)
    assert pressed.deflection == pytest.approx(expected, rel=0.05)
    slope = 12010.0 * 0.01 / (law.deflection(12010.0 * 1.01, pressing.state.pressure, rating) - expected)
    assert pressed.stiffness == pytest.approx(slope, rel=0.15)
    assert pressing.at_load(12010.0, 16).deflection < 0.8 * expected


def test_contact_in_large_motion_neither_pulls_nor_penetrates(pressed: Footprint) -> None:
    largest = pressed.forces.max()
    assert (pressed.forces >= 0).all()
    assert pressed.gaps.min() > -3e-5  # of a deflection of 31 mm, balanced to 1e-3
    assert np.abs(pressed.gaps[pressed.forces > 1e-3 * largest]).max() < 3e-5
    assert pressed.pressure_integral == pytest.approx(pressed.load, rel=1e-9)


def test_stiffness_is_the_slope_between_two_deflections_and_far_less_than_linear() -> None:
    """A plain tyre of few elements, pressed by an eighth of its radius; the way there only rises."""
    tyre = Pressing(PlainTyre().state(along=8))
    balance = Balance(tyre, 10, 10, tolerance=1e-5)
    loads = [balance.at_deflection(d).load for d in (0.0396, 0.0404)]
    assert np.diff(balance.path, axis=0).min() > 0
    middle = balance.at_deflection(0.04)
    assert middle.stiffness == pytest.approx((loads[1] - loads[0]) / 0.0008, rel=0.03)
    assert middle.load < 0.8 * tyre.at_deflection(0.04, 10).load


def test_more_than_the_tyre_can_carry(pressing: Pressing) -> None:
    with pytest.raises(InputError, match=r"cannot carry 12010 N: the crown meets the rim at .* mm\)"):
        Balance(pressing, 8, before_rim=0.1).at_load(12010.0)


def test_a_deflection_beyond_what_large_motion_reaches_is_refused() -> None:
    """The last thousandth before the crown meets the rim; a small drum ends before that."""
    tyre = Pressing(PlainTyre().state(along=6))
    with pytest.raises(InputError, match=r"is too near 100\.99 mm, where the crown meets the rim") as caught:
        Balance(tyre, 8, 8).at_deflection(0.9995 * tyre.bottoming)
    assert caught.value.field == "deflection"
    drum = Pressing(tyre.state, Road(drum_diameter=0.15))
    with pytest.raises(InputError, match=r"cannot carry 1e\+05 N: the tyre meets the drum's axis at"):
        Balance(drum, 10, 10, before_rim=0.2).at_load(1e5)
