"""modelDescription.xml of a real-time model: FMI 2.0, co-simulation."""

from __future__ import annotations

from datetime import UTC, datetime
from xml.sax.saxutils import quoteattr

import tyrefem
from tyrefem.realtime import INPUTS, RealTimeTyre

#: Name of the library in the FMU.
IDENTIFIER = "tyre"
#: Value references: inputs from 0 on; as in tyre.c.
INITIAL, CLAMP, OUTSIDE, OUTPUT = 5, 6, 7, 10
WHAT = {
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
    """Names of the outputs in the FMU, in the order of `tyre.names`: hyphens, which some tools refuse, made _."""
    return [name.replace("-", "_").replace(" ", "_") for name in tyre.names]


def description(tyre: RealTimeTyre, guid: str) -> str:
    """The XML text."""
    variables = [
        _real(k, name, "input", unit, WHAT[name], tyre.about["start"][name], tyre.box[name])
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
    for k, (name, one) in enumerate(zip(variable_names(tyre), tyre.about["outputs"], strict=True)):
        variables.append(_real(OUTPUT + k, name, "output", one["unit"], one["what"]))
    outputs = "".join(f'<Unknown index="{k + 1}"/>' for k in range(len(INPUTS) + 2, len(variables)))
    units = "".join(f"<Unit name={quoteattr(name)}><BaseUnit {base}/></Unit>" for name, base in _UNITS.items())
    certificate = tyre.about.get("certificate", {})
    said = f"{tyre.about['title']}; largest error against full runs {certificate.get('worst', float('nan')):.3g} K"
    now = datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName={quoteattr(str(tyre.about["study"]))} guid="{guid}"
  description={quoteattr(said)} generationTool="tyrefem {tyrefem.__version__}" generationDateAndTime="{now}"
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
