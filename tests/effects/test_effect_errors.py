"""A wrong entry of [[effects]] is refused in words; a user's own effects are found in the folder that is named."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest
from suitable import COARSE

import tyrefem as tf
from tyrefem.effects import catalogue
from tyrefem.effects.description import example, parameter_rows, ports
from tyrefem.effects.effect import PORTS
from tyrefem.errors import InputError, PluginWarning
from tyrefem.plugins import use
from tyrefem.reports.inputs import effect_rows

pytestmark = pytest.mark.fast

OWN = '''
"""A lamp beside the tyre."""

from typing import Annotated, ClassVar

from tyrefem.effects import Effect, Prior


class Lamp(Effect):
    """Flux through the outer sidewall."""

    name: ClassVar[str] = "{name}"
    family: ClassVar[str] = "boundary"
    sentence: ClassVar[str] = "A lamp shines on the sidewall."
    source: ClassVar[str] = "estimate: a halogen lamp of 500 W at 1 m"
    surfaces: ClassVar[tuple[str, ...]] = ("outside_air",)

    shine: Annotated[float, Prior("W/m**2", "flux through the sidewall", {scale}, 0.0, 1e4)] = {default}

    def flux(self, tyre, surface, x, t):
        return self.shine
'''


CHOOSING = '''
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from tyrefem.effects import Effect, Prior


class Draught(Effect):
    """Film of one side times 1 + gain."""

    name: ClassVar[str] = "draught"
    family: ClassVar[str] = "boundary"
    sentence: ClassVar[str] = "A draught blows on one side."
    source: ClassVar[str] = "estimate: made up for a test"

    side: Literal["left", "right"]
    place: str
    fan: Annotated[str, Field(description="name of the fan", examples=["hall"])]
    gain: Annotated[float, Prior("1", "part by which the film grows", 0.5, 0.0, 5.0)] = 0.0

    def film_factor(self, tyre, film, t):
        return 1 + self.gain
'''


HEAT = {"name": "missing-heat", "width": "10 mm", "heat": "50 kW/m**3"}


@pytest.fixture
def study() -> tf.Study:
    """Six sensors on a coarse mesh."""
    return tf.study("example-validation").replace(COARSE)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The user's folder of effects."""
    monkeypatch.setenv("TYREFEM_EFFECTS", str(tmp_path))
    return tmp_path


@pytest.mark.parametrize(
    ("effect", "words"),
    [
        ({"name": "hot-raod"}, "unknown effect 'hot-raod'; did you mean 'hot-road'?"),
        ({"warmer_by": "3 delta_degC"}, "missing; it names the effect"),
        ("hot-road", "must be a table with a name"),
        ({"name": "hot-road", "warmer": "3 delta_degC"}, "unknown key 'warmer'; did you mean 'warmer_by'?"),
        ({"name": "hot-road", "warmer_by": "3 degC"}, "write 'delta_degC'"),
        ({"name": "hot-road", "warmer_by": 3}, "has no unit"),
        ({"name": "sun", "absorbed": "-1 W/m**2"}, "must be at least 0 W/m**2"),
        ({"name": "wet-road", "film_gain": "nan"}, "film_gain"),
        ({"name": "sensor-lag", "slower_by": "3 s"}, "sensor: missing; this field is required"),
        ({"name": "sensor-lag", "sensor": "crown-iner"}, "no sensor 'crown-iner'; did you mean 'crown-inner'?"),
        ({"name": "swapped-channels", "sensor": "crown-inner", "other": "bed"}, "no sensor 'bed'; did you mean 'bead'"),
        ({"name": "swapped-channels", "sensor": "bead", "other": "bead"}, "swapped with itself"),
        ({"name": "road-film-speed", "exponent": 0.5}, "the road's law 'cattani' has the speed in it already"),
        ({"name": "gas-mass", "fraction": 1.0}, "the contained air's law is 'gas', not 'report'"),
        ({"name": "brake-power", "power": "1 kW"}, "only a lumped rim takes up heat; use 'brake-heat'"),
        ({"name": "camber", "angle": "1 deg"}, "needs the full section: [mesh] section = 'full'"),
        ({"name": "yaw", "slip": "1 %"}, "needs the full section"),
        ({"name": "missing-loss", "region": "tred", "gain": 0.5}, "has no region 'tred'; did you mean 'tread'?"),
        ({**HEAT, "station": "60 mm", "region": "tred"}, "has no region 'tred'; did you mean 'tread'?"),
        ({**HEAT, "station": "60 m"}, "station 60,000 mm lies beyond the meridian, which ends 147.8 mm from the crown"),
        ({"name": "missing-flux", "station": "6 m", "width": "9 mm"}, "station 6,000 mm lies beyond the meridian"),
    ],
)
def test_a_wrong_entry_is_refused(study: tf.Study, effect: Any, words: str) -> None:
    with pytest.raises(tf.InputError) as caught:
        study.replace({"boundaries.road": {"law": "cattani"}, "effects": [effect]})
    assert words in str(caught.value)
    assert "effects" in str(caught.value)


