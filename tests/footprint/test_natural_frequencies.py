"""Natural frequencies of a tyre from its size: beside the measured ones, over mesh and pressure, mass."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.errors import InputError
from tyrefem.materials.cord_layers import masses
from tyrefem.mechanics.footprint.natural_frequencies import NaturalFrequencies, natural_frequencies

STUDY = """
title = "205/60R15 on a 6 inch rim"
section = { size = "205/60R15", rim_width = "152 mm" }
[materials]
[drive]
speed = "60 km/h"
load = "4 kN"
pressure = "2.2 bar"
duration = "60 s"
ambient = "25 degC"
[mesh]
size = "10 mm"
through = 1
"""
#: Belt as a rigid ring, rim held, 2.2 bar, unloaded: MF-Swift data of a 205/60R15, Hz.
MEASURED = {"fore-aft and vertical": 76.63, "lateral": 41.47, "yaw and camber": 53.46, "wind-up": 67.73}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("modes")
    (place / "study.toml").write_text(STUDY)
    return place


@pytest.fixture(scope="module")
def modes(folder: Path) -> NaturalFrequencies:
    return natural_frequencies(tf.study(folder / "study.toml"), (0, 1), 2)


def test_the_measured_belt_in_a_wide_band(modes: NaturalFrequencies) -> None:
    """Nothing is fitted: the shipped cards leave every mode too low, wind-up the most, also at a small amplitude."""
    ratios = {name: modes.frequency(name) / measured for name, measured in MEASURED.items()}
    assert all(0.65 < ratio < 1.1 for ratio in ratios.values()), ratios
    # The order of the sidewall's stiffnesses is the measured one: lateral lowest, vertical highest.
    names = modes.table.sort_values("frequency_Hz").name.tolist()
    assert names[0] == "lateral"
    assert names[-1] == "fore-aft and vertical"
    assert modes.frequency("lateral") / modes.frequency("fore-aft and vertical") == pytest.approx(41.47 / 76.63, 0.1)


def test_mass_is_that_of_the_section(modes: NaturalFrequencies) -> None:
    """The card's densities times the volumes as built; inflation changes volumes, not the mass; 9.3 kg measured."""
    study = modes.study
    built = sum(masses(study.section, study.materials, study.card.drive.initial).values())
    assert modes.mass == pytest.approx(built, rel=2e-3)
    assert modes.mass == pytest.approx(9.3, rel=0.15)
    before = sum(
        study.materials[region].density.at(25.0) * modes.tyre.body.rings.weights[members].sum()
        for region, members in modes.tyre.body.mesh.subdomains.items()
        if region in modes.tyre.body.parts
    )
    assert modes.mass == pytest.approx(4 * np.pi * before, rel=1e-9)


def test_half_as_coarse_a_mesh_gives_the_same_frequencies(folder: Path, modes: NaturalFrequencies) -> None:
    fine = natural_frequencies(tf.study(folder / "study.toml", {"mesh.size": "5 mm"}), (0, 1), 2)
    assert fine.table.frequency_Hz.tolist() == pytest.approx(modes.table.frequency_Hz.tolist(), rel=5e-3)


def test_pressure_stiffens_the_belt(folder: Path, modes: NaturalFrequencies) -> None:
    soft = natural_frequencies(tf.study(folder / "study.toml"), (0, 1), 2, pressure=1.1e5)
    for name in MEASURED:
        ratio = modes.frequency(name) / soft.frequency(name)
        # A membrane without wall stiffness would have sqrt(2).
        assert 1.05 < ratio < np.sqrt(2)


@pytest.mark.parametrize(
    ("harmonics", "count", "field"),
    [((-1,), 2, "harmonics"), ((), 2, "harmonics"), (([1],), 2, "harmonics"), ((0,), 0, "count")],
)
def test_numbers_out_of_range(folder: Path, harmonics: tuple[int, ...], count: int, field: str) -> None:
    with pytest.raises(InputError) as caught:
        natural_frequencies(tf.study(folder / "study.toml"), harmonics, count)
    assert caught.value.field == field


def test_an_unknown_name_lists_the_names(modes: NaturalFrequencies) -> None:
    with pytest.raises(InputError, match=r"no mode is called 'rocking'; there are lateral"):
        modes.frequency("rocking")


SWEEP = {
    "small_strain_modulus": "2.0 MPa",
    "large_strain_modulus": "0.7 MPa",
    "greatest_loss_modulus": "0.17 MPa",
    "large_strain_loss_modulus": "0.05 MPa",
    "critical_strain": "2 %",
    "source": "test",
}


def test_small_vibrations_meet_the_modulus_of_their_amplitude() -> None:
    """At the amplitude of the card's modulus nothing changes; at a smaller one every mode is higher."""
    bare = tf.study("nasa-22x5.5-8pr", {"mesh.size": "12 mm"})
    study = bare.replace({"materials.sidewall": {"base": "nasa-sidewall", "strain_dependence": SWEEP}})
    as_given = natural_frequencies(bare, (0, 1), 2).table.frequency_Hz.to_numpy()
    same = natural_frequencies(study, (0, 1), 2, amplitude=0.1)
    assert same.table.frequency_Hz.to_numpy() == pytest.approx(as_given, rel=1e-9)
    small = natural_frequencies(study, (0, 1), 2)
    factor = small.stiffening["sidewall"]
    assert small.amplitude == 1e-3
    assert factor == pytest.approx(float(study.materials["sidewall"].strain_dependence.stiffening(1e-3)))
    ratios = small.table.frequency_Hz.to_numpy() / as_given
    assert (ratios > 1).all()
    assert ratios.max() > 1.02
    assert (ratios < np.sqrt(factor)).all()
    # The inflated tyre is the same: only the stiffness of small motions changes.
    assert small.tyre.radius_growth == same.tyre.radius_growth
    assert small.summary()["modulus_over_that_of_the_card"]["sidewall"] == factor
    with pytest.raises(InputError, match="amplitude"):
        natural_frequencies(study, (0,), 1, amplitude=0.0)


def test_half_and_full_section_name_their_motions_alike() -> None:
    """The belt's two edges move against each other at 312 Hz: the full section called it breathing."""
    half, full = (
        natural_frequencies(tf.study("nasa-22x5.5-8pr", {"mesh.size": "14 mm", "mesh.section": section}), (0, 1), 4)
        for section in ("half", "full")
    )
    assert "belt torsion" in half.table.name.tolist()
    assert full.table.name.tolist() == half.table.name.tolist()
    np.testing.assert_allclose(full.table.frequency_Hz, half.table.frequency_Hz, rtol=1e-6)
