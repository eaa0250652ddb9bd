"""A tyre that has one temperature: alike everywhere, conducting as nothing does, cooled by nothing."""

from __future__ import annotations

from typing import Any

import tyrefem as tf

REGIONS = ("carcass", "tread", "sidewall", "bead")
RATE = 0.01


def rubber(**changes: Any) -> dict[str, Any]:
    return {
        "base": "nasa-tread",
        "conductivity": {"value": "1e4 W/m/K", "source": "test"},
        "loss_tangent": {"law": "constant", "value": 0.2},
        **changes,
    }


def softening() -> dict[str, Any]:
    return {"softening": {"rate": f"{RATE} 1/delta_degC", "at": "25 degC", "source": "test"}}


def lumped(feedback: dict[str, Any] | None, card: dict[str, Any], **drive: str) -> tf.Study:
    """U = 40 kJ/m3 in every region at 12 kN, 572 kPa and 25 degC."""
    energy = {
        "load": "12 kN",
        "pressure": "572 kPa",
        "temperature": "25 degC",
        "source": "test",
        "regions": dict.fromkeys(REGIONS, "40 kJ/m**3"),
    }
    changes: dict[str, Any] = {
        "mesh.size": "12 mm",
        "mesh.through": 1,
        "mesh.element": "P1",
        "materials": dict.fromkeys(REGIONS, card),
        "mechanics.strain": "given",
        "mechanics.energy": energy,
        "boundaries.outside_air": {"law": "constant", "coefficient": "0 W/m**2/K"},
        "boundaries.road": {"law": "constant", "coefficient": "0 W/m**2/K", "fraction": 0},
        "boundaries.rim": {"law": "fixed", "contact_resistance": "1e12 m**2*K/W"},
        "boundaries.contained_air": {"law": "gas", "film": "1e6 W/m**2/K"},
        "drive.pressure": "572 kPa",
        "numerics.tolerance": "0.002 delta_degC",
        "output.every": "45 s",
    }
    if feedback is not None:
        changes["mechanics.feedback"] = feedback
    return tf.study("nasa-22x5.5-8pr").replace(changes).with_drive(drive)
