"""Free rolling of a tyre with loss, without friction: contact pressure that moves to the front, rolling resistance."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.complementarity import contact_forces
from tyrefem.mechanics.footprint.tyre_on_road import TyreOnRoad
from tyrefem.mechanics.rolling.lossy_harmonics import LossyHarmonics
from tyrefem.mechanics.rolling.rolled import TORQUE
from tyrefem.mechanics.rolling.rolling_grid import RollingGrid
from tyrefem.mechanics.rolling.tread_influence import PHASE, TreadInfluence

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Indices = NDArray[np.int64]
#: Relative change of the forces at which a drum's contact directions have settled; rounds.
SETTLED, ROUNDS = 1e-7, 40
#: Relative error of a load; steps of the deflection.
CLOSE, STEPS = 1e-8, 40
#: Angles beyond the contact of the first guess, over its half length.
BEYOND = 1.25
#: Shifts of the angles, in steps, over which a resistance is averaged.
SHIFTS = (0.0, 0.25, 0.5, 0.75)


@dataclass(frozen=True, eq=False)
class OneSide(TreadInfluence):
    """The tread of a section under loads that are the same on both sides of a half section's mid plane."""

    @functools.cached_property
    def mirrored(self) -> Indices:
        """No node has a point of its own on the other side."""
        return np.zeros(0, dtype=np.int64)

    @functools.cached_property
    def lengths(self) -> Array:
        """(m,) tributary length of each node on the outline, m."""
        return np.asarray(self.tread.widths[0])

    def solved(self, n: int) -> Any:
        """(3, m, 3, m) displacement per force amplitude of harmonic n, m per N per radian, with a cache."""
        return self._solved.get(n, lambda: self._of(self.tread.harmonics, n))


@dataclass(frozen=True, eq=False)
class ShiftedGrid(RollingGrid):
    """The same points, turned round the wheel by a ``shift`` of a step: j + shift."""

    shift: float = 0.0

    @functools.cached_property
    def angles(self) -> Array:
        """(n_angles,), rad."""
        return np.asarray(self.step * (np.arange(self.first, self.last + 1) + self.shift), dtype=float)


@dataclass(frozen=True, eq=False)
class LossyTyre(TyreOnRoad):
    """A tyre on its road that turns with loss, and inertia if its state has it. Material runs to smaller angles.

    Parameters
    ----------
    lossy : the complex stiffness of every harmonic.
    """

    lossy: LossyHarmonics | None = None
    _grids: dict[tuple[int, int], ShiftedGrid] = field(default_factory=dict, init=False, repr=False)

    @functools.cached_property
    def harmonics(self) -> LossyHarmonics:
        """The complex stiffness."""
        assert self.lossy is not None
        return self.lossy

    @functools.cached_property
    def influence(self) -> OneSide:
        """Displacements of the tread by the angle."""
        return OneSide(self.tread)

    def at_load(self, load: float, harmonics: int, deflection: float) -> FreeRolling:
        """The rolling tyre under a load, N, on both sides, from a near deflection, m.

        Raises
        ------
        InputError : no contact, or the load is not reached.
        """
        before, wanted = None, deflection
        for _ in range(STEPS):
            rolling = self.at_deflection(wanted, harmonics)
            if abs(rolling.load - load) <= CLOSE * load:
                return rolling
            slope = rolling.load / wanted * 1.3
            if before is not None and before.deflection != wanted:
                slope = (rolling.load - before.load) / (wanted - before.deflection)
            before, wanted = rolling, max(wanted + (load - rolling.load) / slope, 0.2 * wanted)
        raise InputError(f"the rolling tyre does not settle under {load:.5g} N", field="load")

    def at_deflection(self, deflection: float, harmonics: int, shift: float = 0.0) -> FreeRolling:
        """The rolling tyre at a deflection, m, with harmonics up to a number; the angles lie at j + ``shift`` steps.

        Raises
        ------
        InputError : no contact; contact all round; directions on a drum that do not settle.
        """
        half_angle = self.road.half_angle(self.reach, deflection)
        side = math.ceil(BEYOND * half_angle / math.pi * harmonics) + 3
        while side < harmonics:
            rolling = self._on(replace(self._grid(harmonics, side), shift=shift), deflection)
            touching = rolling.forces.reshape(len(rolling.grid.angles), -1).max(axis=1) > 0
            if not touching.any():
                raise InputError("the tyre does not touch the road", field="deflection")
            if not (touching[0] or touching[-1]):
                return rolling
            side = math.ceil(1.3 * side) + 1
        raise InputError("the tyre touches the road all round", field="deflection")

    def _grid(self, harmonics: int, side: int) -> ShiftedGrid:
        if (harmonics, side) not in self._grids:
            self._grids.clear()
            self._grids[harmonics, side] = ShiftedGrid(self.influence, self.road, harmonics, -side, side)
        return self._grids[harmonics, side]

    def _on(self, grid: RollingGrid, deflection: float) -> FreeRolling:
        distance = self.reach - deflection
        moved, before = np.zeros((grid.n_points, 3)), np.zeros(grid.n_points)
        closed, compliance = None, None
        for _ in range(ROUNDS):
            gaps, normals = grid.gaps(moved, distance)
            if compliance is None or not math.isinf(self.road.drum_diameter):
                compliance = grid.normal_compliance(normals)
                _check_positive(compliance)
            free = gaps + np.einsum("kx,kx->k", normals, moved)
            forces, closed = contact_forces(compliance, free, closed, symmetric=False)
            rolling = FreeRolling(self, grid, deflection, forces, normals)
            moved = rolling.moved
            change = float(np.abs(forces - before).max(initial=0.0))
            if math.isinf(self.road.drum_diameter) or change <= SETTLED * forces.max(initial=0.0):
                return rolling
            before = forces
        raise InputError("the contact on the drum does not settle", field="drum_diameter")


