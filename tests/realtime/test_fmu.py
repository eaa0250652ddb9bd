"""The FMU: valid to a public checker, the same numbers as the Python model, states that come back."""

from __future__ import annotations

import subprocess
import zipfile
from ctypes import CFUNCTYPE, c_char_p, c_int, c_void_p, cast
from dataclasses import astuple

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from fmpy.validation import validate_fmu

from tyrefem.errors import InputError
from tyrefem.realtime.fmu import variable_names, write_fmu
from tyrefem.realtime.tyre import INPUTS, Inputs, RealTimeTyre

HELD = (
    Inputs(10.0, 12e3, 560e3, 20.0, 30.0),
    Inputs(0.0, 10e3, 560e3, 25.0, 35.0),
    Inputs(4.0, 9.5e3, 530e3, 12.0, 15.0),
)


@pytest.fixture(scope="module")
def unit(needs_compiler, exported, tmp_path_factory):
    return write_fmu(exported.file, tmp_path_factory.mktemp("fmu") / "tyre.fmu")


@pytest.fixture
def slave(unit, tmp_path):
    description = fmpy.read_model_description(str(unit))
    folder = fmpy.extract(str(unit), str(tmp_path))
    instance = FMU2Slave(
        guid=description.guid, unzipDirectory=folder, modelIdentifier="tyre", instanceName="one", fmiCallLogger=None
    )
    instance.instantiate()
    instance.setupExperiment(startTime=0.0)
    instance.enterInitializationMode()
    instance.exitInitializationMode()
    yield instance
    instance.freeInstance()


def test_a_public_checker_finds_nothing(unit):
    assert validate_fmu(str(unit)) == []
    description = fmpy.read_model_description(str(unit))
    assert [variable.name for variable in description.modelVariables if variable.causality == "input"] == list(INPUTS)
    assert {variable.unit for variable in description.modelVariables if variable.causality == "input"} == {
        "m/s",
        "N",
        "Pa",
        "degC",
    }
    assert description.coSimulation.canGetAndSetFMUstate


def test_variables_have_names_of_their_own(exported):
    tyre = RealTimeTyre(exported.file)
    tyre.names = ["speed", "a-b", "a_b", "a b", "time", "outside", "hottest"]
    names = variable_names(tyre)
    assert names == ["speed_2", "a_b", "a_b_2", "a_b_3", "time_2", "outside_2", "hottest"]


