"""Input that is understood but does not act: it is refused or warned of, with what acts instead."""

from __future__ import annotations

import math

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.errors import InputError
from tyrefem.mechanics.rolling.critical_speed import CROWN, ring_speed
from tyrefem.sizes import draw_size

pytestmark = pytest.mark.fast

TYRE = "nasa-22x5.5-8pr"


def test_a_cards_crown_angle_beside_that_of_the_rating() -> None:
    assert not tf.study(TYRE).warnings
    (warning,) = tf.study(TYRE, {"materials.carcass.cord.crown_angle": "33 deg"}).warnings
    assert warning.field == "materials.carcass.cord.crown_angle"
    assert warning.message == "33 deg does not act: section.rating.cord_angle goes before it, 35 deg"
    # A card's own angle is of another section, and is meant to give way.
    assert not tf.study(TYRE, {"section.cord_angle": "33 deg"}).warnings


def test_a_sensor_on_the_side_that_a_half_section_leaves_out() -> None:
    study = tf.study(TYRE)
    r, z = study.stated_places["shoulder-inner"]
    at = f"{r * 1e3:.3f} mm", f"{z * 1e3:.3f} mm"
    assert tf.study(TYRE, {"sensors.shoulder-inner": {"at": list(at)}}).stated_places
    left = [at[0], f"-{at[1]}"]
    with pytest.raises(
        InputError, match=r"sensors\.shoulder-inner: .*z = -.* mm is on the side that a half section leaves"
    ):
        tf.study(TYRE, {"sensors.shoulder-inner": {"at": left}})
    both = tf.study(TYRE, {"mesh.section": "full", "sensors.shoulder-inner": {"at": left}})
    assert both.stated_places["shoulder-inner"][1] == pytest.approx(-z, abs=1e-5)


def test_the_voids_of_a_pattern_make_waves_on_the_ring_faster() -> None:
    """Speed goes with 1/sqrt(mass of the crown)."""
    plain = tf.study(TYRE)
    pattern = {"void": 0.2, "block_length": "20 mm", "source": "test"}
    cut = plain.replace({"section": {"base": TYRE, "pattern": pattern}})
    before, after = (ring_speed(study, 572e3) for study in (plain, cut))
    tread = {"materials.tread.density.value": f"{0.8 * plain.materials['tread'].density.at(25.0):.9g} kg/m**3"}
    lighter = ring_speed(plain.replace(tread), 572e3)
    assert after > 1.01 * before
    assert after == pytest.approx(lighter, rel=1e-6)
    assert math.isfinite(after)


def test_the_ring_is_the_middle_of_the_width() -> None:
    """Mass per area of all elements within `CROWN` of the section's width."""
    study = tf.study(TYRE)
    mesh = study.mesh().mesh
    corners, width = mesh.p[:, mesh.t], 2 * np.abs(mesh.p[1]).max()
    middle = np.abs(corners[1].mean(axis=0)) < CROWN * width / 2
    after = np.roll(corners, -1, axis=1)
    areas = np.abs((corners[0] * after[1] - corners[1] * after[0]).sum(axis=0)) / 2
    density = study.materials["tread"].density.at(25.0)  # as all its compounds
    mass = density * float(areas[middle].sum()) / float(np.ptp(corners[1][:, middle]))
    assert ring_speed(study, 572e3) == pytest.approx(math.sqrt(572e3 * mesh.p[0].max() / mass), rel=1e-9)


@pytest.mark.parametrize(
    "effect", [{"name": "pressure-loss", "rate": "2 kPa/min"}, {"name": "pressure-rise", "rise": 0.1}]
)
def test_the_deflection_of_a_leak_is_the_load_laws_beside_finite_elements(effect: dict[str, object]) -> None:
    assert not tf.study(TYRE, {"effects": [effect]}).warnings
    (warning,) = tf.study(TYRE, {"mechanics.strain": "fem", "effects": [effect]}).warnings
    assert warning.field == f"effects.{effect['name']}"
    assert "by mechanics.load_law 'tr-r-64', not by pressing the tyre" in warning.message
    assert warning.message.endswith("the strain law is 'fem'")
    with pytest.raises(InputError, match=r"'vertical-stiffness' does not depend on pressure; beside a strain law that"):
        tf.study("passenger-205-55r16", {"effects": [effect]})


def test_a_factor_that_acts_on_a_part_of_a_region_is_told_with_the_number_that_acts_on_all() -> None:
    """The body plies of a radial have half of the factor; tread and belts all of it."""
    plain = tf.study("passenger-205-55r16")
    scales = {f"section.thickness_scale.{region}": 1.1 for region in ("body-ply", "tread", "belt-1")}
    (warning,) = plain.replace(scales).warnings
    assert warning.field == "section.parameters.thickness_scale.body-ply"
    assert "changes the area of 'body-ply' by +5.2 %, not by +10 %" in warning.message
    assert "in its place" not in warning.message
    of_size = plain.replace({"section": "205/55R16 91V", "made_for": "205/55R16 91V", **scales})
    (warning,) = of_size.warnings
    assert warning.message.endswith("give the size's number parameters.ply_gauge in its place")
    gauge = draw_size("205/55R16 91V").rules["ply_gauge"].value
    thicker = plain.replace({"section": {"size": "205/55R16 91V", "parameters": {"ply_gauge": f"{1100 * gauge} mm"}}})
    assert thicker.section.area("body-ply") == pytest.approx(1.1 * plain.section.area("body-ply"), rel=0.002)
    assert not plain.replace({"section.thickness_scale.body-ply": 1.0}).warnings