def _check_positive(compliance: Array) -> None:
    """Raise `InputError` for a compliance without unique contact forces: its symmetric part must be positive."""
    try:
        np.linalg.cholesky((compliance + compliance.T) / 2)
    except np.linalg.LinAlgError:
        raise InputError(
            "the rolling contact has no unique solution: the speed is beyond the tread's critical speed", field="speed"
        ) from None


@dataclass(frozen=True, eq=False)
class FreeRolling(Brief):
    """A tyre with loss that rolls without friction. Made by `LossyTyre`.

    Parameters
    ----------
    pressing : the tyre and its road. grid : points that may touch. deflection : m.
    forces : (k,) contact forces, N, of one side of a half section. normals : (k, 3) into the road.
    """

    pressing: LossyTyre
    grid: RollingGrid
    deflection: float
    forces: Array
    normals: Array

    def _facts(self) -> Mapping[str, Any]:
        return {
            "load": f"{self.load:.6g} N",
            "offset": f"{self.offset * 1e3:.3g} mm",
            "torque": f"{self.torque:.4g} N m",
        }

    @property
    def harmonics(self) -> int:
        """Highest harmonic."""
        return self.grid.harmonics

    @property
    def both(self) -> float:
        """2 for a half section, else 1."""
        return 2.0 if self.pressing.tread.half else 1.0

    @property
    def angular_speed(self) -> float:
        """W, rad/s."""
        return self.pressing.harmonics.angular_speed

    @functools.cached_property
    def _components(self) -> Array:
        """(n_angles, m, 3) contact forces on the tread along (r, z, t), N."""
        vectors = (-self.forces[:, None] * self.normals).reshape(len(self.grid.angles), -1, 3)
        return np.asarray(np.einsum("jpx,jcx->jpc", vectors, self.grid.wheel_axes))

    @functools.cached_property
    def moved(self) -> Array:
        """(k, 3) displacement of the tread (x forward, y down, z left), m, averaged with the hats."""
        count, kernel = len(self.grid.angles), self.grid.kernel
        loaded = np.flatnonzero(np.any(self._components != 0, axis=(1, 2)))
        moved = np.zeros((count, self._components.shape[1], 3))
        for of in loaded:
            blocks = kernel[count - 1 - of : 2 * count - 1 - of]
            moved += np.einsum("jambn,nb->jma", blocks, self._components[of], optimize=True)
        return np.einsum("jma,jax->jmx", moved, self.grid.wheel_axes).reshape(-1, 3)

    @functools.cached_property
    def load_harmonics(self) -> Complex:
        """(harmonics + 1, 3, m) load amplitudes on the tread along (r, z, t), N per radian."""
        n = np.arange(self.harmonics + 1)
        shares = np.sinc(n * self.grid.step / (2 * np.pi)) ** 2 / np.where(n == 0, 2 * np.pi, np.pi)
        waves = shares[:, None] * np.exp(-1j * np.multiply.outer(n, self.grid.angles))
        loads = np.einsum("nj,jpc->ncp", waves, self._components) / PHASE[:, None]
        loads[0] = loads[0].real
        return np.asarray(loads)

    @functools.cached_property
    def amplitudes(self) -> Complex:
        """(harmonics + 1, n_dofs) complex amplitudes U, m, of u = Re((U_r, U_z, -i U_t) e^(i n t))."""
        tread = self.pressing.tread
        dofs = 3 * tread.nodes + np.arange(3)[:, None]
        loads = np.zeros((self.harmonics + 1, self.pressing.harmonics.elements.n_dofs), dtype=complex)
        loads[:, dofs.ravel()] = self.load_harmonics.reshape(len(loads), -1)
        loads[:, self.pressing.harmonics.held] = 0.0
        return np.asarray(tread.responses(loads))

    @functools.cached_property
    def load(self) -> float:
        """Force along the road's normal, N, of the whole tyre."""
        return float(self.both * self.forces @ (self.normals @ self.pressing.road.normal))

    @functools.cached_property
    def torque(self) -> float:
        """Moment of the contact forces about the axle, N m, which the axle must overcome."""
        places = self.grid.free_places + self.moved
        vectors = -self.forces[:, None] * self.normals
        return float(self.both * (vectors * (places @ TORQUE.T)).sum())

    @property
    def offset(self) -> float:
        """Torque over load, m: how far the load's line of action passes in front of the axle."""
        return self.torque / self.load if self.load else 0.0

    @functools.cached_property
    def dissipated(self) -> float:
        """Energy lost in a revolution, J: sum over n of 2 pi^2 n U* K''_n U, of the whole tyre."""
        harmonics, total = self.pressing.harmonics, 0.0
        for n, u in enumerate(self.amplitudes):
            total += 2 * np.pi**2 * n * float((u.conj() @ (harmonics.loss(n) @ u)).real)
        return float(self.both * total)

    @functools.cached_property
    def rolling_radius(self) -> float:
        """Distance rolled per radian, m, if the tread does not slip on average: mean of dx/dt over the contact."""
        dofs = 3 * self.pressing.tread.nodes
        n = np.arange(self.harmonics + 1)[:, None]
        angles = self.grid.angles
        waves = np.exp(1j * n * angles)
        u_r, u_t = self.amplitudes[:, dofs], -1j * self.amplitudes[:, dofs + 2]
        radial, around = (np.einsum("nj,nm->jm", waves, u).real for u in (u_r, u_t))
        d_radial, d_around = (np.einsum("nj,nm->jm", 1j * n * waves, u).real for u in (u_r, u_t))
        cos, sin = np.cos(angles)[:, None], np.sin(angles)[:, None]
        rate = (self.pressing.tread.places[0] + radial + d_around) * cos + (d_radial - around) * sin
        return float(np.average(rate.ravel(), weights=self.forces))

    @property
    def pressure(self) -> Array:
        """(n_angles, m) contact pressure, Pa."""
        return np.asarray((self.forces / self.grid.areas).reshape(len(self.grid.angles), -1))


