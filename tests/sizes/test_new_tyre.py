"""`tyrefem new tyre`: a study and its section in another size, without what was the first tyre's."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.api import Study
from tyrefem.cli import main
from tyrefem.geometry import SectionCard, TwoArcs, build
from tyrefem.inputs.other_size.arcs import scale_gauges
from tyrefem.inputs.other_size.places import along, same_depth
from tyrefem.inputs.other_size.points import _move_along
from tyrefem.library import load as load_card
from tyrefem.sizes import draw_size
from tyrefem.sizes.text import table_lines

pytestmark = pytest.mark.fast

#: Study to scale, size, and the folder of the new one.
SCALED = [
    ("passenger-205-55r16", "225/45R17", "passenger-225-45r17"),
    ("passenger-205-55r16", "155/70R13 75T", "passenger-155-70r13-75t"),
    ("passenger-205-55r16", "315/35R20", "passenger-315-35r20"),
    ("truck-295-80r22.5", "11R22.5", "truck-11r22.5"),
    ("truck-295-80r22.5", "385/65R22.5", "truck-385-65r22.5"),
    ("aircraft-radial", "46x17R20", "aircraft-radial-46x17r20"),
    ("nasa-22x5.5-8pr", "24x7.7 16PR", "aircraft-bias-24x7.7-16pr"),
    ("nasa-22x5.5-8pr", "18x5.5 8PR", "aircraft-bias-18x5.5-8pr"),
    ("nasa-22x5.5-12pr", "40x14", "aircraft-bias-40x14"),
    ("measured-205-60r15", "195/65R15", "passenger-195-65r15"),
]


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def made(source: str, size: str, name: str) -> Study:
    assert main(["new", "tyre", size, "--from", source]) == 0
    return tf.study(f"studies/{name}")


def layer_and_share(section: tf.Section, s: float, depth: float) -> tuple[int, float]:
    faces = section.interfaces(np.array(s))
    y = faces[0] + depth
    layer = min(int(np.searchsorted(faces, y, side="right")) - 1, len(faces) - 2)
    return layer, float((y - faces[layer]) / (faces[layer + 1] - faces[layer]))


@pytest.mark.parametrize(("source", "size", "name"), SCALED)
def test_the_new_study_reads_without_edits(source: str, size: str, name: str, here: Path) -> None:
    """Its section has the size's width ratio, its loads keep their share of the rating, its warnings are none."""
    first, new = tf.study(source), made(source, size, name)
    assert new.warnings == ()
    drawn, rated, before = draw_size(size), new.section.rating, first.section.rating
    assert rated is not None
    assert before is not None
    assert rated.load == pytest.approx(drawn.rules["rated_load"].value, rel=1e-4)
    phase, earlier = new.card.drive.phases[0], first.card.drive.phases[0]
    assert phase.load.start / rated.load == pytest.approx(earlier.load.start / before.load, rel=1e-3)
    assert phase.pressure.start / rated.pressure == pytest.approx(earlier.pressure.start / before.pressure, rel=1e-3)
    assert phase.speed == earlier.speed
    assert new.section.regions == first.section.regions
    assert not new.measured
    assert new.card.of_one_tyre in ((), ("mechanics.load_law", "mechanics.footprint"))
    # Sensors are in the same regions.
    for sensor in first.sensors:
        places = [study.section.locate([study.stated_places[sensor]]) for study in (first, new)]
        regions = [study.section.region_at(*place)[0] for study, place in zip((first, new), places, strict=True)]
        assert regions[0] == regions[1], sensor


