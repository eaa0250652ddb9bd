"""Rig data made differently from how they are analysed: hexahedra on a doubly curved patch, BDF2, another air.

Half of a patch of torus shells (circumferential and lateral radius differ), triquadratic elements, the spot off the
cameras' mark, implicit-explicit BDF2 in time, air from a table. Nothing here uses the library's solver or its air.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import skfem
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import splu

#: Air at 1 atm from 250 K to 600 K (Incropera & DeWitt, table A.4): k W/m/K, nu m2/s, Pr.
AIR_T = np.array([250.0, 300.0, 350.0, 400.0, 450.0, 500.0, 550.0, 600.0])
AIR_K = np.array([22.3, 26.3, 30.0, 33.8, 37.3, 40.7, 43.9, 46.9]) * 1e-3
AIR_NU = np.array([11.44, 15.89, 20.92, 26.41, 32.39, 38.79, 45.57, 52.69]) * 1e-6
AIR_PR = np.array([0.720, 0.707, 0.700, 0.690, 0.686, 0.684, 0.683, 0.685])
SIGMA = 5.67e-8


@dataclass(frozen=True)
class TrueLayer:
    """What a layer really is: k and c linear in T about 60 degC."""

    thickness: float
    density: float
    k: float
    c: float
    k_slope: float = 0.0
    c_slope: float = 0.0

    def conductivity(self, T: Any) -> Any:
        """W/m/K."""
        return self.k * (1 + self.k_slope * (T - 60.0))

    def capacity(self, T: Any) -> Any:
        """J/m3/K."""
        return self.density * self.c * (1 + self.c_slope * (T - 60.0))


@dataclass(frozen=True)
class Truth:
    """One case: the tyre, the rig as it really stands, and its instruments' errors."""

    layers: tuple[TrueLayer, ...]
    absorptance: float = 0.95
    emissivity: float = 0.95
    films: tuple[float, float] = (1.0, 1.0)
    ambient: float = 22.0
    length: float = 0.1
    radii: tuple[float, float] = (0.30, 0.25)
    spot_radius: float = 5e-3
    spot_offset: float = 0.0
    offset_along: bool = True
    window: float = 2e-3
    depth: float = 8e-3
    lag: float = 2.0
    biases: tuple[float, float, float] = (0.0, 0.0, 0.0)
    noise: tuple[float, float, float] = (0.1, 0.1, 0.5)
    phases: tuple[float, float, float] = (60.0, 1050.0, 550.0)
    half_width: float = 0.05
    lines: tuple[float, ...] = field(default=(0.0, 2.5, 5.0, 7.5, 12.0, 23.0))
    per_layer: int = 3


def film(T: np.ndarray, ambient: float, length: float) -> np.ndarray:
    """W/m2/K: Churchill & Chu's vertical plate with the tabulated air."""
    mean = (T + ambient) / 2 + 273.15
    k, nu, Pr = (np.interp(mean, AIR_T, column) for column in (AIR_K, AIR_NU, AIR_PR))
    Ra = 9.81 * np.abs(T - ambient) * length**3 * Pr / (mean * nu**2)
    return k / length * (0.825 + 0.387 * Ra ** (1 / 6) / (1 + (0.492 / Pr) ** 0.5625) ** (8 / 27)) ** 2


