"""The forward model of the rig: readings of every sensor for given parameters, and their sensitivities."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.heating_test.card import RigCard, RunCard
from tyrefem.heating_test.clock import Clock
from tyrefem.heating_test.grid import USUAL, Fineness, PatchGrid
from tyrefem.heating_test.parameters import Parameters, RigParameter, at
from tyrefem.heating_test.patch import Patch, PatchLayer, Property
from tyrefem.heating_test.readings import view
from tyrefem.heating_test.sensitivity import Sensitivity

Array = NDArray[Any]
#: Allowed time-integration error, K: far below the cameras' noise.
TOLERANCE = 0.1
#: Parameters of sensors only, which need no new solution.
_VIEWS = ("spot_along", "spot_across", "depth", "lag", "offset", "gain")
#: Parameters of tables only: they shift the times at which a table has its readings, not the readings of a time.
_TABLES = ("clock",)


@dataclass(frozen=True, eq=False)
class Twin:
    """Forward model of a card's rig.

    Parameters
    ----------
    card : the rig.
    sensors : the sensors of the readings, in order.
    fineness : fineness of the mesh.
    """

    card: RigCard
    sensors: tuple[str, ...]
    fineness: Fineness = USUAL

    def patch(self, values: Mapping[str, float], run: RunCard) -> Patch:
        """The heated patch of a test."""
        card = self.card
        layers = tuple(
            PatchLayer(
                layer.name,
                max(values[f"{layer.name}.thickness"], 0.2 * layer.thickness),
                layer.density.value,
                *(
                    Property(
                        values[f"{layer.name}.{key}"], values[f"{layer.name}.{key}_slope"], layer.reference_temperature
                    )
                    for key in ("conductivity", "specific_heat")
                ),
            )
            for layer in card.layers
        )
        return Patch(
            layers,
            card.patch.radius,
            card.patch.curvature,
            card.laser.spot_diameter / 2,
            card.laser.profile,
            values["absorptance"] * run.power,
            card.surroundings.ambient if run.ambient is None else run.ambient,
            card.surroundings.characteristic_length,
            values["outer_film"],
            values["inner_film"],
            min(max(values["emissivity"], 0.0), 1.0),
        )

    def grid(self, values: Mapping[str, float]) -> PatchGrid:
        """The mesh for the layers' thicknesses; the latest meshes are cached."""
        return self.patch(values, next(iter(self.card.runs.values()))).grid(self.fineness)

    def fields(self, values: Mapping[str, float], run: RunCard, clock: Clock) -> Array:
        """Nodal temperatures of a test (computed times, unknowns), degC."""
        patch, grid = self.patch(values, run), self.grid(values)
        hot = patch.heated(grid, clock.heating, TOLERANCE).values
        if not clock.cooling.size:
            return hot
        off = np.concatenate([[0.0], clock.cooling])
        return np.concatenate([hot, patch.cooled(grid, off, hot[-1], TOLERANCE).values[1:]])

    def readings_of_fields(self, values: Mapping[str, float], clock: Clock, fields: Array) -> Array:
        """Readings of nodal temperatures without noise, (computed times, sensors), degC."""
        grid, columns = self.grid(values), []
        for name in self.sensors:
            row = view(name, self.card.sensors[name], grid, values)
            raw = np.asarray(fields @ row.T.toarray())[:, 0]
            rise = values[f"{name}.gain"] * (clock.lagged(raw, values.get(f"{name}.lag", 0.0)) - raw[0])
            columns.append(raw[0] + rise + values[f"{name}.offset"])
        return np.stack(columns, axis=1)

    def readings(self, values: Mapping[str, float], run: RunCard, clock: Clock) -> Array:
        """Readings of a test, (computed times, sensors), degC."""
        return self.readings_of_fields(values, clock, self.fields(values, run, clock))

    def slopes(self, parameters: Parameters, x: Array, run: RunCard, clock: Clock, fields: Array, base: Array) -> Array:
        """d readings / d coordinates, (computed times, sensors, parameters), for the fields at x; 0 of a clock."""
        values = parameters.values(x)
        out = np.zeros((*base.shape, len(parameters)))
        solved = [
            i
            for i, parameter in enumerate(parameters.free)
            if not (_only_seen(parameter) or _of_tables(parameter) or _thickness(parameter))
        ]
        names = tuple(parameters.free[i].name for i in solved)
        tangent = self._tangent(values, names, run, clock, fields)
        grid = self.grid(values)
        for column, name in enumerate(self.sensors):
            row = view(name, self.card.sensors[name], grid, values).toarray()[0]
            raw = np.einsum("tup,u->tp", tangent, row)
            for i, slope in zip(solved, clock.lagged(raw, values.get(f"{name}.lag", 0.0)).T, strict=True):
                parameter = parameters.free[i]
                out[:, column, i] = values[f"{name}.gain"] * slope * parameter.spread
        for i, parameter in enumerate(parameters.free):
            if i in solved or _of_tables(parameter):
                continue
            step = 0.05 if _only_seen(parameter) else 0.2
            moved = parameters.values(at(x, i, step))
            back = parameters.values(at(x, i, -step))
            if _only_seen(parameter):
                up, down = self.readings_of_fields(moved, clock, fields), self.readings_of_fields(back, clock, fields)
            else:
                up, down = self.readings(moved, run, clock), self.readings(back, run, clock)
            out[:, :, i] = (up - down) / (2 * step)
        return out

    def _tangent(
        self, values: Mapping[str, float], names: tuple[str, ...], run: RunCard, clock: Clock, fields: Array
    ) -> Array:
        sensitivity = Sensitivity(self.patch(values, run), self.grid(values), names)
        n = clock.heating.size
        hot = sensitivity.run(clock.heating, fields[:n], None, lit=True)
        if not clock.cooling.size:
            return hot
        off = np.concatenate([[0.0], clock.cooling])
        cold = sensitivity.run(off, fields[n - 1 :], hot[-1], lit=False)
        return np.concatenate([hot, cold[1:]])


def _only_seen(parameter: RigParameter) -> bool:
    return parameter.name.rpartition(".")[2] in _VIEWS


def _of_tables(parameter: RigParameter) -> bool:
    return parameter.name.rpartition(".")[2] in _TABLES


def _thickness(parameter: RigParameter) -> bool:
    return parameter.name.endswith(".thickness")
