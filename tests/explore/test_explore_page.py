"""The page in a real browser: its numbers are Python's, its sliders, limits, pins and texts do what they say."""

from __future__ import annotations

import json
import re
import shlex
import tomllib
from html.parser import HTMLParser
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from page_browser import result_in_browser, within_frame

from tyrefem.api import Exploration, Study
from tyrefem.cli.common import settings
from tyrefem.compare.experiment import experiments
from tyrefem.inputs.changes import value_at
from tyrefem.realtime.default_box import default_box
from tyrefem.reports.explore_data import changes_of_file, limits_of
from tyrefem.reports.explore_settings import label_of
from tyrefem.variants.card import LimitCard

#: Settings at which page and Python are compared, and the largest difference that is allowed, K (and Pa, N, W).
SETTINGS, SAME = 20, 1e-6
#: Widths of a phone and of a small one, CSS pixels.
PHONE, SMALL_PHONE = 390, 320


def script(name: str) -> str:
    """What is done in the page."""
    return Path(__file__).with_name(f"{name}.js").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def numbers_of_the_page(page: str, explored: Exploration) -> tuple[Any, Any]:
    places = np.random.default_rng(5).random((SETTINGS, len(explored.plan.varied)))
    places[:4] = np.round(places[:4])
    chosen = [explored.numbers(place) for place in places]
    settings_text = json.dumps([numbers.tolist() for numbers in chosen])
    return chosen, result_in_browser(page, script("numbers").replace("SETTINGS", settings_text))


@pytest.mark.usefixtures("needs_chromium")
def test_numbers_in_the_page_equal_those_of_python(numbers_of_the_page: tuple[Any, Any], explored: Exploration) -> None:
    for numbers, shown in zip(*numbers_of_the_page, strict=True):
        solution = explored.solve(numbers)
        end = explored.study.card.drive.end
        for name, exact in (
            *((("early", name), value) for name, value in solution.at(0.03 * end).items()),
            *((("late", name), value) for name, value in solution.at(0.71 * end).items()),
            *((("answers", name), value) for name, value in solution.answers.items()),
        ):
            assert shown[name[0]][name[1]] == pytest.approx(exact, abs=SAME, rel=1e-9), name


@pytest.mark.usefixtures("needs_chromium")
def test_every_number_has_the_certificate_s_error_beside_it(page: str, explored: Exploration) -> None:
    """Bars with their sums, readings now and highest, tiles."""
    shown = result_in_browser(page, script("errors"))
    errors = explored.certificate.errors
    bars = {label: (value, error) for label, value, error in shown["bars"]}
    for label, name in (
        ("Generated", "generated"),
        ("Lost and stored", "lost and stored"),
        ("tread", "generated: tread"),
    ):
        value, error = bars[label]
        assert value.endswith(" W")
        assert float(error.removeprefix("± ")) == pytest.approx(errors[name], rel=0.5)
    assert [label for label, (value, error) in bars.items() if value and not error.startswith("± ")] == []
    assert len(shown["readings"]) >= 3
    assert [row for row in shown["readings"] if not all(float(cell) > 0 for cell in row[1:5])] == []
    assert all("±" in tile for tile in shown["tiles"])
    assert shown["tiles"][2].count("±") == 2  # rolling resistance and its coefficient
    # Two digits, as the command prints them: 0.13 K is not certified as 0.1.
    hottest, field = re.findall(r"± (\S+) K", shown["badge"])
    assert float(hottest) == pytest.approx(errors["hottest"], rel=0.05)
    assert float(field) == pytest.approx(explored.certificate.field, rel=0.05)
    certified = shown["certified"]
    assert certified["lost max"].endswith(" K")
    assert certified["lost: rim"].endswith(" W")
    assert certified["bead, its highest"].endswith(" K")


@pytest.mark.usefixtures("needs_chromium")
def test_the_picture_shows_the_field(numbers_of_the_page: tuple[Any, Any], explored: Exploration) -> None:
    """Its modes are integers of 16 bits: a few thousandths of a kelvin."""
    size, turn = explored.reduced.size, explored.arrays["turn"]
    for numbers, shown in zip(*numbers_of_the_page, strict=True):
        state = explored.solve(numbers).state(0.6 * explored.study.card.drive.end)
        field = explored.reduced.V @ turn[:size, :size] @ state[:size]
        np.testing.assert_allclose(shown["field"], field, atol=5e-3)


