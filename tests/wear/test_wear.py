"""Wear by ring: energy of a passing, the card's law, worn sections that load, refusals."""

from __future__ import annotations

import copy
from pathlib import Path

import numpy as np
import pytest
import tomli_w

import tyrefem as tf
from tyrefem import library
from tyrefem.errors import InputError
from tyrefem.geometry import load
from tyrefem.materials.card import MaterialCard
from tyrefem.materials.wear import Wear
from tyrefem.wear.ring_wear import RingWear
from tyrefem.wear.worn_section import LEFT, WornProfile, worn_section

TABLE = {"depth": "5 nm", "energy": "1 kJ/m**2", "source": "test"}
STUDY = "passenger-205-55r16"


def rings(power: float = 50.0, count: int = 41, exponent: float = 1.0) -> RingWear:
    """Rings of the shipped passenger's tread with one friction power each."""
    section = load(STUDY)
    s = np.linspace(-0.0775, 0.0775, count)
    places = section.place(s, section.total_thickness(s)).T
    table = Wear.check({**TABLE, "exponent": exponent})
    return RingWear(places, np.full(count, 0.155 / count), np.full(count, power / count), 70.0, 1.95, table)


@pytest.mark.fast
def test_all_friction_energy_is_shared_out() -> None:
    wear = rings()
    # Energy of one revolution, J, over the rings.
    assert float((wear.energy * wear.areas).sum()) == pytest.approx(50.0 * 2 * np.pi / 70.0, rel=1e-12)
    # Exponent 1: volume per km = 5e-12 m3/J times the energy of a kilometre.
    per_km = 50.0 * 2 * np.pi / 70.0 * 1e3 / 1.95
    assert wear.volume_per_km == pytest.approx(5e-12 * per_km, rel=1e-12)


@pytest.mark.fast
def test_exponent_and_slipping_backwards() -> None:
    once, twice = rings(50.0, exponent=2.0), rings(100.0, exponent=2.0)
    np.testing.assert_allclose(twice.depth_per_km / once.depth_per_km, 4.0, rtol=1e-12)
    assert Wear.check(TABLE).of([-1.0, 0.0]).tolist() == [0.0, 0.0]


@pytest.mark.fast
def test_a_worn_section_loads_and_is_thinner_by_the_wear(tmp_path: Path) -> None:
    study, wear = tf.study(STUDY), rings()
    new = study.section
    data = worn_section(study, wear, 10_000.0)
    (tmp_path / "worn.toml").write_text(tomli_w.dumps(data), encoding="utf-8")
    old = load(str(tmp_path / "worn.toml"))
    s = np.array([0.0, 0.03, 0.06])
    gone = new.total_thickness(s) - old.total_thickness(s)
    np.testing.assert_allclose(gone, WornProfile.of(new, wear)(s) * 10_000.0, rtol=1e-3)
    beyond = np.array([0.09, 0.12])
    np.testing.assert_allclose(old.total_thickness(beyond), new.total_thickness(beyond), atol=1e-6)
    changes = {"section": str(tmp_path / "worn.toml"), "sensors.shoulder-surface.depth": "13 mm", "mesh.size": "8 mm"}
    replaced = study.replace(changes)
    assert replaced.mesh().n_nodes > 100
    assert replaced.section.outer_diameter == pytest.approx(new.outer_diameter - 2 * gone[0], abs=2e-6)


@pytest.mark.fast
def test_a_tread_that_is_worn_through_is_refused() -> None:
    study, wear = tf.study(STUDY), rings()
    with pytest.raises(InputError, match=r"worn through .* km leave 0\.5 mm") as caught:
        worn_section(study, wear, 1e6)
    assert caught.value.field == "distance"
    most = float(caught.value.message.split(": ")[1].split(" km")[0].replace(",", ""))
    worn_section(study, wear, most - 1)
    assert LEFT == 0.5e-3


@pytest.mark.fast
@pytest.mark.parametrize(
    ("changes", "field"), [({"depth": "-5 nm"}, "wear.depth"), ({"exponent": 0}, "wear.exponent"), ({"law": 1}, "wear")]
)
def test_refused_numbers_of_a_card(changes: dict[str, object], field: str) -> None:
    data = copy.deepcopy(library.load("material", "rubber-tread-passenger")[0])
    with pytest.raises(InputError) as caught:
        MaterialCard.check({**data, "wear": {**TABLE, **changes}})
    assert caught.value.field == field