def test_a_radial_is_the_size_by_its_rules(here: Path) -> None:
    """The shipped passenger has no number given: in another size it is that size, drawn by the rules."""
    new = made("passenger-205-55r16", "225/45R17", "passenger-225-45r17")
    drawn = draw_size("225/45R17")
    assert new.data["materials"] == drawn.materials
    assert new.section.outer_diameter == pytest.approx(drawn.rules["outer_diameter"].value)
    text = (here / "studies/passenger-225-45r17/study.toml").read_text()
    for words in ("# scaled: drive.load 4825 N -> 4760 N", "# dropped: mechanics.energy", "# dropped: published"):
        assert words in text
    for key in ("energy", "published", "made_for"):
        assert f"[{key}" not in text
        assert key not in new.data
    stiffness = 200e3 * np.sqrt(224.7 / 213.64 * 634.3 / 631.9)
    assert new.card.mechanics.load_law.stiffness == pytest.approx(stiffness, rel=1e-3)


def test_numbers_and_cards_of_the_first_study_come_along(here: Path) -> None:
    """A gauge given in place of the rule's, by the ratio of the rules; a rim no longer; another card as it is."""
    command = ["new", "section", "205/55R16", "--rim", "7 in", "--set", "tread_gauge=6 mm"]
    assert main([*command, "--set", "crown_radius=0.6 m", "--out", "geometry/mine.toml"]) == 0
    sun, road = {"name": "sun", "absorbed": "100 W/m**2"}, {"name": "hot-road", "warmer_by": "1 K", "runs": ["a"]}
    changes = {
        "sensors.shoulder-surface.below_surface": "0.3 mm",
        "section": {"base": "mine", "parameters": {"thickness_scale": {"sidewall": 1.1}}},
        "materials.tread": "rubber-tread-passenger-low-loss",
        "materials.belt-1.cords.modulus": "180 GPa",
        "effects": [sun, road],
    }
    study = tf.study("passenger-205-55r16").replace(changes)
    study.save("studies/mine/study.toml")
    new = made("mine", "225/45R17", "passenger-225-45r17")
    rules = draw_size("225/45R17", {"tread_gauge": "6 mm"}).rules
    assert new.section.thickness("tread", 0.0) == pytest.approx(rules["tread_gauge"].value, abs=1e-5)
    text = (here / "geometry/passenger-225-45r17.toml").read_text()
    ratio = draw_size("225/45R17").rules["crown_radius"].value / draw_size("205/55R16").rules["crown_radius"].value
    assert f"{600 * ratio:.6g} mm" in text
    assert draw_size("225/45R17").rules["rim_width"].text in text
    assert new.section.name == "passenger-225-45r17"
    assert new.data["section"]["parameters"] == {"thickness_scale": {"sidewall": 1.1}}
    assert new.data["materials"]["tread"] == "rubber-tread-passenger-low-loss"
    belt = new.materials["belt-1"].cords
    assert belt.modulus == pytest.approx(180e9)
    assert belt.angle_radius == pytest.approx(new.section.line.position(0.0)[0] + 1.175e-3, abs=2e-4)
    assert [effect["name"] for effect in new.data["effects"]] == ["sun"]
    words = (here / "studies/passenger-225-45r17/study.toml").read_text()
    assert "# dropped: numbers of the first size: rim_width" in words
    assert "# dropped: 1 effects of measured runs" in words


def test_measured_tables_are_dropped_and_uncertainties_kept(here: Path) -> None:
    """Names with dots stay whole; the study of a diagnosis becomes one without data."""
    first, new = tf.study("hidden-effect"), made("hidden-effect", "24x7.7 16PR", "aircraft-bias-24x7.7-16pr")
    assert len(first.measured) == 4
    assert new.measured == ()
    assert new.data["uncertainty"] == first.data["uncertainty"]
    assert "# dropped: 4 measured tables" in (here / "studies/aircraft-bias-24x7.7-16pr/study.toml").read_text()


