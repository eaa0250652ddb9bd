"""The Magic Formula 6.1 of pure slip: forces and aligning moment of a tyre by coefficients with standard names."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from tyrefem.brief import Brief
from tyrefem.errors import InputError, nearest

#: Coefficients by section of a `.tir` file, in the order of the standard; combined slip and turn slip are left out.
TABLES = {
    "LONGITUDINAL": "PCX1 PDX1 PDX2 PDX3 PEX1 PEX2 PEX3 PEX4 PKX1 PKX2 PKX3 PHX1 PHX2 PVX1 PVX2 PPX1 PPX2 PPX3 PPX4",
    "LATERAL": "PCY1 PDY1 PDY2 PDY3 PEY1 PEY2 PEY3 PEY4 PEY5 PKY1 PKY2 PKY3 PKY4 PKY5 PKY6 PKY7 PHY1 PHY2 PVY1 PVY2 "
    "PVY3 PVY4 PPY1 PPY2 PPY3 PPY4 PPY5",
    "ALIGNING": "QBZ1 QBZ2 QBZ3 QBZ4 QBZ5 QBZ9 QBZ10 QCZ1 QDZ1 QDZ2 QDZ3 QDZ4 QDZ6 QDZ7 QDZ8 QDZ9 QDZ10 QDZ11 QEZ1 "
    "QEZ2 QEZ3 QEZ4 QEZ5 QHZ1 QHZ2 QHZ3 QHZ4 PPZ1 PPZ2",
}
NAMES = {part: tuple(text.split()) for part, text in TABLES.items()}
ALL = tuple(name for names in NAMES.values() for name in names)
#: Keeps divisions finite where force or stiffness vanish, N and N/rad.
TINY = 1e-6


@dataclass(frozen=True, eq=False)
class MagicFormula(Brief):
    """Pure slip by the Magic Formula 6.1 (Pacejka 2012, equations 4.E9 to 4.E49), without scaling factors.

    F = D sin(C arctan(B x - E (B x - arctan B x))) + S_V, x = slip or angle + S_H, B = K / (C D);
    M_z = -t F_y(camber 0) + M_r, trail t = D_t cos(C_t arctan(B_t x - E_t (B_t x - arctan B_t x))).

    Axes and signs are those of `ForcePoints` (ISO-W): the cornering stiffness K_y is negative.

    Parameters
    ----------
    coefficients : by name (`NAMES`); those that are not given are zero.
    nominal_load : F_z0, N. nominal_pressure : Pa. radius : unloaded radius R_0, m.

    Raises
    ------
    InputError : an unknown coefficient; a nominal value that is not positive.

    >>> tyre = MagicFormula({"PCY1": 1.3, "PDY1": 1.0, "PKY1": -20.0, "PKY2": 1.5, "PKY4": 2.0}, 4000.0, 2.2e5, 0.31)
    >>> round(tyre.cornering_stiffness(4000.0)), round(tyre.lateral_force(4000.0, 0.05))
    (-73846, -2877)
    """

    coefficients: Mapping[str, float]
    nominal_load: float
    nominal_pressure: float
    radius: float
    _known: dict[str, float] = field(default_factory=dict, init=False, repr=False)

    def __post_init__(self) -> None:
        for name in self.coefficients:
            if name not in ALL:
                raise InputError(f"no coefficient '{name}' of the Magic Formula{nearest(name, ALL)}", field=name)
        for name in ("nominal_load", "nominal_pressure", "radius"):
            if not getattr(self, name) > 0:
                raise InputError("must be positive", field=name)
        self._known.update(dict.fromkeys(ALL, 0.0) | {name: float(v) for name, v in self.coefficients.items()})

    def _relative(self, load: Any, pressure: Any) -> tuple[Any, Any]:
        """dfz and dpi; without a pressure the nominal one."""
        dpi = 0.0 if pressure is None else np.asarray(pressure) / self.nominal_pressure - 1
        return np.asarray(load, dtype=float) / self.nominal_load - 1, dpi

    def slip_stiffness(self, load: Any, pressure: Any = None) -> Any:
        """K_x = dF_x/dslip at zero slip, N."""
        p, (dfz, dpi) = self._known, self._relative(load, pressure)
        by_load = (p["PKX1"] + p["PKX2"] * dfz) * np.exp(p["PKX3"] * dfz)
        return np.asarray(load) * by_load * (1 + p["PPX1"] * dpi + p["PPX2"] * dpi**2)

    def longitudinal_force(self, load: Any, slip: Any, camber: Any = 0.0, pressure: Any = None) -> Any:
        """F_x, N, at zero slip angle."""
        p, (dfz, dpi) = self._known, self._relative(load, pressure)
        load = np.asarray(load, dtype=float)
        x = np.asarray(slip) + p["PHX1"] + p["PHX2"] * dfz
        friction = (p["PDX1"] + p["PDX2"] * dfz) * (1 + p["PPX3"] * dpi + p["PPX4"] * dpi**2)
        peak = friction * (1 - p["PDX3"] * np.asarray(camber) ** 2) * load
        bend = (p["PEX1"] + p["PEX2"] * dfz + p["PEX3"] * dfz**2) * (1 - p["PEX4"] * np.sign(x))
        shift = load * (p["PVX1"] + p["PVX2"] * dfz)
        return _magic(x, self.slip_stiffness(load, pressure), p["PCX1"], peak, bend) + shift

    def cornering_stiffness(self, load: Any, camber: Any = 0.0, pressure: Any = None) -> Any:
        """K_y = dF_y/dalpha at zero angle, N/rad; negative."""
        p, (_, dpi) = self._known, self._relative(load, pressure)
        camber = np.asarray(camber)
        knee = (p["PKY2"] + p["PKY5"] * camber**2) * (1 + p["PPY2"] * dpi)
        rise = np.sin(p["PKY4"] * np.arctan2(np.asarray(load) / self.nominal_load, knee))
        return p["PKY1"] * self.nominal_load * (1 + p["PPY1"] * dpi) * (1 - p["PKY3"] * np.abs(camber)) * rise

    def _lateral(self, load: Any, slip_angle: Any, camber: Any, pressure: Any) -> tuple[Any, Any, Any, Any]:
        """F_y, N; its shifts S_Hy, S_Vy; the slope B_y C_y."""
        p, (dfz, dpi) = self._known, self._relative(load, pressure)
        load, camber = np.asarray(load, dtype=float), np.asarray(camber, dtype=float)
        stiffness = self.cornering_stiffness(load, camber, pressure)
        thrust = load * (p["PVY3"] + p["PVY4"] * dfz) * camber
        by_camber = load * (p["PKY6"] + p["PKY7"] * dfz) * (1 + p["PPY5"] * dpi) * camber
        across = p["PHY1"] + p["PHY2"] * dfz + (by_camber - thrust) / (stiffness + np.copysign(TINY, stiffness))
        x = np.asarray(slip_angle) + across
        friction = (p["PDY1"] + p["PDY2"] * dfz) * (1 + p["PPY3"] * dpi + p["PPY4"] * dpi**2)
        peak = friction * (1 - p["PDY3"] * camber**2) * load
        turn = 1 + p["PEY5"] * camber**2 - (p["PEY3"] + p["PEY4"] * camber) * np.sign(x)
        bend = (p["PEY1"] + p["PEY2"] * dfz) * turn
        up = load * (p["PVY1"] + p["PVY2"] * dfz) + thrust
        return _magic(x, stiffness, p["PCY1"], peak, bend) + up, across, up, stiffness / (peak + TINY)

    def lateral_force(self, load: Any, slip_angle: Any, camber: Any = 0.0, pressure: Any = None) -> Any:
        """F_y, N, at zero slip."""
        return self._lateral(load, slip_angle, camber, pressure)[0]

    def trail(self, load: Any, slip_angle: Any, camber: Any = 0.0, pressure: Any = None) -> Any:
        """Pneumatic trail t, m: M_z = -t F_y + M_r, F_y without camber."""
        q, (dfz, dpi) = self._known, self._relative(load, pressure)
        load, camber = np.asarray(load, dtype=float), np.asarray(camber, dtype=float)
        x = np.asarray(slip_angle) + q["QHZ1"] + q["QHZ2"] * dfz + (q["QHZ3"] + q["QHZ4"] * dfz) * camber
        slope = (q["QBZ1"] + q["QBZ2"] * dfz + q["QBZ3"] * dfz**2) * (
            1 + q["QBZ4"] * camber + q["QBZ5"] * np.abs(camber)
        )
        size = load * self.radius / self.nominal_load * (q["QDZ1"] + q["QDZ2"] * dfz) * (1 - q["PPZ1"] * dpi)
        size = size * (1 + q["QDZ3"] * np.abs(camber) + q["QDZ4"] * camber**2)
        turn = 1 + (q["QEZ4"] + q["QEZ5"] * camber) * 2 / np.pi * np.arctan(slope * q["QCZ1"] * x)
        bend = np.minimum((q["QEZ1"] + q["QEZ2"] * dfz + q["QEZ3"] * dfz**2) * turn, 1.0)
        angle = slope * x
        return size * np.cos(q["QCZ1"] * np.arctan(angle - bend * (angle - np.arctan(angle)))) * np.cos(slip_angle)

    def aligning_moment(self, load: Any, slip_angle: Any, camber: Any = 0.0, pressure: Any = None) -> Any:
        """M_z, N m, at zero slip.

        The trail is the lever of the force without camber (4.E32): what camber adds to the force has the residual M_r.
        """
        q, (dfz, dpi) = self._known, self._relative(load, pressure)
        load, camber = np.asarray(load, dtype=float), np.asarray(camber, dtype=float)
        _, across, up, slope = self._lateral(load, slip_angle, camber, pressure)
        upright = self.lateral_force(load, slip_angle, 0.0, pressure)
        stiffness = self.cornering_stiffness(load, camber, pressure)
        x = np.asarray(slip_angle) + across + up / (stiffness + np.copysign(TINY, stiffness))
        by_camber = (q["QDZ8"] + q["QDZ9"] * dfz) * (1 + q["PPZ2"] * dpi)
        by_camber = by_camber + (q["QDZ10"] + q["QDZ11"] * dfz) * np.abs(camber)
        size = q["QDZ6"] + q["QDZ7"] * dfz + by_camber * camber
        residual = load * self.radius * size * np.cos(np.arctan((q["QBZ9"] + q["QBZ10"] * slope) * x))
        return -self.trail(load, slip_angle, camber, pressure) * upright + residual * np.cos(slip_angle)


def _magic(x: Any, stiffness: Any, shape: Any, peak: Any, bend: Any) -> Any:
    """D sin(C arctan(B x - E (B x - arctan B x))), E at most 1."""
    bx = stiffness / (shape * peak + TINY) * x
    return peak * np.sin(shape * np.arctan(bx - np.minimum(bend, 1.0) * (bx - np.arctan(bx))))