def test_effects_of_other_boundaries_are_refused(study: tf.Study) -> None:
    rim = {"law": "lumped", "mass": "9 kg", "cooling": "2 W/K"}
    with pytest.raises(tf.InputError, match="use 'brake-power'"):
        study.replace({"boundaries.rim": rim, "effects": [{"name": "brake-heat", "warmer_by": "9 delta_degC"}]})
    no_pressure = "of mechanics.load_law, and .* does not depend on pressure"
    for drive, words in (({"deflection": "1 in"}, "gives the deflection"), ({}, no_pressure)):
        law = {"law": "vertical-stiffness", "stiffness": "400 N/mm", "source": "estimate: a test"}
        changes: dict[str, Any] = {"mechanics.load_law": law} if not drive else {}
        if drive:
            kept = {key: value for key, value in study.data["drive"].items() if key != "load"}
            changes = {"drive": {**kept, **drive}}
        for name in ("pressure-rise", "pressure-loss"):
            with pytest.raises(tf.InputError, match=words):
                study.replace({**changes, "effects": [{"name": name}]})


@pytest.mark.parametrize(
    ("entries", "words"),
    [
        ([{"name": "sun"}, {"name": "sun", "absorbed": "1 W/m**2"}], "effects.sun: is given twice"),
        ([{"name": "sensor-lag", "sensor": "bead"}] * 2, "effects.sensor-lag: is given twice"),
        (
            [
                {"name": "swapped-channels", "sensor": "bead", "other": "surface"},
                {"name": "swapped-channels", "sensor": "surface", "other": "crown-inner"},
            ],
            "effects.swapped-channels: 'surface' is swapped twice",
        ),
    ],
)
def test_twice_the_same_is_refused(study: tf.Study, entries: list[dict[str, str]], words: str) -> None:
    with pytest.raises(tf.InputError, match=words):
        study.replace({"effects": entries})


def test_two_sensors_may_lag(study: tf.Study) -> None:
    lags = [{"name": "sensor-lag", "sensor": name, "slower_by": "3 s"} for name in ("bead", "surface")]
    assert [lag.choice for lag in study.replace({"effects": lags}).effects] == [
        {"sensor": "bead"},
        {"sensor": "surface"},
    ]


def test_provenance_and_sd_are_kept(study: tf.Study) -> None:
    entry = {"name": "hot-road", "warmer_by": "10 delta_degC", "from": "diagnosis of run-1.csv"}
    (effect,) = study.replace({"effects": [entry | {"sd": {"warmer_by": "2 delta_degC"}}]}).effects
    assert effect.provenance == "diagnosis of run-1.csv"
    assert effect.sd == {"warmer_by": "2 delta_degC"}


