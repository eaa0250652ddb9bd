"""Chosen variants of a sweep as VTK files: the variant's full run, in a folder of its name."""

from __future__ import annotations

from pathlib import Path

import pytest
import pyvista

import tyrefem as tf
from tyrefem.api import Design
from tyrefem.cli import main
from tyrefem.errors import InputError

QUICK = {"mesh.size": "12 mm", "drive.duration": "60 s", "output.fields": 2}


@pytest.fixture(scope="module")
def design() -> Design:
    return tf.study("nasa-22x5.5-8pr", QUICK).sweep({"drive.speed": ["10 mph", "20 mph"]}, reduced="never")


def test_a_chosen_variant_is_its_full_run(design: Design, tmp_path: Path) -> None:
    (name,) = design.to_vtk(tmp_path, [2])
    assert name == "2"
    file = tmp_path / "variants/2/nasa-22x5.5-8pr.pvd"
    reader = pyvista.get_reader(str(file))
    reader.set_active_time_value(reader.time_values[-1])
    hottest = design.table.set_index("variant")["hottest_degC"]["2"]
    assert reader.read()[0]["temperature_degC"].max() == pytest.approx(hottest, abs=0.05)
    assert "variant 2: drive.speed 20 mph" in file.with_suffix(".py").read_text(encoding="utf-8")
    result = design.run("2")
    assert result.peaks["tyre"].temperature == pytest.approx(hottest, abs=1e-6)
    assert result.study.data["drive"]["speed"] == "20 mph"


def test_by_default_those_on_the_front(design: Design, tmp_path: Path) -> None:
    front = set(design.pareto["variant"])
    assert set(design.to_vtk(tmp_path)) == front
    assert {path.name for path in (tmp_path / "variants").iterdir()} == front


def test_an_unknown_variant_is_refused_before_any_run(design: Design, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="variant: no variant '7'"):
        design.to_vtk(tmp_path, [1, 7])
    assert not list(tmp_path.iterdir())


def test_the_command_writes_them_and_removes_them_again(tmp_path: Path) -> None:
    sweep = ["sweep", "nasa-22x5.5-8pr", "--vary", "drive.speed=10 mph,20 mph", "--out", str(tmp_path / "out"),
             "--no-pictures", "--quiet", "--workers", "1", "--reduced", "never"]  # fmt: skip
    changes = [word for key, value in QUICK.items() for word in ("--set", f"{key}={value}")]
    assert main([*sweep, *changes, "--vtk", "1"]) == 0
    assert (tmp_path / "out/variants/1/nasa-22x5.5-8pr.pvd").is_file()
    assert main([*sweep, *changes]) == 0
    assert not (tmp_path / "out/variants").exists()


def test_the_command_refuses_an_unknown_variant_before_any_run(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    sweep = ["sweep", "nasa-22x5.5-8pr", "--vary", "drive.speed=10 mph,20 mph", "--out", str(out), "--vtk", "7"]
    assert main(sweep) == 2
    assert capfd.readouterr().err == "tyrefem: --vtk: no variant '7'; allowed: 1, 2, front\n"
    assert not out.exists()


def test_variants_of_like_names_have_each_a_folder(tmp_path: Path) -> None:
    """The folder of a variant is the same whichever variants are chosen."""
    (tmp_path / "list.csv").write_text("name,drive.speed\nA+1,10 mph\nA-1,20 mph\n", encoding="utf-8")
    design = tf.study("nasa-22x5.5-8pr", QUICK).sweep(sample="list", cases=str(tmp_path / "list.csv"), reduced="never")
    both = design.to_vtk(tmp_path, ["A+1", "A-1"])
    assert [path.parent.name for path in both.values()] == ["A-1", "A-1-2"]
    titles = [path.with_suffix(".py").read_text(encoding="utf-8") for path in both.values()]
    assert "variant A+1" in titles[0]
    assert "variant A-1" in titles[1]
    assert design.to_vtk(tmp_path / "one", ["A-1"])["A-1"].parent.name == "A-1-2"