def test_two_arcs_keep_their_form(here: Path) -> None:
    """Scaled to its first size nothing moves; to another, width and bead follow the size, gauges its plies."""
    first = tf.study("nasa-22x5.5-8pr").section
    same = made("nasa-22x5.5-8pr", "22x5.5 8PR", "aircraft-bias-22x5.5-8pr").section
    assert isinstance(same.line, TwoArcs)
    assert same.line.position(np.linspace(0, 0.147, 9)) == pytest.approx(
        first.line.position(np.linspace(0, 0.147, 9)), abs=1e-6
    )
    new = made("nasa-22x5.5-8pr", "32x8.8", "aircraft-bias-32x8.8").section
    before, after = draw_size("22x5.5 8PR").rules, draw_size("32x8.8").rules
    ratio = after["section_width"].value / before["section_width"].value
    assert new.overall_width == pytest.approx(ratio * first.overall_width, abs=3e-4)
    assert isinstance(new.line, TwoArcs)
    assert isinstance(first.line, TwoArcs)
    over_rim = first.line.bead[1] - before["rim_diameter"].value / 2
    assert new.line.bead[1] == pytest.approx(after["rim_diameter"].value / 2 + over_rim, abs=3e-4)
    assert new.thickness("carcass", [0.0])[0] == pytest.approx(2 * first.thickness("carcass", [0.0])[0])