def test_the_report_names_the_effects_at_work(study: tf.Study) -> None:
    entries = [
        {"name": "hot-road", "warmer_by": "10 K", "from": "diagnosis of run-1.csv", "sd": {"warmer_by": "2 K"}},
        {"name": "sensor-lag", "sensor": "bead", "slower_by": "8 s"},
        {"name": "sun", "absorbed": "0 W/m**2"},
    ]
    road, lag = effect_rows(study.replace({"effects": entries}))
    assert road == ["hot-road", catalogue()["hot-road"].sentence, "warmer by 10 delta_degC ± 2 K", entries[0]["from"]]
    assert lag[2:] == ["sensor bead; slower by 8 s", "the study"]


def test_an_effect_of_the_user_s_folder_acts(folder: Path, study: tf.Study) -> None:
    (folder / "lamp.py").write_text(OWN.format(name="lamp", scale="50.0", default="0.0"), encoding="utf-8")
    use(folder)
    assert "lamp" in catalogue()
    dark, lit = (
        study.replace({"effects": [{"name": "lamp", "shine": f"{shine} W/m**2"}]}).run().readings
        for shine in (0.0, 50.0)
    )
    assert (lit - dark)["sidewall-outer"].iloc[-1] > 0.1


def test_without_the_folder_it_is_gone(study: tf.Study) -> None:
    assert "lamp" not in catalogue()
    with pytest.raises(tf.InputError, match=r"unknown effect 'lamp'.*your own needs its folder in TYREFEM_PLUGINS"):
        study.replace({"effects": [{"name": "lamp", "shine": "50 W/m**2"}]})


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("class Lamp(", "cannot be loaded: line 1: SyntaxError"),
        ("import nothing_like_it", "cannot be loaded: ModuleNotFoundError"),
        (OWN.format(name="lamp", scale="-1.0", default="0.0"), "effect 'lamp': parameter 'shine' needs a positive"),
        (OWN.format(name="lamp", scale="1.0", default="3.0"), "parameter 'shine' must have the default 0"),
        (
            OWN.format(name="lamp", scale="1.0", default="0.0").replace("0.0, 1e4", "1.0, 1e4"),
            "parameter 'shine': 'null' is 0, outside its bounds 1 to 10000; 'null' is the value at which the effect is "
            "absent; a period or a place has none: Prior(..., start=VALUE, amplitude=False)",
        ),
        (OWN.format(name="lamp", scale="1.0", default="0.0").replace("def flux", "def flow"), "overrides no port"),
        (OWN.format(name="lamp", scale="1.0", default="0.0").replace('"boundary"', '"boundry"'), "'boundary'"),
        (OWN.format(name="lamp", scale="1.0", default="0.0").replace('"estimate', '"" #'), "needs 'source'"),
    ],
)
def test_a_bad_file_is_one_clear_warning_and_is_left_out(folder: Path, text: str, words: str) -> None:
    (folder / "lamp.py").write_text(text, encoding="utf-8")
    with pytest.warns(PluginWarning) as warned:
        assert "lamp" not in catalogue()
    assert "hot-road" in catalogue()  # and no second warning
    (message,) = [str(warning.message) for warning in warned]
    assert message.startswith(f"left out: {folder / 'lamp.py'}: ")
    assert words in message
    assert "\n" not in message


def test_a_name_that_is_taken_is_refused(folder: Path) -> None:
    (folder / "lamp.py").write_text(OWN.format(name="hot-road", scale="1.0", default="0.0"), encoding="utf-8")
    with pytest.warns(PluginWarning, match="'hot-road' has the name of a shipped effect"):
        assert catalogue()["hot-road"].__module__ == "tyrefem.effects.hot_road"


def test_a_folder_that_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TYREFEM_EFFECTS", "/nowhere/at/all")
    with pytest.warns(PluginWarning, match="TYREFEM_EFFECTS names '/nowhere/at/all', which is not a folder"):
        assert "lamp" not in catalogue()


