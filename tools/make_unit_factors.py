"""Write `tyrefem/quantity/factors.py`: pint's factors of the units that most files use."""

from __future__ import annotations

from pathlib import Path

from tyrefem.quantity import registry

PAGE = Path(__file__).resolve().parents[1] / "tyrefem" / "quantity" / "factors.py"
#: Unit of a card -> units as people write them. Temperatures (degC) are not here: they have an offset.
USUAL = {
    "1": "% percent",
    "m": "m km dm cm mm um nm in inch ft yd mi mile",
    "m**2": "m**2 cm**2 mm**2 in**2 ft**2",
    "m**3": "m**3 cm**3 mm**3 l L ml in**3",
    "1/m": "1/m 1/mm",
    "s": "s ms us min h hr day",
    "Hz": "Hz kHz 1/s",
    "kg": "kg g t lb lbs oz",
    "kg/m**3": "kg/m**3 g/cm**3 kg/l t/m**3 lb/ft**3 lb/in**3",
    "m/s": "m/s km/h kph mph ft/s in/s mm/s cm/s knot",
    "N": "N kN MN mN daN lbf kgf",
    "N*m": "N*m kN*m J lbf*ft ft*lbf",
    "N/m": "N/m N/mm kN/m kN/mm lbf/in",
    "Pa": "Pa hPa kPa MPa GPa bar mbar psi ksi atm N/mm**2 N/m**2",
    "Pa/s": "Pa/s kPa/s MPa/s",
    "rad": "rad deg degree degrees mrad",
    "delta_degC": "K delta_degC delta_degF kelvin mK",
    "delta_degC/s": "delta_degC/s K/s K/min",
    "1/delta_degC": "1/delta_degC 1/K",
    "W": "W mW kW MW hp J/s",
    "W/K": "W/K kW/K",
    "W/m/K": "W/m/K W/(m*K) W/m/delta_degC cal/cm/s/K mW/m/K",
    "W/m**2": "W/m**2 kW/m**2 W/cm**2",
    "W/m**3": "W/m**3 kW/m**3 MW/m**3",
    "W/m**2/K": "W/m**2/K W/(m**2*K) kW/m**2/K W/cm**2/K cal/cm**2/s/K",
    "W*s/m**3/K": "W*s/m**3/K J/m**3/K",
    "m**2*K/W": "m**2*K/W",
    "J/K": "J/K kJ/K",
    "J/kg/K": "J/kg/K J/(kg*K) kJ/kg/K J/g/K cal/g/K",
    "J/m**2": "J/m**2 kJ/m**2 N/m N/mm",
    "J/m**3": "J/m**3 kJ/m**3 MJ/m**3",
    "J/m**3/K": "J/m**3/K kJ/m**3/K MJ/m**3/K",
}


def text() -> str:
    """The module."""
    lines = [
        '"""Factors of the units that most files use. pint knows all others; it takes a fifth of a second to load.',
        "",
        "Written by tools/make_unit_factors.py from pint's own numbers.",
        '"""',
        "",
        "from __future__ import annotations",
        "",
        "#: 0 degC, K.",
        "KELVIN = 273.15",
        "#: Unit of a card -> unit as written -> factor.",
        "FACTORS: dict[str, dict[str, float]] = {",
    ]
    units = registry()
    for unit, names in USUAL.items():
        target = "dimensionless" if unit == "1" else unit
        factors = {
            name: float(units.Quantity(1.0, units.parse_units(name)).to(target).magnitude) for name in names.split()
        }
        entries = "".join(f'\n        "{name}": {factor!r},' for name, factor in factors.items())
        lines.append(f'    "{unit}": {{{entries}\n    }},')
    lines += [
        "}",
        "#: Temperature as written -> factor and offset of its value in degC.",
        'TEMPERATURES = {"degC": (1.0, 0.0), "degF": (5 / 9, -160 / 9), "K": (1.0, -KELVIN)}',
        "",
    ]
    return "\n".join(lines)


if __name__ == "__main__":
    PAGE.write_text(text(), encoding="utf-8")
