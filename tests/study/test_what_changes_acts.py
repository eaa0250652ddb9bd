"""Values that are changed act: with caches of another variant at hand, in every command, or they are refused."""

from __future__ import annotations

import dataclasses
import shutil
from pathlib import Path
from typing import Any

import pytest

import tyrefem as tf
from tyrefem import library
from tyrefem.diagnose.blind.fitted_cases import fitted_tag
from tyrefem.diagnose.blind.rates import tag_of
from tyrefem.errors import InputError
from tyrefem.heating_test.card import SensorCard
from tyrefem.inputs.loading import LoadCase
from tyrefem.inputs.wheel_state import WheelState
from tyrefem.mechanics.rolling.rolled_footprint import _tyre_key
from tyrefem.simulation.run import run
from tyrefem.variants.task import bundle

SHORT = {"mesh.size": "14 mm", "mesh.element": "P1", "drive.duration": "60 s"}
FEM = SHORT | {"mechanics.strain": "fem", "mechanics.motion": "linear"}
SHEAR = "materials.carcass.cord.ply_shear_modulus"


def test_films_of_another_strain_cycle_are_not_shared() -> None:
    study = tf.study("nasa-22x5.5-8pr", FEM)
    soft, stiff = study.replace({SHEAR: "20 MPa"}), study.replace({SHEAR: "138 MPa"})
    after = run(stiff, like=run(soft).tyre)
    assert after.tyre.road_fraction(1.0) == pytest.approx(run(stiff).tyre.road_fraction(1.0), rel=1e-12)
    assert float(after.readings.iloc[-1]["crown-outer"]) == pytest.approx(
        float(run(stiff).readings.iloc[-1]["crown-outer"]), abs=1e-9
    )
    # With the same strain cycle they are.
    again = run(soft.replace({"materials.tread.conductivity.value": "0.25 W/m/K"}), like=(first := run(soft)).tyre)
    assert again.tyre.schedule is first.tyre.schedule


def test_secant_moduli_belong_to_a_load() -> None:
    study = tf.study("passenger-205-55r16", {"boundaries.sliding": "rolling", "mechanics.motion": "linear"})
    light = LoadCase(2000.0, 0.0, 2e5, 0.3, wheel=WheelState())
    secant = study.replace({"mechanics.moduli": "secant"})
    assert _tyre_key(secant, light) != _tyre_key(secant, dataclasses.replace(light, load=5000.0))
    assert _tyre_key(study, light) == _tyre_key(study, dataclasses.replace(light, load=5000.0))


def edited(tmp_path: Path, tan_delta: float) -> tf.Study:
    """A study with a card of its own, which is edited in place."""
    card = tmp_path / "mine.toml"
    data = (library.shipped() / "materials" / "nasa-bead.toml").read_text(encoding="utf-8")
    card.write_text(data.replace('title = "', f'title = "tan delta {tan_delta} '), encoding="utf-8")
    return tf.study("nasa-22x5.5-8pr", {**SHORT, "materials.tread": str(card)})


def test_kept_cases_and_packed_studies_see_an_edited_card(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = edited(tmp_path, 0.1)
    before = tag_of(first, 4, 1), fitted_tag(first, 1), bundle(first).digest
    again = edited(tmp_path, 0.1)
    assert (tag_of(again, 4, 1), fitted_tag(again, 1), bundle(again).digest) == before
    second = edited(tmp_path, 0.2)
    assert not {tag_of(second, 4, 1), fitted_tag(second, 1), bundle(second).digest} & set(before)
    # A card of the shipped folder, as in an editable installation, may be edited too; it goes by its name.
    clone, away = tmp_path / "clone", tmp_path / "away"
    for folder in ("geometry", "materials"):
        shutil.copytree(library.shipped() / folder, clone / folder)
    shutil.copytree(library.find("study", "nasa-22x5.5-8pr").parent, away)
    monkeypatch.chdir(away)
    monkeypatch.setattr(library, "shipped", lambda: clone)
    here = bundle(tf.study(away))
    assert not here.files
    tread = clone / "materials" / "nasa-tread.toml"
    tread.write_text(tread.read_text(encoding="utf-8").replace("value = 0.2\n", "value = 0.3\n"), encoding="utf-8")
    assert bundle(tf.study(away)).digest != here.digest


def test_a_rim_takes_heat_from_air_that_is_held_too() -> None:
    rim = {"law": "lumped", "mass": "2 kg", "specific_heat": "900 J/kg/K", "film": "200 W/m**2/K", "cooling": "1 W/K"}
    gas = {"law": "held", "temperature": "90 degC"}
    study = tf.study("nasa-22x5.5-8pr", {**SHORT, "boundaries.contained_air": gas})
    ends = []
    for air in ("0 W/K", "50 W/K"):
        result = study.replace({"boundaries.rim": {**rim, "air": air}}).run()
        assert result.heat_budget.imbalance < 1e-9
        ends.append(float(result.readings.iloc[-1]["rim"]))
    assert ends[1] > ends[0] + 5.0


def test_a_pressed_tyre_has_the_speed_that_is_given() -> None:
    study = tf.study("nasa-22x5.5-8pr", FEM)
    assert study.press(speed=20.0).speed == 20.0
    assert study.press().speed == pytest.approx(20 * 0.44704)
    rolling = study.replace({"mechanics.rolling": True})
    assert rolling.press(speed=20.0).speed == 20.0


@pytest.mark.parametrize("options", [{"plateau": True}])
def test_a_life_at_one_temperature_has_no_plateau(options: dict[str, Any]) -> None:
    with pytest.raises(InputError, match="goes without a run and without plateau"):
        tf.study("passenger-205-55r16").life(temperature=80.0, **options)


def test_a_camera_has_no_lag() -> None:
    camera = {"instrument": "camera", "face": "outer", "noise": "0.5 delta_degC"}
    assert SensorCard.check(camera).lag == 0.0
    with pytest.raises(InputError, match="a camera has no lag"):
        SensorCard.check(camera | {"lag": "5 s"})
