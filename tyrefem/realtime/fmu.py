"""A real-time model as an FMU (FMI 2.0, co-simulation): modelDescription.xml, C source, and a compiled library.

The importing tool needs neither Python nor numpy. `write_fmu` makes the FMU from a file of `tyrefem export`.
"""

from __future__ import annotations

import hashlib
import json
import platform
import shutil
import subprocess
import sys
import tempfile
import zipfile
from datetime import UTC, datetime
from itertools import chain, count
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np

import tyrefem
from tyrefem.errors import InputError
from tyrefem.output import atomic_path
from tyrefem.output.file import MARK
from tyrefem.realtime.tyre import GAMMA, INPUTS, LONGEST, PHI, PHI_2, STANDSTILL, RealTimeTyre

#: Name of the library in the FMU.
IDENTIFIER = "tyre"


#: Value references: inputs from 0 on; as in tyre.c.
INITIAL, CLAMP, OUTSIDE, OUTPUT = 5, 6, 7, 10
MEANINGS = {
    "speed": "speed of the wheel's axle",
    "load": "vertical load",
    "pressure": "cold gauge pressure, at the temperature of the start",
    "ambient": "ambient air",
    "road_temperature": "road",
}
_UNITS = {
    "m/s": 'm="1" s="-1"',
    "N": 'kg="1" m="1" s="-2"',
    "Pa": 'kg="1" m="-1" s="-2"',
    "degC": 'K="1" offset="273.15"',
}


def variable_names(tyre: RealTimeTyre) -> list[str]:
    """Names of the outputs in the FMU, in the order of `tyre.names`; hyphens and spaces become underscores.

    A name that another variable has gets a number: an importing tool finds variables by their names.
    """
    taken, names = {*INPUTS, "time", "initial_temperature", "clamp", "outside"}, []
    for output in tyre.names:
        plain = output.replace("-", "_").replace(" ", "_")
        name = next(each for each in chain([plain], (f"{plain}_{k}" for k in count(2))) if each not in taken)
        taken.add(name)
        names.append(name)
    return names


def description(tyre: RealTimeTyre, guid: str) -> str:
    """The text of modelDescription.xml."""
    variables = [
        _real(k, name, "input", unit, MEANINGS[name], tyre.about["start"][name], tyre.box[name])
        for k, (name, unit) in enumerate(INPUTS.items())
    ]
    start = tyre.about["initial"]
    variables.append(
        f'<ScalarVariable name="initial_temperature" valueReference="{INITIAL}" causality="parameter" '
        f'variability="fixed" initial="exact" description="of everything at the start"><Real unit="degC" '
        f'start="{start!r}"/></ScalarVariable>'
    )
    variables.append(
        f'<ScalarVariable name="clamp" valueReference="{CLAMP}" causality="parameter" variability="fixed" '
        'initial="exact" description="inputs outside the certified box: move them to its edge, in place of an error">'
        '<Boolean start="false"/></ScalarVariable>'
    )
    variables.append(
        f'<ScalarVariable name="outside" valueReference="{OUTSIDE}" causality="output" variability="discrete" '
        'initial="calculated" description="number of inputs that were moved to the edge of the box"><Integer/>'
        "</ScalarVariable>"
    )
    for k, (name, output) in enumerate(zip(variable_names(tyre), tyre.about["outputs"], strict=True)):
        variables.append(_real(OUTPUT + k, name, "output", output["unit"], output["what"]))
    outputs = "".join(f'<Unknown index="{k + 1}"/>' for k in range(len(INPUTS) + 2, len(variables)))
    units = "".join(f"<Unit name={quoteattr(name)}><BaseUnit {base}/></Unit>" for name, base in _UNITS.items())
    certificate = tyre.about.get("certificate", {})
    words = f"{tyre.about['title']}; largest error against full runs {certificate.get('worst', float('nan')):.3g} K"
    now = datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName={quoteattr(str(tyre.about["study"]))} guid="{guid}"
  description={quoteattr(words)} generationTool="tyrefem {tyrefem.__version__}" generationDateAndTime="{now}"
  variableNamingConvention="flat">
<CoSimulation modelIdentifier="{IDENTIFIER}" canHandleVariableCommunicationStepSize="true" canInterpolateInputs="true"
  canGetAndSetFMUstate="true" canSerializeFMUstate="true" canNotUseMemoryManagementFunctions="true">
