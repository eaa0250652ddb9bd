"""Whatever stands in a file, it is either understood or refused with an `InputError`: nothing else is ever raised."""

from __future__ import annotations

import copy
import datetime
import tomllib
from contextlib import suppress

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import tyrefem as tf
from tyrefem import library
from tyrefem.geometry.builder import build
from tyrefem.geometry.card import SectionCard
from tyrefem.inputs.drive import Drive
from tyrefem.materials.card import MaterialCard

FEW = settings(deadline=None, max_examples=60, suppress_health_check=[HealthCheck.too_slow])
TEXTS = [
    *(
        "",
        " ",
        "x",
        "1",
        "m",
        "1 1",
        "0",
        "nan",
        "1 m",
        "-1 m",
        "0 m",
        "1e999 m",
        "nan m",
        "1e-300 m",
        "100 in",
        "3 in",
    ),
    *("25 degC", "-300 degC", "5 K", "1e9 degC", "0 psi", "1e9 psi", "20 mph", "-3 mph", "0 s", "1e300 s", "90 deg"),
    *("50 %", "200 %", "1 furlong", "1 m; import os", "10**10**10 m", "\x00", "/", "../..", "a/b.toml", "nasa-tread"),
    *("constant", "lumped", "held", "table", "gmsh", "full", "é", "__class__", "x" * 100),
]
OTHER = [
    *(0, 1, -1, 0.5, 1e308, float("nan"), float("inf"), 10**400, True, False, None),
    *([], [1], [[]], [None], ["1 m", "2 m"], [["25 degC", "0.2 W/m/K"], ["30 degC", "0.3 W/m/K"]], [{}]),
    *({}, {"law": []}, {"law": {}}, {"law": "lumped"}, {"base": 5}, {"base": "nasa-tread"}, {"from": "0 mph"}, {1: 2}),
    *({"unit": "in", "values": []}, {"unit": 5, "values": [1]}, datetime.date(2020, 1, 1), datetime.time(1, 2)),
]
KEYS = [
    "law",
    "at",
    "s",
    "load",
    "deflection",
    "phases",
    "base",
    "table",
    "name",
    "to",
    "value",
    "along",
    "mesh",
    "é",
    "",
]
WRONG = st.one_of(
    st.sampled_from(TEXTS + OTHER),
    st.text(max_size=12),
    st.builds("{} {}".format, st.floats(allow_nan=True), st.sampled_from(["m", "psi", "degC", "W/m/K", "mph", "s"])),
)


def places(data, path=()):
    """Every place in nested tables and lists, by its path."""
    items = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, value in items:
        yield (*path, key)
        yield from places(value, (*path, key))


@st.composite
def spoiled(draw, original):
    """The data of a card with one to three things in it replaced, removed or added."""
    data = copy.deepcopy(original)
    for _ in range(draw(st.integers(1, 3))):
        known = list(places(data))
        if not known:
            break
        *above, last = draw(st.sampled_from(known))
        parent = data
        for key in above:
            parent = parent[key]
        action = draw(st.sampled_from(["replace", "replace", "replace", "remove", "add"]))
        if action == "remove":
            del parent[last]
        elif action == "add" and isinstance(parent, dict):
            parent[draw(st.sampled_from(KEYS))] = copy.deepcopy(draw(WRONG))
        else:
            parent[last] = copy.deepcopy(draw(WRONG))
    return data


def understood_or_refused(read, data):
    with suppress(tf.InputError):
        read(data)


def shipped(kind, name):
    return tomllib.loads(library.find(kind, name).read_text(encoding="utf-8"))


RICH = shipped("study", "nasa-22x5.5-8pr") | {
    "section": {"base": "nasa-22x5.5-8pr", "parameters": {"crown_radius": "3.4 in"}},
    "drive": {
        "load": "2700 lbf",
        "pressure": "83 psi",
        "duration": "60 s",
        "speed": "20 mph",
        "phases": [
            {"name": "a", "speed": {"from": "0 mph", "to": "20 mph"}},
            {"deflection": "1 in", "ambient": "5 degC"},
        ],
    },
    "mesh": {"mesher": "mapped", "size": "3 mm", "cell": "tri", "element": "P1", "section": "half"},
    "mechanics": {"load_law": {"law": "vertical-stiffness", "stiffness": "400 N/mm", "source": "test"}},
    "boundaries": {
        "road": {"law": "cattani", "fraction": "0.1"},
        "outside_air": {"law": "table", "table": [["0 mph", "5 W/m**2/K"], ["50 mph", "40 W/m**2/K"]]},
        "contained_air": {"law": "held", "temperature": "20 degC"},
        "rim": {"law": "lumped", "mass": "9 kg", "cooling": "1 W/K"},
    },
    "measured": [{"table": "run.csv", "drive": {"speed": "20 mph"}, "noise": "1 K"}],
    "numerics": {"tolerance": "0.01 delta_degC"},
}
PLIES = shipped("material", "nasa-carcass") | {
    "conductivity": {
        "table": [["0 degC", "0.2 W/m/K", "0.3 W/m/K"], ["50 degC", "0.2 W/m/K", "0.3 W/m/K"]],
        "source": "x",
    },
    "loss_tangent": {"law": "table", "table": [["0 degC", "0.1"], ["50 degC", "0.05"]], "source": "x"},
}


def read_study(data):
    study = tf.Study("spoiled", data, None, library.shipped())
    assert study.uncertainty
    assert all(str(warning) for warning in study.warnings)


def test_the_unspoiled_are_understood():
    read_study(RICH)
    MaterialCard.check(PLIES)


@FEW
@given(spoiled(RICH))
def test_studies(data):
    understood_or_refused(read_study, data)


@FEW
@given(spoiled(shipped("study", "nasa-taxi-takeoff")["drive"]))
def test_drives(data):
    understood_or_refused(Drive.check, data)


@pytest.mark.parametrize("original", [PLIES, shipped("material", "nasa-tread")], ids=["table", "numbers"])
@FEW
@given(st.data())
def test_materials(original, data):
    spoiled_card = data.draw(spoiled(original))
    understood_or_refused(lambda card: MaterialCard.check(card).heat_capacity(), spoiled_card)
    understood_or_refused(lambda card: MaterialCard.check(card).warnings(), spoiled_card)


@FEW
@given(spoiled(shipped("section", "nasa-22x5.5-8pr")))
def test_sections(data):
    understood_or_refused(lambda card: build(SectionCard.check(card)).warnings, data)


@FEW
@given(st.sampled_from(list(places(RICH))), WRONG)
def test_changes_by_dotted_name(place, value):
    key = ".".join(str(part) for part in place)
    understood_or_refused(lambda changes: tf.study("nasa-22x5.5-8pr").replace(changes), {key: value})


@FEW
@given(st.text(max_size=30), WRONG)
def test_changes_by_any_text(key, value):
    understood_or_refused(lambda changes: tf.study("nasa-22x5.5-8pr").replace(changes), {key: value})


@pytest.mark.parametrize("made", [tf.study, lambda name, changes: tf.study(name).replace(changes)])
def test_an_unknown_strain_law_says_the_nearest(made):
    with pytest.raises(tf.InputError, match=r"mechanics\.strain: unknown strain law 'barel'; did you mean 'barrel'"):
        made("nasa-22x5.5-8pr", {"mechanics.strain": "barel"})
