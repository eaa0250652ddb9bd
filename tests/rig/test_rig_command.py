"""`tyrefem rig` from another folder: simulated tables are identified, the cards run, the layer study is written."""

from __future__ import annotations

import json
import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from tyrefem.cli import main
from tyrefem.heating_test.files import find
from tyrefem.heating_test.grid import Fineness
from tyrefem.heating_test.layer_study import merged, study
from tyrefem.heating_test.readings import matched
from tyrefem.materials.card import material
from tyrefem.measured import read_table
from tyrefem.reports import rig_figures
from tyrefem.reports.rig import save_layers
from tyrefem.rig import load, simulate

SHORT = ("--set", "drive.duration=10 s", "--set", "mesh.size=8 mm", "--set", "output.fields=2")


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a short version of the shipped rig: one power, 200 s of heating, no cooling."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("TYREFEM_PATH", raising=False)
    text = find("trtlab").read_text(encoding="utf-8").split("[runs.high]")[0]
    text = text.replace('"1050 s"', '"200 s"').replace('cooling = "550 s"', 'cooling = "60 s"')
    (tmp_path / "mine.toml").write_text(text, encoding="utf-8")
    return tmp_path


def test_from_simulation_to_a_card_that_runs(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["rig", "simulate", "mine.toml", "--seed", "1", "--every", "2 s", "--out", "sim"]) == 0
    assert json.loads(Path("sim/summary.json").read_text(encoding="utf-8"))["file"] == "mine.toml"
    (run,) = read_table("sim/low.csv")
    assert run.comments[0].startswith("SIMULATED")
    assert {"readings.png", "patch.png", "summary.json", "low.csv"} == {file.name for file in Path("sim").iterdir()}
    assert main(["rig", "identify", "mine.toml", "sim/low.csv", "--base", "tread=nasa-tread", "--constant"]) == 0
    out = Path("results/rig-mine-identified")
    record = json.loads((out / "rig.json").read_text(encoding="utf-8"))
    assert record["file"] == "mine.toml"
    tread = next(estimate for estimate in record["estimates"] if estimate["name"] == "tread.conductivity")
    assert tread["low_95"] < 0.25 < tread["high_95"]
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "http" not in page.replace("http-equiv", "")
    assert page.count("data:image/png;base64") == 3
    assert re.search(r"Diffusivity: tread 0\.\d+ mm²/s", page)
    assert not re.search(r"<td>[\d.]+e[+]\d", page), "a number of some hundreds with an exponent"
    assert (out / "residuals.csv").read_text(encoding="utf-8").count("\n") == 1 + 3 * 161
    assert not (out / "materials" / "carcass.toml").exists()
    card = material("results/rig-mine-identified/materials/tread.toml")
    assert card.conductivity.law() == pytest.approx(tread["value"], rel=1e-4)
    assert card.conductivity.relative_sd == pytest.approx(tread["relative_sd"], rel=0.06)
    assert "laser rig" in card.conductivity.source
    assert card.loss_tangent(25.0) == pytest.approx(0.2)
    assert "nasa-tread" in card.notes
    change = f"materials.tread={out}/materials/tread.toml"
    assert main(["run", "nasa-22x5.5-8pr", *SHORT, "--no-pictures", "--no-vtk", "--set", change, "--out", "run"]) == 0
    assert Path("run/summary.json").is_file()
    capfd.readouterr()


def test_a_simulation_is_shown_in_a_few_lines() -> None:
    shown = repr(simulate("trtlab", every=60.0, fineness=Fineness(2, 5, 2)))
    assert shown.startswith("Simulation of TRTLab rig")
    assert "0.8 W, highest readings outer 1" in shown
    assert shown.count("\n") == 2


def test_layers_merge_to_the_same_mass_heat_and_resistance() -> None:
    card, _ = load("layers")
    for count in (1, 2, 3, 4):
        fewer = merged(card, count)
        assert len(fewer.layers) == count
        for sums in (
            lambda layer: layer.thickness,
            lambda layer: layer.thickness * layer.density.value,
            lambda layer: layer.thickness * layer.density.value * layer.specific_heat.value,
            lambda layer: layer.thickness / layer.conductivity.value,
        ):
            assert sum(map(sums, fewer.layers)) == pytest.approx(sum(map(sums, card.layers)))


