"""Moduli at the strain amplitudes of regions under load."""

from __future__ import annotations

import pytest

from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData, study
from tyrefem.mechanics.footprint.press import press
from tyrefem.mechanics.footprint.pressed_tyre import inputs
from tyrefem.mechanics.footprint.secant_moduli import PASSES, secant_moduli
from tyrefem.mechanics.footprint.strain_amplitude import StrainAmplitude
from tyrefem.mechanics.footprint.strain_harmonics import StrainHarmonics
from tyrefem.mechanics.solved_cases import KnotSolver

SWEEP = {
    "small_strain_modulus": "2.0 MPa",
    "large_strain_modulus": "0.7 MPa",
    "greatest_loss_modulus": "0.17 MPa",
    "large_strain_loss_modulus": "0.05 MPa",
    "critical_strain": "2 %",
    "modulus_amplitude": "40 %",
    "source": "test",
}
REGIONS = ("tread", "sidewall")


@pytest.fixture(scope="module")
def tyre() -> StudyData:
    """The shipped NASA tyre, of which tread and sidewall depend on strain."""
    changes = {f"materials.{region}": {"base": f"nasa-{region}", "strain_dependence": SWEEP} for region in REGIONS}
    fem = {"mechanics.strain": "fem", "mechanics.motion": "linear", "mesh.size": "12 mm"}
    return study("nasa-22x5.5-8pr", {**changes, **fem})


def secant(tyre: StudyData) -> StudyData:
    return tyre.replace({"mechanics.moduli": "secant"})


def test_less_strain_means_a_stiffer_tyre(tyre: StudyData) -> None:
    for deflection in (0.005, 0.02):
        plain, by_strain = (press(each, deflection=deflection) for each in (tyre, secant(tyre)))
        assert plain.moduli is None
        assert by_strain.moduli is not None
        assert 1 < by_strain.moduli.passes <= PASSES
        factors = by_strain.moduli.factors
        assert set(factors) == set(REGIONS)
        # All amplitudes are below the 40 % at which the cards' moduli hold.
        assert all(0 < amplitude < 0.4 for amplitude in by_strain.moduli.amplitudes.values())
        assert by_strain.footprint.load > plain.footprint.load
    small, large = (press(secant(tyre), deflection=d).moduli for d in (0.005, 0.02))
    assert small is not None
    assert large is not None
    assert all(small.factors[region] > large.factors[region] for region in REGIONS)


def test_the_moduli_are_those_of_the_resulting_strain(tyre: StudyData) -> None:
    pressed = press(secant(tyre), deflection=0.015)
    assert pressed.moduli is not None
    laws = {region: tyre.materials[region].strain_dependence for region in REGIONS}
    strain = StrainAmplitude(StrainHarmonics(pressed.footprint), laws)
    for region, law in laws.items():
        assert law is not None
        assert pressed.moduli.factors[region] == pytest.approx(
            float(law.stiffening(strain.mean_amplitude(region))), rel=0.05
        )
        card, before = pressed.study.materials[region], tyre.materials[region]
        assert card.shear_modulus.value == pytest.approx(pressed.moduli.factors[region] * before.shear_modulus.value)
    assert pressed.summary()["secant_moduli"]["passes"] == pressed.moduli.passes


def test_run_and_press_have_the_same_tyre(tyre: StudyData) -> None:
    changed = secant(tyre)
    case, cycle = KnotSolver(changed).solve(0, 0.0)
    pressed = press(changed, load=case.load, drum_diameter=case.drum_diameter, pressure=case.pressure)
    assert case.deflection == pytest.approx(pressed.footprint.deflection, rel=5e-3)
    plain, _ = KnotSolver(tyre).solve(0, 0.0)
    assert case.deflection < plain.deflection
    assert inputs(changed) != inputs(tyre)
    assert cycle.density.min() >= 0


def test_cards_without_the_table_need_no_press() -> None:
    bare = study("nasa-22x5.5-8pr", {"mesh.size": "12 mm"})

    def never(_: StudyData) -> object:
        raise AssertionError("no press is needed")

    moduli = secant_moduli(bare, never)  # type: ignore[arg-type]
    assert (moduli.amplitudes, moduli.factors, moduli.passes) == ({}, {}, 0)
    assert bare.at_amplitudes({"tread": 0.01}).materials["tread"] is bare.materials["tread"]


def test_an_unknown_choice_is_an_error() -> None:
    with pytest.raises(InputError, match=r"moduli.*'payne' is not allowed.*card, secant"):
        study("nasa-22x5.5-8pr", {"mechanics.moduli": "payne"})


def test_a_tyre_that_may_turn_has_the_same_moduli_at_rest(tyre: StudyData) -> None:
    """With ``rolling`` a tyre at rest stands: its strain cycle is that of a study without."""
    start = {"drive.speed": {"from": "0 mph", "to": "20 mph"}}
    standing = secant(tyre).replace(start)
    turning = standing.replace({"mechanics.rolling": True})
    (first, energies), (second, others) = (
        (cycle.tyre.body.parts["tread"].compound, cycle.density)
        for cycle in (KnotSolver(each).solve(0, 0.0)[1] for each in (standing, turning))
    )
    assert first == second
    assert energies == pytest.approx(others, rel=1e-9)