@pytest.fixture(scope="module")
def acted(page: str) -> Any:
    return result_in_browser(page, script("actions"))


@pytest.mark.usefixtures("needs_chromium")
def test_keys_move_sliders_and_the_new_setting_is_spoken(acted: Any) -> None:
    assert acted["key"]["moved"] == pytest.approx(0.2)
    assert acted["key"]["value"] == pytest.approx(20.2)
    assert acted["key"]["spoken"] == "20.2 mph"
    assert acted["key"]["field"] == "20.2"
    assert re.match(r"Hottest \d+\.\d degrees in the \w+; rolling resistance", acted["key"]["live"])
    assert acted["end"] == 30.0


@pytest.mark.usefixtures("needs_chromium")
def test_every_control_has_a_name(acted: Any) -> None:
    assert acted["unnamed"] == []
    assert "degrees Celsius" in acted["canvas"]
    assert acted["coloured"] > 50


@pytest.mark.usefixtures("needs_chromium")
def test_a_broken_limit_turns_red(acted: Any) -> None:
    assert acted["first"]["over"] == 0
    assert acted["hot"]["over"] >= 1
    assert acted["hot"]["rows"] == 1
    assert acted["hot"]["badge"] == "badge"


@pytest.mark.usefixtures("needs_chromium")
def test_a_temperature_below_zero_can_be_typed(acted: Any) -> None:
    """A speed below zero, after 31.5 mph, cannot."""
    assert acted["frost"] == [-5.0, 0.0, 31.5]


@pytest.mark.usefixtures("needs_chromium")
def test_numbers_of_another_setting_fade(acted: Any) -> None:
    assert acted["unsolved"]["badge"].startswith("No solution at this setting")
    assert acted["unsolved"]["faded"] < 0.5
    assert acted["unsolved"]["sliders"] == acted["solved"] == 1.0


@pytest.mark.usefixtures("needs_chromium")
def test_a_setting_without_a_solution_is_copied_as_it_is_and_not_pinned(acted: Any) -> None:
    """Its numbers would stand beside the temperatures of another setting; the badge says so in another light too."""
    assert "'drive.speed=1000000000 mph'" in acted["unsolved"]["command"]
    assert acted["unsolved"]["pins"] == [True, True]
    assert acted["pinsAgain"] == [False, False]
    assert acted["unsolved"]["later"] == acted["unsolved"]["badge"]


@pytest.mark.usefixtures("needs_chromium")
def test_a_finger_moves_the_time_in_the_chart(acted: Any) -> None:
    """Without this, a browser takes the movement for its own after a few pixels."""
    assert acted["touch"] == "pan-y"


@pytest.mark.usefixtures("needs_chromium")
def test_a_long_name_leaves_room_for_the_section(page: str) -> None:
    long = page.replace("lost-max", "a thermocouple in the shoulder " * 4)
    size = "[window.explore.section.scale, document.getElementById('section').clientHeight]"
    scale, height = result_in_browser(long, f"await wait(200); return {size};")
    assert scale > 0
    assert height > 100


@pytest.mark.usefixtures("needs_chromium")
def test_a_setting_outside_the_box_is_marked(acted: Any) -> None:
    outside = acted["outside"]
    assert outside["number"] == 31.5
    assert outside["kind"] == "badge outside"
    assert "Outside the certified box (speed)" in outside["badge"]
    assert "outside" in outside["row"]
    assert outside["note"] == "outside 10 to 30 mph: not certified"
    assert outside["spoken"].endswith("outside the certified box")
    assert "?" in outside["error"]
    assert acted["first"]["badge"].startswith("certified")


