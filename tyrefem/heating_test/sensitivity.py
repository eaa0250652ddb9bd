"""Sensitivities of a test's temperature field to its parameters: one linear problem for all parameters.

With enthalpy h(u; p), heat flow f(u; p) and laser load F(p) of the nodes, d/dt h + f = F gives for s = du/dp

    d/dt (C s + h_p) + A s + f_p = F_p,   C = dh/du,  A = df/du,

integrated by the trapezoidal rule over the computed times. Their steps grow by a constant factor after the switch, so
every mode is resolved until it has decayed, and the rule does not oscillate.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import diags
from scipy.sparse.linalg import splu

from tyrefem.heating_test.grid import PatchGrid
from tyrefem.heating_test.patch import Patch, PatchLayer, natural_film

Array = NDArray[Any]

SIGMA, ABSOLUTE = 5.67e-8, 273.15


class Sensitivity:
    """Sensitivities of a patch on its grid.

    Parameters
    ----------
    names : parameters of the derivatives: ``LAYER.conductivity``, ``LAYER.specific_heat``, ``absorptance``,
        ``outer_film``, ``inner_film`` (p d/dp), ``LAYER.conductivity_slope``, ``LAYER.specific_heat_slope``,
        ``emissivity`` (d/dp).
    """

    def __init__(self, patch: Patch, grid: PatchGrid, names: tuple[str, ...]) -> None:
        self.patch, self.grid, self.ops, self.names = patch, grid, grid.operators, names
        self.layers = {layer.name: (layer, self.ops.quadrature(layer.name)) for layer in patch.layers}
        self.faces = {name: self.ops.surface(name) for name in ("outer", "inner")}
        self.films = {"outer": patch.outer_film, "inner": patch.inner_film}
        self.straight = all(layer.conductivity.slope == layer.specific_heat.slope == 0 for layer in patch.layers)
        where, flux = patch.beam(grid)
        spot = self.ops.surface(where)
        self.load = np.zeros(self.ops.size)
        self.load[spot.dofs] = spot.trace_t @ (spot.weight * flux)

    def run(self, times: Array, fields: Array, start: Array | None, *, lit: bool) -> Array:
        """Sensitivities (n_times, unknowns, parameters) of a history; `start` (unknowns, parameters) at times[0]."""
        s = np.zeros((self.ops.size, len(self.names))) if start is None else start
        out = [s]
        matrices, (h0, f0) = self._matrices(fields[0]), self._parts(fields[0], lit=lit)
        right = self._apply(matrices, s, -0.5 * (times[1] - times[0]))
        for i, dt in enumerate(np.diff(times), 1):
            matrices, (h1, f1) = self._matrices(fields[i]), self._parts(fields[i], lit=lit)
            s = self._solve(matrices, 0.5 * dt, right - (h1 - h0) - 0.5 * dt * (f0 + f1))
            out.append(s)
            h0, f0 = h1, f1
            if i + 1 < len(times):
                right = self._apply(matrices, s, -0.5 * (times[i + 1] - times[i]))
        return np.array(out)

    def _apply(self, matrices: tuple[Array, Array, Any], s: Array, dt: float) -> Array:
        C, S, skew = matrices
        product = self.ops.matrix(C + dt * S) @ s
        return np.asarray(product if skew is None else product + dt * (skew @ s))

    def _solve(self, matrices: tuple[Array, Array, Any], dt: float, right: Array) -> Array:
        C, S, skew = matrices
        if skew is None:
            return np.asarray(self.ops.ordering(np.arange(self.ops.size)).factor(C + dt * S).solve(right))
        return np.asarray(splu((self.ops.matrix(C + dt * S) + dt * skew).tocsc()).solve(right))

    def _loss(self, T: Array) -> tuple[Array, Array]:
        """Convection with a factor of 1, and radiation of a black face, W/m2."""
        p = self.patch
        film = natural_film(T, p.ambient, p.length) * (T - p.ambient)
        return film, SIGMA * ((T + ABSOLUTE) ** 4 - (p.ambient + ABSOLUTE) ** 4)

    def _matrices(self, u: Array) -> tuple[Array, Array, Any]:
        """Values of C and of the symmetric part of A on the operators' pattern, and the rest of A."""
        C, S = np.zeros(self.ops.nnz), np.zeros(self.ops.nnz)
        skew: Any = None
        for layer, q in self.layers.values():
            if self.straight:
                C += self.ops.mass(layer.name) * (layer.density * layer.specific_heat.value)
                for data in self.ops.conduction(layer.name, None):
                    S += data * layer.conductivity.value
                continue
            T = q.value @ u
            C += q.mass @ (layer.density * layer.specific_heat(T))
            k = layer.conductivity(T)
            for scatter, slope, back in zip(q.conduction, q.slopes, q.slopes_t, strict=True):
                S += scatter @ k
                if layer.conductivity.slope:
                    dk = layer.conductivity.value * layer.conductivity.slope
                    part = back @ diags(q.weight * dk * (slope @ u)) @ q.value
                    skew = part if skew is None else skew + part
        for name, face in self.faces.items():
            T = face.trace @ u[face.dofs]
            up, down = self._loss(T + 0.05), self._loss(T - 0.05)
            film, black = ((a - b) / 0.1 for a, b in zip(up, down, strict=True))
            where, value = face.exchange(self.films[name] * film + self.patch.emissivity * black)
            np.add.at(S, where, value)
        return C, S, skew

    def _parts(self, u: Array, *, lit: bool) -> tuple[Array, Array]:
        """Derivatives of enthalpy and of flow minus load, (unknowns, parameters)."""
        h, f = np.zeros((2, self.ops.size, len(self.names)))
        for column, name in enumerate(self.names):
            owner, _, key = name.rpartition(".")
            if owner:
                self._of_layer(*self.layers[owner], key, u, h[:, column], f[:, column])
            elif name == "absorptance":
                if lit:
                    f[:, column] = -self.load
            else:
                self._of_faces(name, u, f[:, column])
        return h, f

    def _of_layer(self, layer: PatchLayer, q: Any, key: str, u: Array, h: Array, f: Array) -> None:
        T = q.value @ u
        prop = layer.conductivity if key.startswith("conductivity") else layer.specific_heat
        away = T - prop.reference
        if key.startswith("conductivity"):
            dk = prop.value * away if key.endswith("slope") else prop(T)
            for slope, back in zip(q.slopes, q.slopes_t, strict=True):
                f += back @ (q.weight * dk * (slope @ u))
            return
        heat = away**2 / 2 if key.endswith("slope") else away + prop.slope * away**2 / 2
        h += q.value.T @ (q.weight * layer.density * prop.value * heat)

    def _of_faces(self, name: str, u: Array, f: Array) -> None:
        for side, face in self.faces.items():
            if name in ("emissivity", f"{side}_film"):
                convection, black = self._loss(face.trace @ u[face.dofs])
                q = black if name == "emissivity" else self.films[side] * convection
                f[face.dofs] += face.trace_t @ (face.weight * q)