def test_an_effect_says_of_itself_what_it_is(folder: Path) -> None:
    """Port, meaning and example of a choice stand in the effect's own file; a choice without example has one too."""
    (folder / "draught.py").write_text(CHOOSING, encoding="utf-8")
    effect = catalogue()["draught"]
    assert ports(effect) == "factor on films"
    assert {row[0]: row[1] for row in parameter_rows(effect)} == {
        "gain": "part by which the film grows", "side": "choice", "place": "choice", "fan": "name of the fan"
    }  # fmt: skip
    assert tomllib.loads(example(effect))["effects"] == [
        {"name": "draught", "side": "left", "place": "...", "fan": "hall", "gain": 0.5}
    ]


def test_ports_that_only_measure() -> None:
    measuring = {name for name, effect in catalogue().items() if effect.only_measures()}
    assert measuring == {name for name, effect in catalogue().items() if effect.family == "measurement"}
    assert {port.name for port in PORTS if port.changes == "measurement"} == {
        "displacement", "lag_addend", "offset", "clock", "channel"
    }  # fmt: skip


@pytest.mark.parametrize("part", [{"station": "60 mm"}, {"width": "10 mm"}])
def test_a_flux_has_a_station_and_a_width_or_is_the_same_on_the_whole_surface(part: dict[str, str]) -> None:
    entry = {"name": "missing-flux", "into": "100 W/m**2"}
    with pytest.raises(InputError, match="state both station and width, or neither for the whole surface"):
        tf.study("example-validation").replace({"effects": [entry | part]})
    (whole,) = tf.study("example-validation").replace({"effects": [entry | {"surface": "tread"}]}).effects
    assert whole.choice == {"surface": "tread"}
    assert whole.surfaces == ("road",)


def test_a_standing_wave_is_not_counted_beside_the_inertia_of_the_rolling_tyre() -> None:
    mechanics = {"mechanics.strain": "fem", "mechanics.motion": "linear", "mechanics.rolling": True}
    wave = catalogue()["standing-wave"]
    assert wave.refusal(tf.study("nasa-22x5.5-8pr")) is None
    assert "mechanics.rolling" in str(wave.refusal(tf.study("nasa-22x5.5-8pr", mechanics)))
    with pytest.raises(InputError, match=r"inertia already: mechanics\.rolling"):
        tf.study("nasa-22x5.5-8pr", {**mechanics, "effects": [{"name": "standing-wave", "gain": 2.0}]})


@pytest.mark.parametrize("name", ["missing-heat", "missing-flux"])
def test_heat_that_ends_before_it_begins_is_refused(name: str) -> None:
    place = {"station": "60 mm", "width": "10 mm"}
    with pytest.raises(InputError, match="ends at 300 s, before it begins at 600 s"):
        catalogue()[name].check({**place, "begins": "600 s", "ends": "300 s"})
    assert catalogue()[name].check({**place, "begins": "300 s", "ends": "600 s"})


@pytest.mark.parametrize(
    ("sd", "message"),
    [
        ({"film_gian": 0.1}, r"sd: 'film_gian' is no number of this effect; did you mean 'film_gain'"),
        ({"film_gain": -0.1}, r"sd\.film_gain: -0\.1 is out of range: must be at least 0"),
        ({"film_gain": float("nan")}, r"sd\.film_gain: nan is not a finite number"),
        ({"film_gain": "5 mm"}, r"sd\.film_gain: 'mm' is not a unit"),
    ],
)
def test_a_wrong_standard_deviation_is_refused(sd: dict[str, Any], message: str) -> None:
    """It was left out of a diagnosis unseen, or failed there."""
    wet = {"name": "wet-road", "film_gain": 0.5}
    assert tf.study("nasa-22x5.5-8pr", {"effects": [{**wet, "sd": {"film_gain": "10 %"}}]}).effects
    with pytest.raises(InputError, match=message):
        tf.study("nasa-22x5.5-8pr", {"effects": [{**wet, "sd": sd}]})


def test_an_effect_without_a_name() -> None:
    with pytest.raises(InputError, match=r"effects\.0\.name: missing; it names the effect; allowed: ambient-drift"):
        tf.study("nasa-22x5.5-8pr", {"effects": [{"film_gain": 0.5}]})