def test_it_gives_the_numbers_of_the_python_model(unit, exported):
    """Simulated by fmpy, inputs held for 20 s each."""
    tyre = RealTimeTyre(exported.file)
    count = 20 * len(HELD)
    signal = np.zeros(2 * count, dtype=[("time", float), *((name, float) for name in INPUTS)])
    expected = []
    tyre.reset(18.0)
    for k in range(count):
        inputs = HELD[k // 20]
        expected.append(tyre.step(1.0, inputs))
        for row, time in ((2 * k, k), (2 * k + 1, k + 1)):
            signal[row] = (time, *astuple(inputs))
    names = variable_names(tyre)
    outputs = fmpy.simulate_fmu(
        str(unit),
        stop_time=float(count),
        output_interval=1.0,
        input=signal,
        output=names,
        start_values={"initial_temperature": 18.0, **dict(zip(INPUTS, astuple(HELD[0]), strict=True))},
    )
    # fmpy's result at a jump of the input may be of either side: pressure and drag are of the last step's inputs.
    for name, column in zip(names, np.array(expected).T, strict=True):
        np.testing.assert_allclose(outputs[name][1:], column, rtol=1e-9, atol=1e-9)


def test_states_come_back(slave):
    references = list(range(10, 17))
    slave.setReal(list(range(5)), list(astuple(HELD[0])))
    for k in range(3):
        slave.doStep(float(k), 1.0)
    kept = slave.getFMUstate()
    stored = slave.serializeFMUstate(kept)
    ends = []
    for _ in range(3):
        slave.setReal(list(range(5)), list(astuple(HELD[2])))
        for k in range(4):
            slave.doStep(float(k), 0.7)
        ends.append(slave.getReal(references))
        slave.setFMUstate(kept if len(ends) == 1 else slave.deSerializeFMUstate(stored))
    assert ends[0] == ends[1] == ends[2]


def test_derivatives_of_inputs_are_followed(slave, exported):
    tyre = RealTimeTyre(exported.file)
    tyre.reset(20.0)
    slave.setReal([5], [20.0])
    first, slope = np.array(astuple(HELD[2])), np.array([0.1, 50.0, 1e3, 0.3, 0.5])
    for k in range(6):
        now, later = first + slope * 7 * k, first + slope * 7 * (k + 1)
        expected = tyre.step(7.0, Inputs(*now.tolist()), Inputs(*later.tolist()))
        slave.setReal(list(range(5)), now.tolist())
        slave.setRealInputDerivatives(list(range(5)), [1] * 5, slope.tolist())
        slave.doStep(7.0 * k, 7.0)
        np.testing.assert_allclose(slave.getReal(list(range(10, 10 + len(expected)))), expected, rtol=1e-10)


def test_outside_the_box_is_an_error_or_the_edge(slave):
    slave.setReal([0], [40.0])
    with pytest.raises(Exception, match="fmi2DoStep"):
        slave.doStep(0.0, 1.0)
    with pytest.raises(Exception, match="fmi2SetReal"):
        slave.setReal([5], [float("nan")])
    slave.setBoolean([6], [True])
    slave.doStep(0.0, 1.0)
    assert slave.getInteger([7]) == [1]
    at_edge = slave.getReal([10])
    slave.reset()
    slave.setReal([0], [12.0])
    slave.doStep(0.0, 1.0)
    assert slave.getReal([10]) == at_edge
    assert slave.getInteger([7]) == [0]


def test_an_input_outside_the_box_is_told_in_the_units_of_the_description(unit, tmp_path):
    description = fmpy.read_model_description(str(unit))
    kinds = {variable.name: variable.unit for variable in description.modelVariables}
    instance = FMU2Slave(
        guid=description.guid,
        unzipDirectory=fmpy.extract(str(unit), str(tmp_path)),
        modelIdentifier="tyre",
        instanceName="one",
        fmiCallLogger=None,
    )
    messages: list[str] = []

    def log(_environment, _name, _status, _category, _format, text):
        messages.append(text.decode())

    # The message is the argument of the format "%s".
    formatted = CFUNCTYPE(None, c_void_p, c_char_p, c_int, c_char_p, c_char_p, c_char_p)(log)
    callbacks = fmi2CallbackFunctions()
    callbacks.logger = cast(formatted, fmi2CallbackLoggerTYPE)
    instance.instantiate(callbacks=callbacks, loggingOn=True)
    for number, (name, value) in enumerate(zip(INPUTS, (40.0, 1e9, 1e9, 999.0, -999.0), strict=True)):
        instance.setReal(list(range(5)), list(astuple(HELD[0])))
        instance.setReal([number], [value])
        with pytest.raises(Exception, match="fmi2DoStep"):
            instance.doStep(0.0, 1.0)
        assert messages[-1].startswith(f"{name} = {value:.7g} {kinds[name]} is outside ")
        assert messages[-1].endswith(f" {kinds[name]}, the certified range")
    # What is no number has no edge, also where inputs are moved to theirs.
    instance.setBoolean([6], [True])
    instance.setReal([0], [np.nan])
    with pytest.raises(Exception, match="fmi2DoStep"):
        instance.doStep(0.0, 1.0)
    assert messages[-1].endswith(f" {kinds['speed']}, the certified range")
    instance.freeInstance()


def test_the_source_compiles_without_a_warning(unit, tmp_path):
    with zipfile.ZipFile(unit) as packed:
        packed.extractall(tmp_path)
    flags = ["-std=c99", "-O0", "-Wall", "-Wextra", "-Werror", "-pedantic", "-fsyntax-only"]
    done = subprocess.run(
        ["cc", *flags, str(tmp_path / "sources" / "tyre.c")], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


def test_a_compiler_that_fails_is_said(exported, tmp_path):
    with pytest.raises(InputError, match="failed"):
        write_fmu(exported.file, tmp_path / "no.fmu", compiler="false")
    assert not (tmp_path / "no.fmu").exists()
    with pytest.raises(InputError, match="is not a real-time model"):
        write_fmu(__file__, tmp_path / "no.fmu")


def test_a_compiler_may_write_in_any_encoding(exported, tmp_path):
    compiler = tmp_path / "cc.sh"
    compiler.write_bytes(b"#!/bin/sh\nprintf 'nicht unterst\\374tzt' >&2\nexit 1\n")
    compiler.chmod(0o755)
    with pytest.raises(InputError, match=r"failed: nicht unterst.tzt"):
        write_fmu(exported.file, tmp_path / "no.fmu", compiler=str(compiler))