@dataclass(frozen=True, eq=False)
class FreeRollingResistance(Brief):
    """Rolling resistance of a freely rolling tyre, from the offset of its pressure and from the loss of its rubber.

    The ends of the contact lie between two angles. What that does to the torque changes sign with the place of the
    angles and cancels in the mean over ``rollings`` with angles at j, j + 1/4, j + 1/2, j + 3/4 steps.

    Parameters
    ----------
    rollings : `FreeRolling` at one deflection with shifted angles.
    """

    rollings: tuple[FreeRolling, ...]

    def _mean(self, name: str) -> float:
        return float(np.mean([getattr(rolling, name) for rolling in self.rollings]))

    @property
    def load(self) -> float:
        """N."""
        return self._mean("load")

    @property
    def torque(self) -> float:
        """N m, that the axle must overcome."""
        return self._mean("torque")

    @property
    def offset(self) -> float:
        """Torque over load, m."""
        return self.torque / self.load

    @property
    def dissipated(self) -> float:
        """Energy lost in a revolution, J."""
        return self._mean("dissipated")

    @property
    def rolling_radius(self) -> float:
        """m."""
        return self._mean("rolling_radius")

    @property
    def by_offset(self) -> float:
        """Torque over rolling radius, N."""
        return self.torque / self.rolling_radius

    @property
    def by_loss(self) -> float:
        """Energy lost per metre rolled, N."""
        return self.dissipated / (2 * np.pi * self.rolling_radius)

    @property
    def balance(self) -> float:
        """Resistance by offset over that by loss, minus 1; 0 without loss."""
        return self.by_offset / self.by_loss - 1 if self.by_loss else 0.0


def rolling_resistance(
    tyre: LossyTyre, harmonics: int, deflection: float, load: float | None = None
) -> FreeRollingResistance:
    """`FreeRollingResistance` at a deflection, m, or under a load, N, near it.

    >>> from tyrefem.mechanics.footprint.example_tyre import PlainTyre
    >>> state = PlainTyre().state(along=6)
    >>> lossy = LossyHarmonics(state, angular_speed=10.0, tangents=lambda frequency: np.full(len(state.bulk), 0.1))
    >>> resistance = rolling_resistance(LossyTyre(state, lossy=lossy), 120, 0.012)
    >>> abs(resistance.balance) < 0.015, 2e-4 < resistance.offset < 2e-3
    (True, True)
    """
    if load is not None:
        deflection = tyre.at_load(load, harmonics, deflection).deflection
    return FreeRollingResistance(tuple(tyre.at_deflection(deflection, harmonics, shift) for shift in SHIFTS))
