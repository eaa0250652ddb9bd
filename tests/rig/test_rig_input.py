"""Impossible rigs and bad tables: one clear line that names file and field, exit code 2, nothing written."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tyrefem.cards import merged, read_toml
from tyrefem.cli import main
from tyrefem.errors import InputError
from tyrefem.heating_test.card import RigCard
from tyrefem.heating_test.files import find, tables
from tyrefem.heating_test.layer_cards import bases
from tyrefem.rig import load, read, simulate

pytestmark = pytest.mark.fast

CARD = find("trtlab").read_text(encoding="utf-8")
TABLE = "time [s],outer [degC],inner [degC],interface [degC]\n" + "".join(
    f"{t},{22 + t / 10},{22 + t / 200},{22 + t / 100}\n" for t in range(0, 400, 10)
)


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("TYREFEM_PATH", raising=False)
    return tmp_path


IMPOSSIBLE = [
    ('spot_diameter = "10 mm"', 'spot_diameter = "130 mm"', "laser.spot_diameter: the spot, 130 mm wide"),
    ('power = "0.5 W"', 'power = "5 W"', "runs.low.power: 5 W is outside the laser's range, 0.5 to 2 W"),
    ('cooling = "550 s"\n', "", "phases.cooling: missing"),
    ('heating = "1050 s"', 'heating = "0 s"', "phases.heating"),
    ('depth = "8 mm" ', 'depth = "15 mm" ', "sensors.interface.depth: 15 mm is outside the tyre"),
    ('thickness = "8 mm"', 'thickness = "0 mm"', "layers.0.thickness"),
    ('thickness = "8 mm"', 'thickness = "8"', "has no unit"),
    ('name = "carcass"', 'name = "tread"', "two layers are named 'tread'"),
    ('name = "carcass"', 'name = "/tmp/carcass"', "layers.1.name: '/tmp/carcass' is no name of a layer"),
    ('name = "carcass"', 'name = "car/cass"', "layers.1.name: 'car/cass' is no name of a layer"),
    ('name = "carcass"', 'name = "carcass: 2"', "layers.1.name: 'carcass: 2' is no name of a layer"),
    ('name = "carcass"', 'name = "aux"', "layers.1.name: 'aux' is no name of a layer, which names a file too: Windows"),
    ('name = "carcass"', 'name = "Tread"', "layers.1.name: 'tread' and 'Tread' differ only in capital letters"),
    ("[runs.low]", "[runs.MID]\npower = '1 W'\n[runs.mid]", "runs: 'mid' and 'MID' differ only in capital letters"),
    ("[runs.low]", '[runs."../low"]', "runs: '../low' is no name of a run, which names a file too; allowed: no /"),
    ("absorptance = 0.95", "absorptance = 1.2", "laser.absorptance"),
    ('value = "0.25 W/m/K"', 'value = "0 W/m/K"', "layers.0.conductivity.value"),
    ('circumferential_radius = "300 mm"', 'circumferential_radius = "8 mm"', "cannot have this curvature"),
    ('face = "inner"', 'face = "innner"', "sensors.inner.face"),
    ('face = "inner"\n', "", "a camera needs 'face'"),
    ('window = "4 mm"                     #', 'windw = "4 mm" #', "did you mean 'window'"),
    ('power_range = ["0.5 W", "2 W"]', 'power_range = ["2 W", "0.5 W"]', "laser.power_range"),
    ("convection_sd = 0.15", "convection_sd = nan", "surroundings.convection_sd"),
]


@pytest.mark.parametrize(("old", "new", "words"), IMPOSSIBLE, ids=[row[2][:28] for row in IMPOSSIBLE])
@pytest.mark.parametrize("command", [["simulate"], ["identify"], ["layers"]], ids=lambda c: c[0])
def test_impossible_rig(
    command: list[str], old: str, new: str, words: str, here: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    assert old in CARD
    (here / "rig.toml").write_text(CARD.replace(old, new, 1), encoding="utf-8")
    (here / "low.csv").write_text(TABLE, encoding="utf-8")
    tables = ["low.csv"] if command == ["identify"] else []
    assert main(["rig", *command, "rig.toml", *tables, "--out", "out"]) == 2
    out, err = capfd.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert err.startswith("tyrefem: rig.toml: ")
    assert words in err
    assert not (here / "out").exists()


CROWN = {"circumferential_radius": "43 mm", "lateral_radius": "43 mm"}
IMPOSSIBLE_TABLES = [
    ({"laser": {"spot_diameter": "100 mm"}, "patch": CROWN}, "^laser.spot_diameter: .* along its curved face"),
    # 38 mm from the axis are 46.6 mm along the face.
    ({"laser": {"spot_diameter": "76 mm"}, "patch": {**CROWN, "radius": "45 mm"}}, "^laser.spot_diameter"),
    ({"patch": {"lateral_radius": "8 mm"}}, "^patch.lateral_radius: .* cannot have this curvature"),
    ({"sensors": {"outer": {"depth_sd": "1 mm"}}}, "^sensors.outer.depth_sd: a camera measures a face"),
    ({"sensors": {" in": {"instrument": "camera", "face": "inner", "noise": "1 K"}}}, "^sensors: ' in' is no name"),
    ({"sensors": {"a\nb": {"instrument": "camera", "face": "inner", "noise": "1 K"}}}, "^sensors: .* line break"),
]


@pytest.mark.parametrize(("changes", "words"), IMPOSSIBLE_TABLES, ids=[row[1][:24] for row in IMPOSSIBLE_TABLES])
def test_impossible_tables_of_a_card(changes: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        RigCard.check(merged(read_toml(find("trtlab")), changes))


def test_a_spot_on_a_curved_patch_that_holds_it_is_possible() -> None:
    data = merged(read_toml(find("trtlab")), {"laser": {"spot_diameter": "76 mm"}, "patch": CROWN})
    assert RigCard.check(data).patch.along_face(38e-3) == pytest.approx(46.64e-3, rel=1e-3)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (["tread=nasa-tread", "tread=nasa-carcass"], "a second card for layer 'tread': nasa-carcass"),
        (["nasa-tread", "nasa-carcass"], "a second card for all layers: nasa-carcass"),
    ],
)
def test_a_layer_has_a_single_base_card(given: list[str], words: str) -> None:
    card, _ = load("trtlab")
    with pytest.raises(InputError, match=f"--base: {words}"):
        bases(card, given)
    mixed = ["tread=nasa-tread", "nasa-carcass"]
    assert bases(card, mixed) == bases(card, mixed[::-1]) == {"tread": "nasa-tread", "carcass": "nasa-carcass"}


BAD = [
    (TABLE.replace("inner [degC]", "innner [degC]"), [], "no column 'inner [degC]'; did you mean 'innner'"),
    (TABLE.replace("inner [degC]", "inner"), [], "has no unit"),
    (TABLE.replace("\n100,", "\n90,"), [], "times must increase"),
    (TABLE.replace("\n100,32.0", "\n100,hot"), [], "hot"),
    ("\n".join(TABLE.splitlines()[:6]), [], "fewer than 5 readings after 60 s"),
    (TABLE + "2000,50,30,30\n", [], "lasts until 2000 s"),
    (TABLE.replace("outer [degC]", "outer [degC],spare [degC]").replace("0,22", "0,1,22"), [], "line"),
    (TABLE.replace("interface", "couple"), ["--without", "interface"], "'couple' is no sensor of the rig"),
    (TABLE, ["--without", "inne"], "--without: unknown sensor 'inne'; did you mean 'inner'"),
    (TABLE, ["--base", "nasa-treed"], "did you mean 'nasa-tread'"),
    (TABLE, ["--base", "traed=nasa-tread"], "unknown layer 'traed'; did you mean 'tread'"),
]


@pytest.mark.parametrize(("table", "options", "words"), BAD, ids=[row[2][:28] for row in BAD])
def test_bad_table(table: str, options: list[str], words: str, here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    (here / "low.csv").write_text(table, encoding="utf-8")
    assert main(["rig", "identify", "trtlab", "low.csv", *options, "--out", "out"]) == 2
    out, err = capfd.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert words in err
    assert not (here / "out").exists()


def test_a_card_can_be_checked_without_running(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(find("trtlab").parent)]) == 0
    assert "a laser rig, 2 layers, 3 sensors, 2 runs" in capfd.readouterr().out
    (here / "rig.toml").write_text(CARD.replace('idle = "60 s"', 'idle = "60"'), encoding="utf-8")
    assert main(["check", "rig.toml"]) == 2
    assert "rig.toml: phases.idle: '60' has no unit" in capfd.readouterr().err


def test_tables_must_belong_to_the_card(here: Path) -> None:
    card, _ = load("trtlab")
    (here / "lo.csv").write_text(TABLE, encoding="utf-8")
    (here / "low.csv").write_text(TABLE, encoding="utf-8")
    with pytest.raises(InputError, match="run 'lo' is not in the rig's card; did you mean 'low'"):
        read(card, ["lo.csv"])
    with pytest.raises(InputError, match="given twice"):
        read(card, ["low.csv", "low.csv"])
    with pytest.raises(InputError, match="no table"):
        read(card, [])
    with pytest.raises(InputError, match=r"none of low\.csv, high\.csv is beside the card"):
        tables(card, here / "elsewhere" / "rig.toml")
    with pytest.raises(InputError, match="no rig named"):
        load("trtlb")


def test_readings_of_a_fast_logger_are_averaged_but_not_over_a_switch(here: Path) -> None:
    """Groups keep the sum of the readings, leave gaps out, and none holds times on both sides of 60 s."""
    card, _ = load("trtlab")
    t = np.arange(0.0, 400.0, 0.25)
    rng = np.random.default_rng(0)
    outer = rng.normal(30.0, 1.0, t.size)
    gap = rng.random(t.size) < 0.1
    rows = [f"{a},{'' if g else b},30,30" for a, b, g in zip(t, outer, gap, strict=True)]
    (here / "low.csv").write_text("time [s],outer [degC],inner [degC],interface [degC]\n" + "\n".join(rows), "utf-8")
    (test,) = read(card, ["low.csv"])
    outer_series = next(series for series in test.series if series.sensor == "outer")
    assert outer_series.times.size <= 402
    assert outer_series.counts.sum() == (~gap).sum()
    assert float(outer_series.counts @ outer_series.readings) == pytest.approx(float(outer[~gap].sum()))
    before = outer_series.times < 60.0
    assert float(outer_series.counts[before].sum()) == (~gap & (t < 60.0)).sum()
    assert outer_series.matrix.sum(axis=1) == pytest.approx(np.ones(outer_series.times.size))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"every": "5 s"}, "every: must be a number in s, not '5 s'"),
        ({"every": 0.0}, "every: must be more than 0 s, not 0 s"),
        ({"every": 1e5}, "every: 100000 s leaves no reading"),
        ({"seed": -1}, "seed: must be a whole number of at least 0, not -1"),
        ({"seed": "a"}, "seed: must be a whole number of at least 0, not 'a'"),
    ],
)
def test_errors_of_python_name_the_argument(options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=f"^{message}"):
        simulate("trtlab", **options)


def test_errors_of_the_command_name_the_option(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["rig", "simulate", "trtlab", "--every", "1e5 s", "--out", "out"]) == 2
    assert "--every: 100000 s leaves no reading" in capfd.readouterr().err
    card, _ = load("trtlab")
    with pytest.raises(InputError, match=r"^without: unknown sensor 'inne'; did you mean 'inner'\?"):
        read(card, [], ["inne"])