def test_sensors_stay_in_their_layer_at_their_share(here: Path) -> None:
    first = tf.study("truck-295-80r22.5").section
    new = made("truck-295-80r22.5", "385/65R22.5", "truck-385-65r22.5").section
    for s, depth in ((0.0, 0.008), (0.097, 0.010), (0.2, 0.006), (0.29, 0.012)):
        assert layer_and_share(first, s, depth) == pytest.approx(
            layer_and_share(new, *same_depth(first, new, s, depth)), abs=1e-6
        )
    assert along(first, new, first.line.shoulder_s) == pytest.approx(new.line.shoulder_s)
    assert along(first, new, -first.line.length) == pytest.approx(-new.line.length)
    stations = [along(first, new, s) for s in np.linspace(0, first.line.length, 200)]
    assert (np.diff(stations) > 0).all()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["295/80R22.5", "--from", "passenger-205-55r16"], "kind truck, passenger-205-55r16 of kind passenger"),
        (["225/45R17", "--from", "nasa-22x5.5-8pr"], "kind passenger, nasa-22x5.5-8pr of kind aircraft-bias"),
        (["LT245/75R16"], "no shipped study is of kind light-truck"),
        (["225-45-17", "--from", "passenger-205-55r16"], "is no tyre size; did you mean '225/45R17'"),
        (["225/45R17", "--from", "pasenger-205-55r16"], "did you mean 'passenger-205-55r16'"),
        (["225/45R17", "--set", "tread_guage=7 mm"], "no number 'tread_guage'; did you mean 'tread_gauge'"),
        (["225/45R17", "--rim", "3 in"], "--rim: 3 in is too narrow"),
    ],
)
def test_what_does_not_fit_is_one_error_and_nothing_is_written(
    words: list[str], message: str, here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["new", "tyre", *words]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert len(error.strip().splitlines()) == 1
    assert list(here.iterdir()) == []


def test_files_of_the_user_are_not_replaced(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new", "tyre", "225/45R17"]) == 0
    assert "then: tyrefem run studies/passenger-225-45r17" in capsys.readouterr().out
    edited = here / "geometry/passenger-225-45r17.toml"
    edited.write_text("# mine\n")
    assert main(["new", "tyre", "225/45R17"]) == 2
    assert "exists already; nothing was written" in capsys.readouterr().err
    assert edited.read_text() == "# mine\n"
    assert main(["new", "tyre", "225/45R17", "--force", "--set", "tread_gauge=7 mm"]) == 0
    assert tf.study("studies/passenger-225-45r17").section.thickness("tread", 0.0) == pytest.approx(7e-3, abs=1e-5)
    assert main(["new", "tyre", "225/45R17", "--out", "elsewhere"]) == 0
    assert tf.study("elsewhere/studies/passenger-225-45r17").section.name == "passenger-225-45r17"


@pytest.mark.parametrize("kind", ["section", "tyre"])
def test_a_line_break_in_an_option_leaves_a_file_that_can_be_read(kind: str, here: Path) -> None:
    assert main(["new", kind, "205/60R15\n", "--set", "crown_radius=700 mm\n"]) == 0
    file = next((here / "geometry").iterdir())
    assert tf.geometry.load(str(file)).outer_diameter == pytest.approx(0.627, abs=1e-3)


def test_what_no_rule_has_is_in_the_file_of_a_section(here: Path) -> None:
    words = ["--set", "inner_volume=30 l", "--set", "thickness_scale={sidewall=1.2}"]
    assert main(["new", "section", "205/60R15", "--out", "mine.toml", *words]) == 0
    mine, plain = tf.geometry.load(str(here / "mine.toml")), tf.geometry.load("205/60R15")
    assert mine.inner_volume == pytest.approx(0.03)
    assert mine.overall_width > plain.overall_width


def test_the_answer_as_json(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new", "tyre", "195/65R15", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert (here / answer["file"]).is_file()
    assert tf.study(answer["study"]).section.name == "passenger-195-65r15"
    assert any(note.startswith("dropped: mechanics.energy") for note in answer["notes"])


def test_a_scaled_bias_tyre_runs_and_carries_like_the_first(here: Path) -> None:
    """At the same share of its rating it deflects by a like share of its height."""
    quick = {"mesh.size": "8 mm", "mesh.element": "P1", "drive.duration": "60 s"}
    shares = []
    for study in (tf.study("nasa-22x5.5-8pr"), made("nasa-22x5.5-8pr", "24x7.7 16PR", "aircraft-bias-24x7.7-16pr")):
        result = study.replace(quick).run()
        section = study.section
        shares.append(result.phases[0].deflection / (section.outer_diameter / 2 - section.line.bead[1]))
        assert result.heat_budget.imbalance < 1e-9
    assert shares[1] == pytest.approx(shares[0], rel=0.25)


@pytest.fixture
def hand_drawn(here: Path) -> Study:
    """The passenger tyre with a section that is drawn by hand on points."""
    root = Path(__file__).resolve().parents[2]
    (here / "geometry").mkdir()
    text = (root / "tests/section/hand-drawn-radial.toml").read_text(encoding="utf-8")
    (here / "geometry/hand.toml").write_text(text, encoding="utf-8")
    text = (root / "studies/passenger-205-55r16/study.toml").read_text(encoding="utf-8")
    (here / "studies/hand").mkdir(parents=True)
    text = re.sub(r"^section = .*$", 'section = "hand"', text, flags=re.MULTILINE)
    (here / "studies/hand/study.toml").write_text(text, encoding="utf-8")
    return tf.study("studies/hand")


@pytest.mark.parametrize("size", ["225/45R17", "195/65R15", "155/70R13", "205/55R16"])
def test_a_section_drawn_by_hand_is_stretched_to_the_size(size: str, hand_drawn: Study) -> None:
    new = made("studies/hand", size, f"passenger-{size.lower().replace('/', '-')}")
    old, section, before, after = hand_drawn.section, new.section, draw_size("205/55R16").rules, draw_size(size).rules
    ratio = {name: after[name].value / before[name].value for name in ("section_width", "outer_diameter", "rim_width")}
    assert new.warnings == ()
    assert section.overall_width == pytest.approx(ratio["section_width"] * old.overall_width, abs=3e-4)
    assert section.outer_diameter == pytest.approx(ratio["outer_diameter"] * old.outer_diameter, abs=1e-4)
    heels = [part.line.position(np.array([part.line.length]))[0] for part in (old, section)]
    rims = (after["rim_diameter"].value - before["rim_diameter"].value) / 2
    assert heels[1][0] - heels[0][0] == pytest.approx(rims, abs=3e-4), "the bead keeps its height on the rim"
    assert heels[1][1] / heels[0][1] == pytest.approx(ratio["rim_width"], rel=0.01), "and lies as wide as the rim"
    assert section.line.shoulder_s / old.line.shoulder_s == pytest.approx(ratio["section_width"], rel=0.03)
    assert section.regions == old.regions
    # Gauges stay where no number of plies and no rule changes them.
    assert section.total_thickness(0.0) - old.total_thickness(0.0) == pytest.approx(
        after["tread_gauge"].value - before["tread_gauge"].value, abs=2e-4
    )
    if size == "205/55R16":
        assert section.volume("tread") == pytest.approx(old.volume("tread"), rel=1e-3)


@pytest.mark.usefixtures("hand_drawn")
def test_a_stretched_section_meshes() -> None:
    new = made("studies/hand", "225/45R17", "passenger-225-45r17")
    assert new.mesh().summary()["scaled_jacobian"] > 0.5


@pytest.mark.usefixtures("hand_drawn")
def test_a_section_whose_title_names_no_size_is_refused(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = here / "geometry/hand.toml"
    file.write_text(file.read_text(encoding="utf-8").replace("205/55R16 passenger", "A passenger"), encoding="utf-8")
    assert main(["new", "tyre", "225/45R17", "--from", "studies/hand"]) == 2
    assert "names no size to scale from" in capsys.readouterr().err


def test_texts_and_names_of_any_kind_are_read_back() -> None:
    """Sources of several lines, names that are no bare keys, and a title behind a table that was written inline."""
    data = {
        "section": {"base": "mine", "parameters": {"thickness_scale": {"Flanke-ä": 1.1, 'a "b"': 0.9}}},
        "title": "two\nlines, a\ttab, C:\\tyre and \x7f",
        "materials": {"Laufstreifen, außen": "nasa-tread"},
        "effects": [{"name": "hot-road", "from": "a 'note'\n"}],
    }
    assert tomllib.loads("\n".join(table_lines(data))) == data


def test_factors_on_thickness_count_once_and_grooves_leave_the_gauge_of_the_tread() -> None:
    changes = {"base": "nasa-22x5.5-8pr", "parameters": {"thickness_scale": {"tread": "1.2"}}}
    data, _, _ = load_card("section", changes)
    # A groove over the table's row at 0.895 in.
    data["grooves"] = {"at": ["0.895 in"], "width": "8 mm", "source": "made up for a test"}
    first, other = draw_size("22x5.5 8PR"), draw_size("24x7.7 16PR")
    old = build(SectionCard.check(data)).layers[-1].thickness
    for after in (first, other):
        new = {**data, "layers": [dict(layer) for layer in data["layers"]]}
        scale_gauges(new, data, first, after)
        factor = after.rules["tread_gauge"].value / first.rules["tread_gauge"].value
        gauge = build(SectionCard.check(new)).layers[-1].thickness
        assert gauge.values[:4] == pytest.approx([factor * value for value in old.values[:4]], abs=1e-6)


def test_a_table_that_stretches_keeps_its_shares_of_the_meridian() -> None:
    """Its stations count as stretched to the line, not as written: here from 0 to 1 m on a line of 0.2 m."""
    data, _, _ = load_card("section", "nasa-22x5.5-8pr")
    rows = {"s": {"unit": "m", "values": [0.0, 0.1, 0.5, 1.0]}, "thickness": ["5 mm"] * 4}
    data["layers"] = [{**data["layers"][0], **rows}]
    data["parameters"] = {**data["parameters"], "thickness_scale": {}}
    new = {**data, "parameters": {}, "layers": [dict(data["layers"][0])]}
    _move_along(new, SectionCard.check(data), np.array([0.0, 0.2]), np.array([0.0, 0.24]))
    assert new["layers"][0]["s"] == {"unit": "mm", "values": [0.0, 24.0, 120.0, 240.0]}
