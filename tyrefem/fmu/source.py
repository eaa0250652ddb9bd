"""The numbers of one tyre as a C header."""

from __future__ import annotations

from typing import Any

import numpy as np

from tyrefem.realtime import GAMMA, INPUTS, LONGEST, PHI, PHI_2, STANDSTILL, RealTimeTyre


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
    lines += [f"#define {name} ({value!r})" for name, value in ((name, float(one)) for name, one in numbers.items())]
    tables = {
        "INPUT_START": [tyre.about["start"][name] for name in INPUTS],
        "BOX": list(tyre.box.values()),
        "EVEN": data["even"],
        "RATES": data["rates"],
        "CAPACITY": _some(data["capacity"]),
        "LUMPED_GIVEN": _some(~np.isnan(lumped)),
        "LUMPED_START": _some(np.nan_to_num(lumped)),
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
        "LAG": _some(data["lag"]),
        "HOT": data["hot"].reshape(-1, m),
        "PHI": PHI,
        "PHI_2": PHI_2,
    }
    lines += [_table(name, np.asarray(values, dtype=float)) for name, values in tables.items()]
    rows = ", ".join(str(int(row)) for row in data["loss_row"])
    lines.append(f"static const int LOSS_ROW[NSAMPLES] = {{{rows}}};")
    return "\n".join(lines) + "\n"


def _some(values: Any) -> Any:
    """C has no arrays of nothing."""
    return values if len(values) else np.zeros(1)


def _table(name: str, values: Any) -> str:
    shape = "".join(f"[{length}]" for length in values.shape)
    return f"static const double {name}{shape} = {_braced(values)};"


def _braced(values: Any) -> str:
    if values.ndim == 1:
        return "{" + ",\n".join(", ".join(map(repr, row)) for row in _lines(values.tolist())) + "}"
    return "{" + ",\n".join(_braced(one) for one in values) + "}"


def _lines(values: list[float], width: int = 8) -> list[list[float]]:
    return [values[k : k + width] for k in range(0, len(values), width)]