@pytest.mark.usefixtures("needs_chromium")
def test_copied_flags_and_tables_make_the_setting(acted: Any, explored: Exploration) -> None:
    """Both texts change the study's file to what the page has; no slider moved: only what --set had changed."""
    study = Study.load(explored.study.file)
    first = shlex.split(acted["first"]["command"].replace("\\\n", " "))
    assert first == ["tyrefem", "run", str(study.file), "--set", "mesh.size=14 mm"]
    words = shlex.split(acted["copied"]["command"].replace("\\\n", " "))
    assert words[:3] == ["tyrefem", "run", str(study.file)]
    assert set(words[3::2]) == {"--set"}
    by_flags = study.replace(settings(words[4::2]))
    assert by_flags.card.mesh.size == explored.study.card.mesh.size
    tables = tomllib.loads(acted["copied"]["toml"])
    by_tables = study.replace({f"{table}": content for table, content in tables.items()})
    for number, value, typed in zip(explored.plan.varied, acted["copied"]["numbers"], acted["written"], strict=True):
        for changed in (by_flags, by_tables):
            assert value_at(changed.data, number.key, changed.folder) == typed, number.key
        assert number.of(typed) == pytest.approx(value, rel=1e-6)
    numbers = np.array(acted["copied"]["numbers"])
    np.testing.assert_allclose(explored.inputs.at(numbers)[0][0, 0, 0], by_flags.card.drive.phases[0].speed.start)


@pytest.mark.usefixtures("needs_chromium")
def test_two_settings_stand_side_by_side(acted: Any) -> None:
    pins = acted["pins"]
    assert pins["shown"]
    rows = {row[0]: row[1:] for row in pins["rows"]}
    assert rows["speed"] == ["16.0 mph", "30.0 mph", "+14.0 mph", ""]
    first, second = pins["hottest"]
    *numbers, error = rows["highest of the drive"]
    assert numbers == [f"{first:.1f} °C", f"{second:.1f} °C", f"+{second - first:.1f} °C"]
    assert 0 < float(error) < 0.5, "the certificate's error beside them"
    assert all(row[-1] for name, row in rows.items() if name != "speed")
    assert pins["note"].startswith("B − A: blue colder, red hotter")
    assert pins["ghosts"] == 2 * 6


@pytest.mark.usefixtures("needs_chromium")
def test_along_the_envelope_the_limit_is_met(acted: Any) -> None:
    assert acted["envelopeDone"]
    assert acted["axes"] == [1, 0]
    assert len(acted["envelope"]) >= 3
    np.testing.assert_allclose(acted["envelope"], 40.0, atol=0.05)


@pytest.mark.usefixtures("needs_chromium")
def test_time_is_a_slider_and_plays(acted: Any) -> None:
    assert acted["time"] == {"state": pytest.approx(60.0), "clock": "60 s"}
    assert 60.0 < acted["played"] <= 120.0
    assert acted["paused"]


@pytest.mark.usefixtures("needs_chromium")
def test_a_measured_run_sets_its_drive_and_shows_residuals(acted: Any, explored: Exploration) -> None:
    """Residuals are those of the same readings in Python; the other run's pressure is no slider, so it is left out."""
    keys = [number.key for number in explored.plan.varied]
    measured = acted["measured"]
    assert acted["runs"] == ["no measured run", "measured: slow"]
    assert measured["numbers"][keys.index("drive.speed")] == pytest.approx(12.0)
    assert measured["numbers"][keys.index("drive.load")] == pytest.approx(2500.0)
    run = experiments(explored.study)[0].run
    solution = explored.solve(measured["numbers"])
    place = explored.about["read"].index("deep")
    off = np.array(
        [
            reading - solution.readings(float(t))[place]
            for t, reading in zip(run.times, run.temperatures["deep"], strict=True)
        ]
    )
    assert measured["residuals"]["mean"] == pytest.approx(off.mean(), abs=1e-9)
    assert measured["residuals"]["rms"] == pytest.approx(np.sqrt((off**2).mean()), abs=1e-9)
    assert measured["residuals"]["count"] == len(run.times) == 7
    assert measured["points"] == 2 * 7
    assert f"{np.sqrt((off**2).mean()):.2f} K" in " ".join(measured["cells"])
    assert acted["reset"]["numbers"] == acted["reset"]["start"]