class CurvedPatch:
    """Matrices of one truth; `readings` integrates a power."""

    def __init__(self, truth: Truth) -> None:
        self.truth = t = truth
        half = np.append(np.array(t.lines) * 1e-3, t.half_width)
        whole = np.concatenate([-half[:0:-1], half])
        depths = [0.0]
        for number, layer in enumerate(t.layers):
            share = np.linspace(0, 1, t.per_layer + 1)[1:]
            depths += list(depths[-1] + layer.thickness * (share**1.6 if number == 0 else share))
        x, y = (whole, half) if t.offset_along else (half, whole)
        straight = skfem.MeshHex.init_tensor(x, y, np.array(depths))
        self.depths = np.array(depths)
        element = skfem.ElementHex2()
        self.places = skfem.Basis(straight, element, intorder=1).doflocs
        mesh = skfem.MeshHex(self.bent(straight.p), straight.t)
        middle = straight.p[2, straight.t].mean(axis=0)
        borders = np.concatenate([[0.0], np.cumsum([part.thickness for part in t.layers])])
        self.n = self.places.shape[1]
        self.volumes = []
        for layer, a, b in zip(t.layers, borders, borders[1:], strict=False):
            basis = skfem.Basis(mesh, element, elements=np.flatnonzero((middle > a) & (middle < b)), intorder=4)
            self.volumes.append((layer, *self._matrices(basis), basis.dx.reshape(-1)))
        ends = straight.p[2, straight.facets]
        top = np.flatnonzero((ends < 1e-9).all(axis=0))
        bottom = np.flatnonzero((ends > depths[-1] - 1e-9).all(axis=0))
        self.faces = []
        for facets, factor in ((top, t.films[0]), (bottom, t.films[1])):
            basis = skfem.FacetBasis(mesh, element, facets=facets, intorder=4)
            self.faces.append((self._matrices(basis)[0], basis.dx.reshape(-1), factor))
        # Disc edges cut elements: many small squares per facet.
        m = (np.arange(14) + 0.5) / 14
        points = np.stack([a.ravel() for a in np.meshgrid(m, m)])
        fine = [
            skfem.FacetBasis(mesh, element, facets=f, quadrature=(points, np.full(196, 1 / 196))) for f in (top, bottom)
        ]
        self.beam, self.cameras = self._beam(fine[0]), [self._camera(part) for part in fine]
        self.couple = self._thermocouple()

    def bent(self, p: np.ndarray) -> np.ndarray:
        """Shells of a torus about the tyre's axis; the spot's mark at the origin, depth along -Z."""
        (R1, R2), (x, y, d) = self.truth.radii, p
        rho = R1 - R2 + (R2 - d) * np.cos(y / R2)
        return np.stack([rho * np.sin(x / R1), (R2 - d) * np.sin(y / R2), rho * np.cos(x / R1) - R1])

    def _matrices(self, basis: Any) -> tuple[csr_matrix, list[csr_matrix]]:
        """Value and, in volumes, slopes at the quadrature points."""
        dofs, shape = basis.element_dofs, basis.dx.shape
        columns = np.repeat(dofs.T[:, None, :], shape[1], axis=1).reshape(-1)
        rows = np.arange(0, columns.size + 1, dofs.shape[0])

        def matrix(parts: list[np.ndarray]) -> csr_matrix:
            local = np.stack([np.broadcast_to(part, shape) for part in parts], axis=-1)
            return csr_matrix((local.reshape(-1), columns, rows), (rows.size - 1, self.n))

        value = matrix([np.asarray(b[0]) for b in basis.basis])
        return value, [matrix([b[0].grad[i] for b in basis.basis]) for i in range(3)]

    def _beam(self, basis: Any) -> np.ndarray:
        """Load of 1 W on the whole disc, along -Z on the curved face."""
        x = np.asarray(basis.global_coordinates())
        centre = (self.truth.spot_offset, 0.0) if self.truth.offset_along else (0.0, self.truth.spot_offset)
        inside = np.hypot(x[0] - centre[0], x[1] - centre[1]) < self.truth.spot_radius
        weight = (inside * basis.normals[2] * basis.dx).reshape(-1)
        return self._matrices(basis)[0].T @ weight * (0.5 / weight.sum())

    def _camera(self, basis: Any) -> np.ndarray:
        x = np.asarray(basis.global_coordinates())
        weight = ((np.hypot(x[0], x[1]) < self.truth.window) * basis.dx).reshape(-1)
        return self._matrices(basis)[0].T @ weight / weight.sum()

    def _thermocouple(self) -> np.ndarray:
        axis = np.flatnonzero((np.abs(self.places[0]) < 1e-9) & (np.abs(self.places[1]) < 1e-9))
        axis = axis[np.argsort(self.places[2, axis])]
        d = self.truth.depth
        e = int(np.clip(np.searchsorted(self.depths, d) - 1, 0, self.depths.size - 2))
        u = (d - self.depths[e]) / (self.depths[e + 1] - self.depths[e])
        weights = np.zeros(self.n)
        weights[axis[2 * e : 2 * e + 3]] = [(1 - u) * (1 - 2 * u), 4 * u * (1 - u), u * (2 * u - 1)]
        return weights

    def _mass(self, T: np.ndarray) -> csr_matrix:
        return sum(V.T @ (V.multiply((w * layer.capacity(V @ T))[:, None])).tocsr() for layer, V, _, w in self.volumes)

    def _stiffness(self, T: np.ndarray) -> csr_matrix:
        total = sum(
            G.T @ (G.multiply((w * layer.conductivity(V @ T))[:, None])).tocsr()
            for layer, V, slopes, w in self.volumes
            for G in slopes
        )
        for V, w, factor in self.faces:
            h = factor * 4.0 + 4 * self.truth.emissivity * SIGMA * (np.clip(V @ T, 20, 80) + 273.15) ** 3
            total = total + V.T @ (V.multiply((w * h)[:, None])).tocsr()
        return total

    def _flow(self, T: np.ndarray) -> np.ndarray:
        """Heat that leaves every unknown, W: conduction, convection, radiation."""
        t = self.truth
        out = np.zeros(self.n)
        for layer, V, slopes, w in self.volumes:
            k = w * layer.conductivity(V @ T)
            for G in slopes:
                out += G.T @ (k * (G @ T))
        for V, w, factor in self.faces:
            Ts = V @ T
            q = factor * film(Ts, t.ambient, t.length) * (Ts - t.ambient)
            q = q + t.emissivity * SIGMA * ((Ts + 273.15) ** 4 - (t.ambient + 273.15) ** 4)
            out += V.T @ (w * q)
        return out

    def _phase(self, T: np.ndarray, load: np.ndarray, duration: float) -> tuple[np.ndarray, np.ndarray]:
        """Variable-step BDF2; what the linear part S leaves out of the flow is extrapolated."""
        blocks = [(0.1, 2.0), (0.4, 10.0), (2.0, 60.0), (6.0, 300.0), (15.0, np.inf)]
        times, states = [0.0], [T]
        S = self._stiffness(T)
        before, N_before, dt_before = T, S @ T - self._flow(T), 0.0
        slow = any(layer.c_slope for layer, *_ in self.volumes)
        M = self._mass(T)
        for dt, end in blocks:
            end = min(end, duration)
            count = round((end - times[-1]) / dt + 0.49) if end > times[-1] else 0
            if not count:
                continue
            dt = (end - times[-1]) / count
            S_new = self._stiffness(T)
            N_before = N_before + (S_new - S) @ before
            S = S_new
            solver: dict[float, Any] = {}
            M = self._mass(T) if slow else M
            for _ in range(count):
                N = S @ T - self._flow(T)
                w = dt / dt_before if dt_before else 0.0
                a = (1 + 2 * w) / (1 + w) / dt
                if a not in solver:
                    solver = {
                        a: splu(
                            (a * M + S).tocsc(),
                            permc_spec="MMD_AT_PLUS_A",
                            diag_pivot_thresh=0.0,
                            options={"SymmetricMode": True},
                        )
                    }
                old = (1 + w) / dt * T - w**2 / (1 + w) / dt * before
                right = M @ old + load + (1 + w) * N - w * N_before
                if slow:  # the heat capacity's change over the step, by its own extrapolated temperature
                    guess = T + w * (T - before)
                    right -= (self._mass(guess) - M) @ (a * guess - old)
                before, T, N_before, dt_before = T, solver[a].solve(right), N, dt
                times.append(times[-1] + dt)
                states.append(T)
        return np.array(times), np.array(states)

    def clean(self, power: float, times: np.ndarray) -> np.ndarray:
        """(n, 3) temperatures of outer camera, inner camera, thermocouple without noise."""
        t, (idle, heating, cooling) = self.truth, self.truth.phases
        start = np.full(self.n, t.ambient)
        on, hot = self._phase(start, power * t.absorptance * self.beam, heating)
        off, cold = self._phase(hot[-1], np.zeros(self.n), cooling) if cooling else (np.zeros(1), hot[-1:])
        clock = np.concatenate([[-1.0, idle], idle + on[1:], idle + heating + off[1:]])
        views = np.stack([*self.cameras, self.couple], axis=1)
        seen = np.concatenate([np.full((2, 3), t.ambient), hot[1:] @ views, cold[1:] @ views])
        seen[:, 2] = lagged(clock, seen[:, 2], t.lag)
        return np.stack([np.interp(times, clock, column) for column in seen.T], axis=1)

    def readings(self, power: float, times: np.ndarray, rng: np.random.Generator) -> np.ndarray:
        """(n, 3) readings with bias and noise."""
        clean = self.clean(power, times)
        return clean + np.array(self.truth.biases) + rng.normal(size=clean.shape) * np.array(self.truth.noise)


def lagged(times: np.ndarray, values: np.ndarray, lag: float) -> np.ndarray:
    """First-order lag by implicit Euler on the given times."""
    out = values.copy()
    for i in range(1, len(times)):
        share = (times[i] - times[i - 1]) / (lag + times[i] - times[i - 1])
        out[i] = out[i - 1] + share * (values[i] - out[i - 1])
    return out
