"""Places by name: where they are, in every section and size, and sensors that stand there."""

from __future__ import annotations

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.diagnose.blind.other_model import OtherModel
from tyrefem.geometry import load
from tyrefem.geometry.named_places import named_place, named_places

pytestmark = pytest.mark.fast

SECTIONS = [
    *("nasa-22x5.5-8pr", "nasa-22x5.5-12pr", "passenger-205-55r16", "truck-295-80r22.5", "aircraft-radial-22x5.5"),
    *({"size": size} for size in ("155/70R13", "LT245/75R16", "11R22.5", "46x17R20", "H44.5x16.5-21")),
]


@pytest.mark.parametrize("reference", SECTIONS, ids=str)
def test_every_place_is_in_the_rubber_of_its_part(reference):
    section = load(reference)
    names = named_places(section)
    assert len(names) == (6 if any("belt" in region for region in section.regions) else 5)
    places = {name: named_place(section, name) for name in names}
    assert section.contains([section.place([s], [depth])[0] for s, depth in places.values()]).all()
    regions = {name: str(section.region_at(*place)) for name, place in places.items()}
    assert regions["bead-middle"] == "bead"
    # Under the tread is its inner face: just outside it is the tread.
    s, depth = places["under-tread"]
    assert str(section.region_at(s, depth + 1e-5)) == section.crown
    assert places["crown-inner"][1] == pytest.approx(1e-3)
    for name in ("shoulder-middle", "sidewall-middle"):
        s, depth = places[name]
        assert depth == pytest.approx(float(section.rubber_thickness([s])[0]) / 2)


def test_the_belt_edge_is_that_of_the_narrower_working_belt():
    """At its inner face, towards the wider belt: there the belts shear against each other."""
    section = load("truck-295-80r22.5")
    s, depth = named_place(section, "belt-edge")
    assert s == pytest.approx(89.975e-3, abs=1e-6)
    near = [str(section.region_at(s - 1e-6, depth + step)) for step in (-1e-5, 1e-5)]
    assert near == ["belt-2", "belt-3"]


def test_the_sidewall_is_where_the_line_is_widest():
    section = load("nasa-22x5.5-8pr")
    s, _ = named_place(section, "sidewall-middle")
    stations = np.linspace(section.line.shoulder_s, section.line.length, 2000)
    assert section.line.position(s)[1] == pytest.approx(section.line.position(stations)[:, 1].max(), abs=2e-5)


def test_the_crown_is_beside_a_groove_at_the_mid_plane():
    study = tf.study("nasa-22x5.5-8pr").replace(
        {"section.grooves": {"at": ["0 mm", "30 mm"], "width": "8 mm", "source": "estimate"}}
    )
    s, _ = named_place(study.section, "under-tread")
    assert s == pytest.approx((4e-3 + 26e-3) / 2)


@pytest.fixture(scope="module")
def sized() -> tf.Study:
    return tf.study("passenger-205-55r16").replace(
        {
            "section": {"size": "205/55R16"},
            "sensors": {
                "edge": {"place": "belt-edge"},
                "surface": {"place": "belt-edge", "below_surface": "2 mm"},
                "wall": {"place": "sidewall-middle", "depth": "1 mm"},
            },
        }
    )


def test_sensors_follow_the_size(sized):
    """The same study in another size has them at its own places; a depth is taken from the surface there."""
    other = sized.replace({"section": {"size": "225/45R17"}, "materials": {}})
    for study in (sized, other):
        edge, surface, wall = study.section.locate(np.array(list(study.stated_places.values())))[0]
        assert edge == surface == pytest.approx(named_place(study.section, "belt-edge")[0], abs=1e-6)
        assert wall == pytest.approx(named_place(study.section, "sidewall-middle")[0], abs=1e-6)
        thickness = float(study.section.rubber_thickness([edge])[0])
        _, depths = study.section.locate(np.array(list(study.stated_places.values())))
        assert depths[1:] == pytest.approx([thickness - 2e-3, 1e-3], abs=1e-6)
    assert other.stated_places["edge"][1] > sized.stated_places["edge"][1] + 5e-3


@pytest.mark.parametrize(
    ("place", "message"),
    [
        ({"place": "belt-egde"}, "sensors.x.place: 'belt-egde' is not allowed; did you mean 'belt-edge'"),
        ({"place": "shoulder-middle", "s": "3 mm"}, "or 'place', alone or with one of the depths"),
        ({"place": "shoulder-middle", "depth": "1 mm", "below_surface": "1 mm"}, "alone or with one of the depths"),
        ({"place": "shoulder-middle", "depth": "90 mm"}, "depth = 90.00 mm is outside the rubber"),
    ],
)
def test_a_wrong_place_is_named(sized, place, message):
    with pytest.raises(tf.InputError, match=message):
        sized.replace({"sensors.x": place})


def test_a_section_without_belts_has_no_belt_edge():
    with pytest.raises(tf.InputError, match=r"sensors\.x\.place: section 'nasa-22x5\.5-8pr' has no place 'belt-edge'"):
        tf.study("nasa-22x5.5-8pr").replace({"sensors.x": {"place": "belt-edge"}})


def test_another_kind_of_place_replaces_the_first(sized):
    assert sized.replace({"sensors.edge.depth": "3 mm"}).data["sensors"]["edge"] == {
        "place": "belt-edge",
        "depth": "3 mm",
    }
    moved = sized.replace({"sensors.wall.s": "120 mm"})
    assert moved.data["sensors"]["wall"] == {"s": "120 mm", "depth": "1 mm"}
    back = moved.replace({"sensors.wall.place": "sidewall-middle"})
    assert back.data["sensors"]["wall"] == {"place": "sidewall-middle"}


def test_blind_data_of_other_gauges_keep_station_and_depth(sized):
    """Gauges off by their tolerance: sensors at a place or below the surface stay where the study has them."""
    changed = OtherModel("", 1.0, (), {"sidewall": 1.1}, {}).changed(sized, {})
    for name in sized.sensors:
        s, depth = sized.section.locate(np.array([sized.stated_places[name]]))
        now_s, now_depth = changed.section.locate(np.array([changed.stated_places[name]]))
        assert (now_s[0], now_depth[0]) == pytest.approx((s[0], depth[0]), abs=2e-5)
