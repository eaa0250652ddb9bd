"""The equation of heat conduction: its weak form, and the system of ordinary differential equations made of it.

In the body, T(x, t) in degC obeys C dT/dt = div(k grad T) + q with C = rho c in J/m3/K, k in W/m/K, q in W/m3. Heat
enters through its surface. Multiplied by a test function v and integrated by parts, for every v:

    int C dT/dt v dV + int k grad T . grad v dV + sum_films int h (T - T_sink) v dA
        = int q v dV + sum_fluxes int q_s v dA + sum_radiation int eps sigma (T_s^4 - T^4) v dA

An axisymmetric body is a full ring, dV = 2 pi r dr dz and dA = 2 pi r ds; a planar one is a metre deep. A film has
h in W/m2/K and a sink: a given temperature, or a reservoir (contained air, a rim). A reservoir's temperature T_g is a
further unknown, with the heat capacity C_g in J/K and

    C_g dT_g/dt = sum_films int h (T - T_g) dA + sum_j G_j (T_j - T_g) + P_g,      G_j in W/K, P_g in W.

Additional states (wear, water) follow dz/dt = rate(t, z, T). They are in g, after the reservoirs.

With T = sum_j u_j(t) phi_j(x) and v = phi_i the equation becomes the `System` that all solvers of this package use:

    M du/dt = -S u + B g + G(t, u, g),        M_ij = int C phi_i phi_j dV,    S_ij = int k grad phi_i . grad phi_j dV
    C dg/dt = B^T u - D g + Gg(t, u, g)              + sum_films int h phi_i phi_j dA,        B_ig = int h phi_i dA

S, B and D, in W/K, hold the linear part, frozen at one state: k(T) at that temperature, a time-dependent film with its
h at that time, radiation and natural convection with their slope -dq/dT. G and Gg, in W, hold the exact remainder.
Frozen numbers thus change the speed of a solver, never its result. A source is interpolated between its nodal values.
Prescribed temperatures (`Fixed`) remove their rows from the system.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import bmat, csr_matrix
from skfem import BilinearForm
from skfem.helpers import dot, grad

from tyrefem.conduction.conditions import Reservoir
from tyrefem.conduction.function_space import FunctionSpace
from tyrefem.conduction.terms import Added, Boundary, Load, State, Storage

Array = NDArray[Any]


@BilinearForm
def storage(T, v, w):  # type: ignore[no-untyped-def]
    """Heat capacity: C v T dV for C = 1."""
    return v * T


@BilinearForm
def conduction(T, v, w):  # type: ignore[no-untyped-def]
    """Conduction along the unit vectors d, k (d . grad v) (d . grad T) dV for k = 1; both directions add up."""
    return dot(w.d, grad(v)) * dot(w.d, grad(T))


@BilinearForm
def exchange(T, v, w):  # type: ignore[no-untyped-def]
    """A film: h v T dA for h = 1."""
    return v * T


class System:
    """M du/dt = -S u + B g + G(t, u, g);  C dg/dt = B^T u - D g + Gg(t, u, g).

    Parameters
    ----------
    space : the function space; all operators have its sparsity pattern of `nnz` values.
    regions : the heat capacities. stiffness : (nnz,) int k grad v . grad T dV of constant conductivities.
    acting : all other terms. reservoirs : name -> `Reservoir`.
    lines : number of lines in the ledger of powers. added : states with a rate, in g after the reservoirs.
    """

    def __init__(
        self,
        space: FunctionSpace,
        regions: Sequence[Storage],
        stiffness: Array,
        acting: Sequence[Load],
        reservoirs: Mapping[str, Reservoir],
        lines: int,
        added: Added | None = None,
    ) -> None:
        self.space, self.regions, self.K0, self.acting = space, regions, stiffness, acting
        self.reservoirs, self.lines, self.version, self.added = reservoirs, lines, 0, added
        self.m = len(reservoirs) + (0 if added is None else added.initial.size)
        self._shown: Array | None = None
        self.variable_capacity = not all(region.constant for region in regions)
        self.moving = [load for load in acting if not load.static]

    def assemble(self, t: float, y: State) -> None:
        """Evaluate M, S, B, C and D at a state: new numbers on the common pattern without new integrals."""
        self.show(y.g)
        if self.variable_capacity or not self.version:
            self.M_data = self.mass(y.u)
            self.M = self.space.matrix(self.M_data)
        self.C = self.reservoir_capacity(y.g)
        self.S_data = self.K0.copy()
        self.B, self.D = np.zeros((self.space.size, self.m)), np.zeros((self.m, self.m))
        for load in self.acting:
            load.freeze(t, y, self)
        self.S = self.space.matrix(self.S_data)
        self.constant = self.zeros()
        self.add(self.constant, t, y, [load for load in self.acting if load.static])
        self.version += 1

    def mass(self, u: Array) -> Array:
        """Operator values of M at the temperatures u."""
        return np.sum([region.mass(u) for region in self.regions], axis=0)

    def reservoir_capacity(self, g: Array) -> Array:
        """C of every reservoir at its temperature, J/K; 1 for added states."""
        heat = [r.heat_capacity for r in self.reservoirs.values()]
        C = [float(c(T)) if callable(c) else float(c) for c, T in zip(heat, g, strict=False)]
        return np.array(C + [1.0] * (self.m - len(heat)))

    def show(self, g: Array) -> None:
        """Pass the added states in g to the loads; required before every evaluation of a load."""
        if self.added is None:
            return
        z = g[len(self.reservoirs) :] * self.added.scale
        self.added.show(z)
        if self._shown is None or not np.array_equal(z, self._shown):
            self._shown = z
            for load in self.acting:
                load.clear_cache()

    def add_conduction(self, values: Array) -> None:
        """Add int k grad v . grad T dV of a region."""
        self.S_data += values

    def add_film(self, boundary: Boundary, h: Any, reservoir: int | None = None) -> Array:
        """Add int h (T - T_g) v dA with reservoir T_g, or without T_g if it is no unknown; return int h v dA, W/K."""
        np.add.at(self.S_data, *boundary.exchange(h))
        row = boundary.load(h)
        if reservoir is not None:
            self.B[boundary.dofs, reservoir] += row
            self.D[reservoir, reservoir] += row.sum()
        return row

    def add_conductance(self, G: float, i: int, j: int | None = None) -> None:
        """Add G (T_i - T_j) for reservoirs i and j, or without T_j if it is no unknown."""
        self.D[i, i] += G
        if j is not None:
            self.D[j, j] += G
            self.D[i, j] -= G
            self.D[j, i] -= G

    def zeros(self) -> tuple[Array, Array, Array]:
        """Zeros for G (n,), Gg (m,) and the power of every line of the ledger."""
        return np.zeros(self.space.size), np.zeros(self.m), np.zeros(self.lines)

    def add(self, total: tuple[Array, Array, Array], t: float, y: State, loads: Iterable[Load]) -> None:
        """Add the remainders of loads, which the linear part does not contain, to (G, Gg, powers)."""
        self.show(y.g)
        G, Gg, P = total
        for load in loads:
            power = load.remainder(t, y, G, Gg)
            if load.slot != -1:
                P[load.slot] += power

    def remainder(self, t: float, y: State) -> tuple[Array, Array, Array]:
        """Remainder G (n,) and Gg (m,) beside the frozen part, and the power of every line of the ledger, W."""
        G, Gg, P = self.constant
        total = G.copy(), Gg.copy(), P.copy()
        self.add(total, t, y, self.moving)
        return total

    def heat(self, t: float, y: State) -> tuple[Array, Array]:
        """M du/dt (n,) and C dg/dt (m,), W; exact for any state of the freeze."""
        G, Gg, _ = self.remainder(t, y)
        return G - self.S @ y.u + self.B @ y.g, Gg + self.B.T @ y.u - self.D @ y.g

    def jacobian(self, t: float, y: State) -> csr_matrix:
        """-d(heat)/d(u, g), (n + m, n + m), at the state of the latest assembly."""
        slopes = [load.jacobian(t, y) for load in self.acting]
        J = sum((-slope for slope in slopes if slope is not None), self.S)
        return bmat([[J, -self.B], [-self.B.T, self.D]], format="csr") if self.m else J.tocsr()
