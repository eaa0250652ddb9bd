"""`tyrefem export`: refusals before any work, and what the box is without being asked."""

from __future__ import annotations

from dataclasses import astuple

import fmpy
import numpy as np
import pytest

import tyrefem
from tyrefem.cli import main
from tyrefem.errors import InputError
from tyrefem.realtime.certificate import export
from tyrefem.realtime.fmu import variable_names, write_fmu
from tyrefem.realtime.inputs import box_of
from tyrefem.realtime.settings import ExportSettings, TablePoints
from tyrefem.realtime.tyre import INPUTS, Inputs, RealTimeTyre

pytestmark = pytest.mark.fast

STUDY = "nasa-22x5.5-8pr"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--out", "tyre.txt"], "must end with .npz"),
        (["--speed", "1:2:3"], "is not FROM:TO"),
        (["--speed", "30 mph:10 mph"], "--speed: must be from a lower to a higher value, not 30 mph to 10 mph"),
        (["--speed", "0 mph:2000 mph"], "--speed: 2000 mph: '894.08 m/s' is out of range: must be at most 400 m/s"),
        (["--load", "-1 kN:10 kN"], "tyrefem: --load: must be positive, not -1 kN to 10 kN"),
        (["--pressure", "20 degC:30 degC"], "pressure"),
        (
            ["--load", "10 kN:200 kN", "--set", "mesh.size=12 mm"],
            "tyrefem: --load: 1.05e+05 N at 572.3 kPa deflects",
        ),
        (
            ["--pressure", "0 bar:1 bar", "--set", "mesh.size=12 mm"],
            "tyrefem: --pressure: 1.051e+04 N at 50 kPa: a",
        ),
        (["--tolerance", "0 K"], "must be positive"),
        (["--set", "mechanics.feedback.pressure=true"], "feedback"),
        (["--set", "drive.slip_ratio=0.1"], "slip"),
    ],
)
def test_bad_input_ends_with_2_and_one_line(arguments, message, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["export", STUDY, *arguments]) == 2
    errors = capsys.readouterr().err
    assert errors.count("\n") == 1
    assert message in errors
    assert list(tmp_path.iterdir()) == []


def test_the_box_without_being_asked():
    study = tyrefem.study(STUDY)
    ranges = box_of(study).ranges
    speed = study.card.drive.phases[0].speed.start
    assert ranges["speed"] == pytest.approx((0.0, 1.5 * speed))
    assert ranges["ambient"] == pytest.approx((5.0, 45.0))
    with pytest.raises(InputError, match="did you mean 'speed'"):
        box_of(study, {"sped": (0.0, 1.0)})
    with pytest.raises(InputError, match="deflection"):
        box_of(study.replace({"drive.deflection": "1 in"}))
    assert box_of(study, {"load": np.array([1e4, 1.2e4])}).ranges["load"] == (1e4, 1.2e4)


@pytest.mark.parametrize("given", [None, (None, 3.0), ([1.0], [2.0]), (True, 5e3), {"from": 1e4, "to": 2e4}])
def test_what_is_no_range_names_its_input(given):
    with pytest.raises(InputError, match=r"^load: "):
        box_of(tyrefem.study(STUDY), {"load": given})


@pytest.mark.parametrize("drive", [{}, {"drive.camber": "2 deg"}, {"drive.torque": "-100 N m"}])
def test_the_friction_of_a_rolling_tyre_is_refused_before_any_work(drive, tmp_path):
    changes = {"mesh.section": "full", "mechanics.motion": "linear", "boundaries.sliding": "rolling"}
    study = tyrefem.study("passenger-205-55r16", changes | drive)
    with pytest.raises(InputError, match="no friction of a rolling tyre"):
        export(study, tmp_path / "tyre.npz")


def test_effects_on_the_heat_are_refused(tmp_path):
    study = tyrefem.study(STUDY, {"mesh.size": "12 mm", "effects": [{"name": "standing-wave", "gain": 1.0}]})
    with pytest.raises(InputError, match="effects"):
        export(study, tmp_path / "tyre.npz")


OVER_TEMPERATURE = [["20 degC", "0.30 W/m/K"], ["100 degC", "0.25 W/m/K"]]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"drive.slip_angle": "2 deg"}, "drive: a real-time model has no slip, torque or camber: remove 'slip_angle'"),
        ({"mechanics.feedback.pressure": True}, "mechanics.feedback: a real-time model has no feedback"),
        ({"effects": [{"name": "sun", "absorbed": "200 W/m**2"}]}, "effects.sun: gives heat to a surface; a real-time"),
        ({"effects": [{"name": "radiation", "emissivity": 0.5}]}, "effects.radiation: radiates"),
        ({"effects": [{"name": "standing-wave", "gain": 1.0}]}, "effects.standing-wave: changes the heat source"),
        (
            {"materials.tread": {"base": "nasa-tread", "conductivity": {"table": OVER_TEMPERATURE}}},
            "materials.tread.conductivity: depends on temperature; a real-time model has a single value",
        ),
        (
            {"materials.tread": "rubber-tread-passenger-frequency"},
            "materials.tread.loss_tangent: depends on frequency; in a real-time model",
        ),
    ],
)
def test_what_the_file_tells_is_refused_before_any_run(changes, message, tmp_path, monkeypatch):
    """It came after the training runs, as "Flux at 'road'": on a footprint by finite elements, after many minutes."""
    monkeypatch.setattr("tyrefem.realtime.certificate._Training", pytest.fail)
    monkeypatch.setattr("tyrefem.realtime.box_model.Training", pytest.fail)
    study = tyrefem.study(STUDY, {"mesh.size": "12 mm", **changes})
    for refused in (lambda: export(study, tmp_path / "tyre.npz"), study.explore):
        with pytest.raises(InputError) as error:
            refused()
        assert message in str(error.value)


def test_a_box_without_width_no_sensors_held_air_and_a_tolerance_that_cannot_be_met(needs_compiler, tmp_path):
    settings = ExportSettings(TablePoints(5, 4, 4), training=1, fresh=1, rounds=1)
    held = {"law": "held", "temperature": "35 degC"}
    changes = {"mesh.size": "12 mm", "mesh.through": 1, "sensors": {}, "boundaries.contained_air": held}
    study = tyrefem.study(STUDY, changes)
    ranges = {"load": ("12 kN",), "pressure": ("560 kPa",), "ambient": (20.0, 20.0)}
    with pytest.raises(InputError, match="the error in the validation runs is"):
        export(study, tmp_path / "no.npz", ranges=ranges, duration=40.0, tolerance=0.01, settings=settings)
    assert not (tmp_path / "no.npz").exists()
    certificate = export(study, tmp_path / "tyre.npz", ranges=ranges, duration=40.0, tolerance=1.0, settings=settings)
    assert certificate.worst < 1.0
    tyre = RealTimeTyre(tmp_path / "tyre.npz")
    assert tyre.names == ["contained-air", "hottest", "gas_pressure", "rolling_resistance"]
    inputs = Inputs(8.0, 12e3, 560e3, 20.0, 30.0)
    ends = [tyre.step(1.0, inputs) for _ in range(20)][-1]
    assert ends[0] == 35.0
    assert ends[2] == pytest.approx(560e3)
    unit = str(write_fmu(tmp_path / "tyre.npz", tmp_path / "tyre.fmu"))
    start = dict(zip(INPUTS, astuple(inputs), strict=True))
    run = fmpy.simulate_fmu(unit, stop_time=20.0, output_interval=1.0, start_values=start, output=variable_names(tyre))
    np.testing.assert_allclose(list(run[-1])[1:], ends, rtol=1e-9)