<SourceFiles><File name="tyre.c"/></SourceFiles>
</CoSimulation>
<UnitDefinitions>{units}</UnitDefinitions>
<LogCategories><Category name="logStatusWarning"/><Category name="logStatusError"/></LogCategories>
<DefaultExperiment startTime="0" stopTime="{certificate.get("duration", 600.0)!r}" stepSize="1"/>
<ModelVariables>
{chr(10).join(variables)}
</ModelVariables>
<ModelStructure><Outputs>{outputs}</Outputs><InitialUnknowns>{outputs}</InitialUnknowns></ModelStructure>
</fmiModelDescription>
"""


def _real(
    reference: int,
    name: str,
    causality: str,
    unit: str,
    what: str,
    start: float | None = None,
    between: tuple[float, float] | None = None,
) -> str:
    limits = "" if start is None else f' start="{float(start)!r}"'
    if between is not None and between[1] > between[0]:
        limits += f' min="{between[0]!r}" max="{between[1]!r}"'
    initial = ' initial="calculated"' if causality == "output" else ""
    return (
        f'<ScalarVariable name={quoteattr(name)} valueReference="{reference}" causality="{causality}" '
        f'variability="continuous"{initial} description={quoteattr(what)}><Real unit={quoteattr(unit)}{limits}/>'
        "</ScalarVariable>"
    )


def data_header(tyre: RealTimeTyre, guid: str) -> str:
    """Text of ``tyre_data.h``: sizes as macros, tables as static constants."""
    data = tyre.arrays
    lumped, gas = data["lumped_start"], data["gas"]
    sizes = {
        "M": len(data["rates"]),
        "N": len(data["rates"]) + len(data["capacity"]),
        "NSAMPLES": len(data["loss_row"]),
        "NEXCHANGES": len(data["exchange"]),
        "NSENSORS": len(data["read"]),
        "NREAD": max(len(data["read"]), 1),
        "NHOT": len(data["hot"]),
        "NLOSS": data["loss_table"].shape[1],
        "NPHI": len(PHI),
        "NPHI_2": len(PHI_2),
        "HAS_GAS": int(len(gas) > 0),
    }
    numbers = {
        "HELD": float(data["held"]),
        "INITIAL_TEMPERATURE": float(tyre.about["initial"]),
        "LOSS_COLD": data["loss_axis"][0],
        "LOSS_PER_KELVIN": 1 / data["loss_axis"][1],
        "GAMMA": GAMMA,
        "LONGEST": LONGEST,
        "STANDSTILL": STANDSTILL,
    }
    m, n = sizes["M"], sizes["N"]
    lines = ["/* Written by tyrefem export: the numbers of one tyre, SI units and degC. */", f'#define GUID "{guid}"']
    lines += [f"#define {name} {value}" for name, value in sizes.items()]
    lines += [
        f"#define {name} ({value!r})" for name, value in ((name, float(number)) for name, number in numbers.items())
    ]
    tables = {
        "INPUT_START": [tyre.about["start"][name] for name in INPUTS],
        "BOX": list(tyre.box.values()),
        "EVEN": data["even"],
        "RATES": data["rates"],
        "CAPACITY": _at_least_one(data["capacity"]),
        "LUMPED_GIVEN": _at_least_one(~np.isnan(lumped)),
        "LUMPED_START": _at_least_one(np.nan_to_num(lumped)),
        "GAS": gas if len(gas) else np.zeros(2),
        "EXCHANGE": data["exchange"].reshape(-1, n * n),
        "EXCHANGE_LOAD": data["exchange_load"],
        "SINK": data["sink"],
        "FILM_STANDING": data["film_standing"],
        "FILM_AXES": data["film_axes"],
        "FILM_TABLE": data["film_table"].ravel(),
        "BEND_AXES": data["bend_axes"],
        "BEND_TABLE": data["bend_table"].ravel(),
        "HEAT_AXES": data["heat_axes"],
        "HEAT_TABLE": data["heat_table"].ravel(),
        "AT_SAMPLES": data["at_samples"],
        "HEATING": data["heating"],
        "POWER": data["power"],
        "LOSS": data["loss_table"],
        "READ": data["read"] if len(data["read"]) else np.zeros((1, n)),
        "LAG": _at_least_one(data["lag"]),
        "HOT": data["hot"].reshape(-1, m),
        "PHI": PHI,
        "PHI_2": PHI_2,
    }
    lines += [_table(name, np.asarray(values, dtype=float)) for name, values in tables.items()]
    rows = ", ".join(str(int(row)) for row in data["loss_row"])
    lines.append(f"static const int LOSS_ROW[NSAMPLES] = {{{rows}}};")
    return "\n".join(lines) + "\n"


def _at_least_one(values: Any) -> Any:
    """The values, or a zero if there are none: C has no empty arrays."""
    return values if len(values) else np.zeros(1)


def _table(name: str, values: Any) -> str:
    shape = "".join(f"[{length}]" for length in values.shape)
    return f"static const double {name}{shape} = {_braced(values)};"


def _braced(values: Any) -> str:
    if values.ndim == 1:
        return "{" + ",\n".join(", ".join(map(repr, row)) for row in _lines(values.tolist())) + "}"
    return "{" + ",\n".join(_braced(value) for value in values) + "}"


def _lines(values: list[float], width: int = 8) -> list[list[float]]:
    return [values[k : k + width] for k in range(0, len(values), width)]


#: C compilers that are tried, in this order.
COMPILERS = ("cc", "gcc", "clang")
_SYSTEMS = {"linux": ("linux", ".so"), "darwin": ("darwin", ".dylib"), "win32": ("win", ".dll")}


def write_fmu(model: str | Path, path: str | Path, *, compiler: str | None = None) -> Path:
    """Write an FMU of a real-time model.

    Parameters
    ----------
    model : ``.npz`` file of `tyrefem export`. path : ``.fmu`` file. compiler : a C compiler; default: the first of
        `COMPILERS` that is installed. Without a compiler the FMU holds the C source only, and the importing tool
        compiles it.

    Raises
    ------
    InputError : the file is not a real-time model, or the compiler failed.
    """
    try:
        tyre = RealTimeTyre(model)
    except (ValueError, OSError) as error:
        raise InputError(str(error)) from None
    path = Path(path)
    guid = hashlib.sha256(Path(model).read_bytes()).hexdigest()[:32]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        sources = folder / "sources"
        sources.mkdir()
        shutil.copy(Path(__file__).with_name("tyre.c"), sources / "tyre.c")
        (sources / "tyre_data.h").write_text(data_header(tyre, guid), encoding="ascii")
        (folder / "modelDescription.xml").write_text(description(tyre, guid), encoding="utf-8")
        (folder / "resources").mkdir()
        (folder / "resources" / "about.json").write_text(json.dumps(tyre.about, indent=1), encoding="utf-8")
        compiler = compiler or next((program for program in COMPILERS if shutil.which(program)), None)
        if compiler is not None:
            _compiled(compiler, folder)
        with atomic_path(path) as temporary, zipfile.ZipFile(temporary, "w", zipfile.ZIP_DEFLATED) as packed:
            for file in sorted(folder.rglob("*")):
                if file.is_file():
                    packed.write(file, file.relative_to(folder).as_posix())
            packed.comment = MARK
    return path


def _compiled(compiler: str, folder: Path) -> None:
    system, suffix = _SYSTEMS.get(sys.platform, ("linux", ".so"))
    place = folder / "binaries" / f"{system}{64 if sys.maxsize > 2**32 else 32}"
    if platform.machine().lower() not in ("x86_64", "amd64", "i386", "i686"):
        # FMI 2.0 defines these folders for x86 only: on other machines the importing tool compiles.
        return
    place.mkdir(parents=True)
    command = [compiler, "-std=c99", "-O3", "-shared", "-fPIC", "-fvisibility=hidden", "-o"]
    command += [str(place / f"{IDENTIFIER}{suffix}"), str(folder / "sources" / "tyre.c"), "-lm"]
    try:
        # A compiler's messages may be in any encoding.
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)
    except OSError as error:
        raise InputError(f"'{compiler}' cannot be run: {error.strerror or error}") from None
    if done.returncode:
        raise InputError(f"'{compiler}' failed: {done.stderr.strip()[-300:]}")