@pytest.mark.usefixtures("needs_chromium")
def test_a_phone_and_the_dark(page: str) -> None:
    """At a phone's width nothing stands out; in the dark letters stand on a dark ground, with enough contrast."""
    shown = result_in_browser(within_frame(page, PHONE, 844), script("phone"))
    assert shown["scroll"] <= shown["client"] == PHONE
    assert shown["wide"] == []
    assert shown["sticky"] == "sticky"
    assert 150 < shown["height"] < 844 / 2
    for theme in ("light", "dark"):
        name, *contrasts = shown[theme]
        assert name == theme
        assert min(contrasts) > 4.5


@pytest.mark.usefixtures("needs_chromium")
def test_nothing_stands_out_of_a_phone(page: str) -> None:
    # The longest words of a limit are those of the study's own.
    own_limit = page.replace('"given":true', '"given":false')
    assert own_limit != page
    for width in (SMALL_PHONE, PHONE):
        shown = result_in_browser(within_frame(own_limit, width, 568), script("phone"))
        assert shown["scroll"] <= shown["client"] == width


class _Sources(HTMLParser):
    """Addresses that a page would load, and its elements."""

    def __init__(self) -> None:
        super().__init__()
        self.addresses: list[str] = []

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.addresses += [str(value) for name, value in attributes if name in ("src", "href", "srcset", "action")]


def test_the_page_needs_no_network(page: str) -> None:
    sources = _Sources()
    sources.feed(page)
    assert sources.addresses == ["#numbers"]
    plain = re.sub(r'<script type="application/json".*?</script>', "", page, flags=re.DOTALL)
    assert set(re.findall(r"https?://[^\s\"']+", plain)) == {"http://www.w3.org/2000/svg"}
    assert not re.search(r"@import|url\(|fetch\(|XMLHttpRequest|WebSocket", plain)
    assert "<title>Explore: Small tyre &lt;of the tests&gt;</title>" in page


def test_no_sign_of_the_data_is_one_of_html(page: str) -> None:
    """A title with ``<!-- <script>`` would hide the end of the data, and the page would stay empty."""
    (data,) = re.findall(r'<script type="application/json" id="data">(.*?)</script>', page, flags=re.DOTALL)
    assert "<" not in data
    assert json.loads(data)["title"] == "Small tyre <of the tests>"


def test_a_changed_table_with_dotted_names_is_copied_whole(small: Study) -> None:
    """``sensors.T1.5`` would be the key 5 of a sensor T1."""
    sensors = {**small.data["sensors"], "T1.5": {"s": "0 mm", "depth": "2 mm"}}
    changes = changes_of_file(small.replace({"sensors": sensors}))
    assert changes == {"mesh.size": "14 mm", "sensors": sensors}
    assert Study.load(small.file).replace(changes).sensors.keys() == sensors.keys()


def test_a_limit_on_both_sides_has_two_rows() -> None:
    limits = {"hottest_degC": LimitCard(below=40, above=20), "rolling_resistance_N": LimitCard(above=5)}
    model: Any = SimpleNamespace(plan=SimpleNamespace(limits=limits))
    rows = [(row["answer"], row["below"], row["above"]) for row in limits_of(model, ())]
    assert rows == [("hottest_degC", 40, None), ("hottest_degC", None, 20), ("rolling_resistance_N", None, 5)]


def test_a_phase_with_a_dot_in_its_name_has_sliders(small: Study) -> None:
    phases = [{"name": "at 1.5 bar", "duration": "20 s", "speed": "12 mph"}]
    drive = {"load": "2700 lbf", "pressure": "83 psi", "phases": phases}
    study = small.replace({"drive": drive, "measured": []})
    key = "drive.phases.0.speed"
    assert default_box(study)[key] == {"from": "6 mph", "to": "18 mph"}
    assert value_at(study.data, key) == "12 mph"
    assert label_of(key, ["at 1.5 bar"]) == ("Drive", "speed, at 1.5 bar")


def test_a_notebook_shows_the_page(explored: Exploration) -> None:
    framed = explored._repr_html_()
    assert framed.startswith("<iframe srcdoc=")
    assert "Small tyre &amp;lt;of the tests" in framed
    assert framed.count('"') % 2 == 0
    assert "BoxModel" not in repr(explored)
    assert "certificate" in repr(explored)


def test_runs_of_other_drives_are_named(page: str, small: Study) -> None:
    assert "Measured runs that are not shown: other (its drive needs numbers that do not vary here)" in page