def test_a_merged_layer_is_as_uncertain_as_the_less_certain_one() -> None:
    """Whichever of the two comes first."""
    card, _ = load("trtlab")
    first, second = card.layers
    sure = first.model_copy(update={"conductivity": first.conductivity.model_copy(update={"relative_sd": 0.05})})
    for pair in ((sure, second), (second, sure)):
        (layer,) = merged(card.model_copy(update={"layers": pair}), 1).layers
        assert layer.conductivity.relative_sd == 0.5


def test_every_run_is_drawn_and_has_its_picture(monkeypatch: pytest.MonkeyPatch) -> None:
    """More runs than colours; runs whose names differ only in signs."""
    card, _ = load("trtlab")
    times = np.arange(10.0)
    runs = {f"run {number}": (times, np.full((10, 1), float(number))) for number in range(12)}
    (axes,) = rig_figures.histories(card.phases, runs, ["outer"], dict.fromkeys(runs, 1.0)).axes
    lines = [line for line in axes.lines if line.get_label().startswith("run")]
    assert len({(line.get_color(), line.get_linestyle()) for line in lines}) == len(lines) == 12
    for name in ("residuals", "intervals", "correlation", "png"):
        monkeypatch.setattr(rig_figures, name, lambda *_: b"")
    named = SimpleNamespace(tests=[SimpleNamespace(name=name) for name in ("a b", "a-b", "ü")])
    assert {"residuals-a b.png", "residuals-a-b.png", "residuals-ü.png"} < set(rig_figures.pictures(named))


def test_layer_study_improves_with_the_true_layers(tmp_path: Path) -> None:
    """Two layers that differ much, fitted as one and as two: the second takes most of the misfit away."""
    card, _ = load("trtlab")
    short = card.phases.model_copy(update={"heating": 200.0, "cooling": 0.0})
    card = card.model_copy(update={"phases": short, "runs": {"high": card.runs["high"]}})
    coarse = Fineness(2, 5, 2)
    done = simulate(card, seed=1, values={"carcass.conductivity": 0.7}, fineness=coarse)
    tests = [matched(card, run, list(card.sensors)) for run in done.runs.values()]
    comparison = study(card, tests, (1, 2), coarse)
    single, two = comparison.table().to_dict("records")
    assert two["transient_misfit_K"] < 0.5 * single["transient_misfit_K"]
    assert two["log_evidence"] > single["log_evidence"] + 10
    # As in an identification: a single layer misses the readings, so it determines nothing.
    assert [(row["determined"], row["doubtful"] > 0) for row in (single, two)] == [(0, True), (3, False)]
    assert comparison.words == ("1 layer: doubtful: the model does not describe the readings",)
    assert {file.name for file in save_layers(comparison, tmp_path / "out").iterdir()} == {
        "layers.csv",
        "layers.png",
        "summary.json",
    }


def test_layer_study_is_a_command(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["rig", "layers", "mine.toml", "--most", "1", "--out", "out", "--json"]) == 0
    assert [row["layers"] for row in json.loads(capfd.readouterr().out)["rows"]] == [1]
    assert Path("out/layers.png").is_file()


@pytest.mark.parametrize(("command", "name"), [("identify", "residuals.csv"), ("layers", "layers.csv")])
def test_a_table_in_the_folder_of_results_is_never_replaced(
    here: Path, capfd: pytest.CaptureFixture[str], command: str, name: str
) -> None:
    table = here / "out" / name
    table.parent.mkdir()
    times = "".join(f"low,{t},22.0,22.0,22.0\n" for t in range(0, 320, 10))
    table.write_text(f"run,time [s],outer [degC],inner [degC],interface [degC]\n{times}", encoding="utf-8")
    before = table.read_bytes()
    assert main(["rig", command, "mine.toml", f"out/{name}", "--out", "out", "--force"]) == 2
    assert f"{name}: is an input of this command" in capfd.readouterr().err
    assert table.read_bytes() == before
