"""A construction that cannot be built says where and why."""

from __future__ import annotations

import pytest

import tyrefem as tf

PASSENGER, BIAS = "passenger-205-55r16", "nasa-22x5.5-8pr"
CORDS = "materials.belt-1.cords"


@pytest.mark.parametrize(
    ("changes", "field", "words"),
    [
        ({f"{CORDS}.angle": "95 deg"}, f"{CORDS}.angle", "95 deg is out of range: 0 deg"),
        ({f"{CORDS}.angle": "-20 deg"}, f"{CORDS}.angle", "opposite angle"),
        ({f"{CORDS}.pairs": False}, f"{CORDS}.pairs", "between 0 and 90 deg.*opposite angle"),
        ({f"{CORDS}.ends": "2000 1/m"}, f"{CORDS}.ends", "do not fit side by side.*at most 1"),
        ({f"{CORDS}.angle_radius": None}, f"{CORDS}.angle_radius", "lift law needs the radius"),
        ({"materials.cap-ply.cords.lift": True}, "materials.cap-ply.cords.lift", "need lift = false"),
        ({f"{CORDS}.plies": 0}, f"{CORDS}.plies", "greater than or equal to 1"),
        ({f"{CORDS}.modulus": "-1 GPa"}, f"{CORDS}.modulus", "more than 0 Pa"),
        (
            {f"{CORDS}.diameter": "1.3 mm", f"{CORDS}.ends": "500 1/m"},
            f"{CORDS}.diameter", "1.3 mm do not fit into the layer, which leaves them 1.25 mm",
        ),
        (
            {"materials.bead.cords.ends": "12000 1/m", "materials.bead.cords.plies": 20},
            "materials.bead.cords.ends", "round cords can take 91% at most",
        ),
        ({f"{CORDS}.angle_radius": "30 mm"}, f"{CORDS}.angle_radius", "not on the tyre.*0.316 m"),
        (
            {f"{CORDS}.angle_radius": "290 mm", f"{CORDS}.angle": "10 deg"},
            f"{CORDS}.angle", "lift law has no angle at r = 0.304",
        ),
        (
            {"section.layers.2.regions.0.to": "110 mm"},
            "section.layers.2.regions", "'shoulder-cushion' never appears.*cannot overlap",
        ),
        (
            {"section.layers.2.regions.0.to": "240 mm"},
            "section.layers.2.regions.0.to", "beyond the section, whose meridian is 0.19",
        ),
        (
            {"section.layers.2.regions.0.to": "125 mm", "section.layers.2.regions.1.to": "135 mm"},
            "section.layers.2.regions", "belt 'belt-1' is wider than the section.*turns inwards 0.1",
        ),
        ({"section.layers.9.name": "x"}, "section.layers", "no entry '9'; allowed: belt-1 and apex"),
        (
            {"materials.tread.elasticity.bulk_modulus": "5 MPa"},
            "materials.tread.elasticity.bulk_modulus", "10 times the shear modulus",
        ),
        (
            {"materials.tread.elasticity": {"law": "yeoh", "c10": "1 MPa", "c20": "-1 MPa", "source": "x"}},
            "materials.tread.elasticity.c20", "loses its stiffness",
        ),
        (
            {"materials.tread.elasticity": {"law": "mooney-rivlin", "c10": "1 MPa", "c01": "-1 MPa", "source": "x"}},
            "materials.tread.elasticity.c10", "must be positive",
        ),
        ({"materials.tread.elasticity.law": "hooke"}, "materials.tread.elasticity.law", "law 'hooke'"),
    ],
)  # fmt: skip
def test_one_error_names_file_field_and_what_is_allowed(changes, field, words):
    study = tf.study(PASSENGER)
    with pytest.raises(tf.InputError, match=words) as caught:
        study.replace(changes)
    assert "study.toml" in str(caught.value.file)
    assert caught.value.field == field


ENERGY = "mechanics.energy"


@pytest.mark.parametrize(
    ("name", "changes", "field", "words"),
    [
        (PASSENGER, {f"{ENERGY}.regions.tread": "-3 kJ/m**3"}, f"{ENERGY}.regions.tread", "at least 0"),
        (PASSENGER, {f"{ENERGY}.regions.treat": "3 kJ/m**3"}, f"{ENERGY}.regions", "did you mean 'tread'"),
        (PASSENGER, {f"{ENERGY}.regions.tread": ["3 mm"]}, f"{ENERGY}.regions.tread", r"rows \[\['0 mm'"),
        (
            PASSENGER, {f"{ENERGY}.regions.tread": [["3 mm", "1 kJ/m**3"], ["1 mm", "1 kJ/m**3"]]},
            f"{ENERGY}.regions.tread", "must rise",
        ),
        (PASSENGER, {f"{ENERGY}.regions": {"tread": "1 kJ/m**3"}}, f"{ENERGY}.regions", "no strain energy for region"),
        (BIAS, {"mechanics.strain": "given"}, "mechanics.strain", r"needs the table \[mechanics.energy\]"),
        (PASSENGER, {"materials.carcass": "nasa-carcass"}, "materials", "unknown region 'carcass'.*liner"),
    ],
)  # fmt: skip
def test_a_bad_strain_energy_is_named(name, changes, field, words):
    study = tf.study(name)
    with pytest.raises(tf.InputError, match=words) as caught:
        study.replace(changes)
    assert caught.value.field == field
    assert "study.toml" in str(caught.value.file)


def test_the_arcs_refuse_a_radial():
    with pytest.raises(tf.InputError, match=r"'arcs' needs the region 'carcass'.*strain = .given."):
        tf.study(PASSENGER).replace({"mechanics.strain": "arcs"}).run()


@pytest.mark.parametrize("effect", ["belt-edge-shear", "cord-conduction"])
def test_effects_that_need_a_carcass_refuse_a_radial(effect):
    value = {"loss": "20 kJ/m**3"} if effect == "belt-edge-shear" else {"gain": "1"}
    with pytest.raises(tf.InputError, match="has no region 'carcass'"):
        tf.study(PASSENGER).replace({"effects": [{"name": effect, **value}]})


def test_a_belt_s_width_is_a_number_of_the_study():
    """``section.layers.2.regions.0.to`` moves the inner belt's edge, and the mesh follows."""
    study = tf.study(PASSENGER).replace({"section.layers.2.regions.0.to": "68 mm", "mesh.size": "8 mm"})
    assert study.section.layers[2].regions.ends[0] == pytest.approx(0.068)
    mesh = study.mesh()
    assert len(mesh.elements_between(0.0, 0.068, "belt-1")) == len(mesh.mesh.subdomains["belt-1"])
