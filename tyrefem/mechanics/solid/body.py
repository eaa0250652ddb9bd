"""An axisymmetric body of compounds and cord layers in large displacement: forces, stiffness, state.

The state of an inflated body is the start of small further motions.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.errors import InputError, nearest
from tyrefem.mechanics.solid.body_law import BodyLaw
from tyrefem.mechanics.solid.compounds import determinant
from tyrefem.mechanics.solid.elements import Indices, PressedWall, Rings
from tyrefem.mechanics.solid.parts import RegionMaterial
from tyrefem.mechanics.solid.rim import Flange
from tyrefem.mechanics.solid.six_components import SYMMETRIC_UNIT, UNIT, outer, over

if TYPE_CHECKING:
    from tyrefem.mechanics.solid.centrifugal import Centrifugal
    from tyrefem.mechanics.solid.finite_law import FiniteLaw

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Prestressed(Brief):
    """An axisymmetric body in its present (deformed) configuration.

    Components run rr, zz, tt, rz, rt, zt, with engineering shears; points are the 3 x 3 Gauss points of
    ``skfem.Basis(mesh, ElementQuad2(), intorder=5)``.

    Parameters
    ----------
    mesh : skfem ``MeshQuad``, (r, z) in m, subdomains and boundaries named.
    stress : (6, n_elements, n_points) Cauchy stress, Pa.
    tangent : (6, 6, n_elements, n_points) c with d(Truesdell stress) = c : e, Pa, without the bulk stiffness.
    bulk : (n_elements, n_points) bulk stiffness, Pa, that acts on the projected dilatation.
    storage : (6, 6, n_elements, n_points) the part of ``tangent`` that dissipates, Pa.
    rubber : (6, 6, n_elements, n_points) the compounds' part of ``storage``, Pa; None: all of it.
    pressure : gauge pressure, Pa, that follows the boundary ``pressurised``.
    fixed : boundaries without displacement.
    pressurised, tread : boundary under pressure; boundary that may touch the road.
    support : sparse (3 n_nodes, 3 n_nodes) stiffness of the body's support, N/m per radian, component c of (r, z, t)
        of node i at 3 i + c; the same for all harmonics. None: only ``fixed``.
    rim_top : largest radius of the rim, m, where it is more than that of ``fixed``.
    symmetric : boundary on the mid plane of a half section, where u_z = 0; a mesh without it is a full section.
    law : stress in further motions of any size (`solid.finite_law`); None: linear in Green's strain.
    """

    mesh: Any
    stress: Array
    tangent: Array
    bulk: Array
    storage: Array
    pressure: float
    fixed: tuple[str, ...] = ("rim",)
    pressurised: str = "contained_air"
    tread: str = "road"
    symmetric: str = "symmetry"
    support: Any = None
    rim_top: float = 0.0
    law: FiniteLaw | None = None
    rubber: Array | None = None


@dataclass(frozen=True, eq=False)
class Body(Brief):
    """Virtual work per radian, on nine-node rings with the dilatation projected on (1, xi, eta) of each element:

    int [tau_iso + tau_cords + p J 1] : grad v r0 dA0 - P int ...,  p = kappa (Proj J - 1)

    Parameters
    ----------
    mesh : skfem ``MeshQuad`` in (r, z), m, undeformed; subdomains and boundaries named.
    parts : region -> its material; every element belongs to one region.
    held : boundary -> fixed components: ``"rz"``, ``"r"`` or ``"z"``.
    pressurised : boundaries under the following pressure.
    flanges : rigid rings on which the body may lie.
    centrifugal : load of a spinning body; None: it does not spin.

    Raises
    ------
    InputError : a region or boundary that the mesh does not have, an element without a part.
    """

    mesh: Any
    parts: Mapping[str, RegionMaterial]
    held: Mapping[str, str]
    pressurised: str = "contained_air"
    flanges: tuple[Flange, ...] = ()
    centrifugal: Centrifugal | None = None

    def __post_init__(self) -> None:
        regions = self.mesh.subdomains or {}
        for name in self.parts:
            if name not in regions:
                raise InputError(f"the mesh has no region '{name}'{nearest(name, regions)}")
        counts = np.zeros(self.mesh.t.shape[1], dtype=int)
        for name in self.parts:
            counts[regions[name]] += 1
        if (counts != 1).any():
            element = int(np.flatnonzero(counts != 1)[0])
            where = self.rings.region_of(element)
            raise InputError(f"an element of region '{where}' belongs to {counts[element]} parts; must be one")

    @functools.cached_property
    def rings(self) -> Rings:
        """Shape functions."""
        return Rings(self.mesh)

    @functools.cached_property
    def wall(self) -> PressedWall:
        """Edges on which the pressure acts."""
        return PressedWall(self.rings, self.pressurised)

    @functools.cached_property
    def bulk(self) -> Array:
        """(n_elements,) bulk modulus, Pa."""
        moduli = np.zeros(self.mesh.t.shape[1])
        for name, part in self.parts.items():
            moduli[self.mesh.subdomains[name]] = part.compound.bulk_modulus
        return moduli

    @functools.cached_property
    def free(self) -> Indices:
        """Degrees of freedom 2 i + c that are not fixed."""
        free = np.ones(2 * self.rings.n_nodes, dtype=bool)
        for boundary, components in self.held.items():
            for component in components:
                free[2 * self.rings.boundary_nodes(boundary) + "rz".index(component)] = False
        return np.flatnonzero(free)

    # -- kinematics --------------------------------------------------------------------------------------------------

    def deformation(self, displacement: Array) -> Array:
        """F (3, 3, n_elements, n_points) in (r, z, theta) of displacements (2, n_nodes), m."""
        rings = self.rings
        local = displacement[:, rings.element_nodes]
        f = np.zeros((3, 3, *rings.weights.shape))
        for i in range(2):
            for j in range(2):
                f[i, j] = (rings.gradients[j] @ local[i][..., None])[..., 0]
            f[i, i] += 1
        f[2, 2] = 1 + (local[0] @ rings.values.T) / rings.points[0]
        return f

    def pressure(self, volume: Array) -> Array:
        """(n_elements, n_points) p = kappa (Proj J - 1), Pa, positive in tension."""
        functions, weights = self.rings.linear_functions, self.rings.weights
        moments = functions.transpose(0, 2, 1) @ (weights * volume)[..., None]
        return np.asarray(self.bulk[:, None] * ((functions @ moments)[..., 0] - 1))

    def _sum_of_parts(self, deformation: Array, method: str, axes: tuple[int, ...]) -> tuple[Array, Array]:
        """A quantity of the compounds and of the cords, and the same with the cords weighted by their loss."""
        shape = (*axes, *self.rings.weights.shape)
        total, dissipating = np.zeros(shape), np.zeros(shape)
        for name, part in self.parts.items():
            members = self.mesh.subdomains[name]
            part_deformation = deformation[:, :, members]
            rubber = getattr(part.compound, method)(part_deformation)
            if part.blocks is not None:
                rubber = rubber + getattr(part.blocks, method)(part_deformation)
            cords = sum((getattr(layer, method)(part_deformation) for layer in part.cords), np.zeros(()))
            total[..., members, :] = rubber + cords
            dissipating[..., members, :] = rubber + part.cord_loss * cords
        return total, dissipating

    def _compounds(self, deformation: Array, dissipating: Array) -> Array:
        """The part of the dissipating tangent without the cords."""
        rubber = dissipating.copy()
        for name, part in self.parts.items():
            if part.cords and part.cord_loss:
                members = self.mesh.subdomains[name]
                part_deformation = deformation[:, :, members]
                rubber[..., members, :] = part.compound.tangent(part_deformation)
                if part.blocks is not None:
                    rubber[..., members, :] += part.blocks.tangent(part_deformation)
        return rubber

    def energy(self, displacement: Array) -> float:
        """Elastic energy per radian, J."""
        f = self.deformation(displacement)
        dilatation = self.pressure(determinant(f)) / self.bulk[:, None]
        density = self._sum_of_parts(f, "energy", ())[0] + self.bulk[:, None] / 2 * dilatation**2
        lying = sum(flange.energy(self.rings.nodes + displacement) for flange in self.flanges)
        return float((density * self.rings.weights).sum() + lying)

    # -- forces and stiffness ----------------------------------------------------------------------------------------

    def residual(self, displacement: Array, pressure: float) -> Array:
        """(2 n_nodes,) internal forces minus those of ``pressure`` (Pa), flanges and spin, N per radian."""
        f = self.deformation(displacement)
        stress, _, _ = self._stresses(f)
        strains, _ = self._strains(f)
        local = np.einsum("eqcd,ceq->ed", strains, stress[:4] * self.rings.weights, optimize=True)
        forces = np.zeros(2 * self.rings.n_nodes)
        np.add.at(forces, self._dofs, local)
        for flange in self.flanges:
            forces -= flange.force(self.rings.nodes + displacement)
        if self.centrifugal is not None:
            forces -= self.centrifugal.force(self.rings.nodes + displacement)
        return forces - pressure * self.load(displacement)

    def load(self, displacement: Array) -> Array:
        """(2 n_nodes,) force of unit pressure in the deformed configuration, m2 per radian."""
        forces = np.zeros(2 * self.rings.n_nodes)
        force = self.wall.force(self.rings.nodes + displacement)
        np.add.at(forces, _dofs(self.wall.nodes), force.reshape(len(force), -1))
        return forces

    def stiffness(self, displacement: Array, pressure: float) -> Any:
        """Derivative of `residual` by the displacement: sparse (2 n_nodes, 2 n_nodes), N/m per radian."""
        import scipy.sparse as sp

        f = self.deformation(displacement)
        stress, p, volume = self._stresses(f)
        tangent = self._tangent(f, p, volume)[0][:4, :4] * self.rings.weights
        strains, gradients = self._strains(f)
        n_elements, points, _, size = strains.shape
        flat = strains.reshape(n_elements, points * 4, size).transpose(0, 2, 1)
        matrix = flat @ (np.moveaxis(tangent, (0, 1), (-2, -1)) @ strains).reshape(n_elements, points * 4, size)
        matrix += self._dilatation_stiffness(strains, volume)
        matrix += self._stress_stiffness(gradients, stress * self.rings.weights, f)
        dofs, wall = self._dofs, _dofs(self.wall.nodes)
        follower = -pressure * self.wall.stiffness(self.rings.nodes + displacement).reshape(len(wall), -1)
        rows = np.concatenate([np.repeat(dofs, size, axis=1).ravel(), np.repeat(wall, 6, axis=1).ravel()])
        columns = np.concatenate([np.tile(dofs, (1, size)).ravel(), np.tile(wall, (1, 6)).ravel()])
        data = np.concatenate([matrix.ravel(), follower.ravel()])
        n = 2 * self.rings.n_nodes
        assembled = sp.coo_matrix((data, (rows, columns)), shape=(n, n)).tocsc()
        if self.centrifugal is not None:
            assembled = assembled - self.centrifugal.stiffness
        return assembled + self._support(displacement, 2) if self.flanges else assembled

    def _support(self, displacement: Array, components: int) -> Any:
        """Stiffness of the flanges: sparse, ``components`` at each node."""
        places = self.rings.nodes + displacement
        return sum(flange.stiffness_matrix(places, components) for flange in self.flanges)

    @functools.cached_property
    def _dofs(self) -> Indices:
        return _dofs(self.rings.element_nodes)

    def _stresses(self, f: Array) -> tuple[Array, Array, Array]:
        """Kirchhoff stress (6, ...), pressure p and J."""
        volume = determinant(f)
        p = self.pressure(volume)
        stress = self._sum_of_parts(f, "stress", (6,))[0]
        stress[:3] += p * volume
        return stress, p, volume

    def _tangent(self, f: Array, p: Array, volume: Array) -> tuple[Array, Array]:
        """J c without the bulk stiffness, and the dissipating part of it."""
        tangent, dissipating = self._sum_of_parts(f, "tangent", (6, 6))
        ones = over(outer(UNIT, UNIT) - 2 * SYMMETRIC_UNIT, p.shape)
        return tangent + p * volume * ones, dissipating

    def _strains(self, f: Array) -> tuple[Array, Array]:
        """Matrix (n_elements, n_points, 4, 18) from displacements to e_rr, e_zz, e_tt, g_rz; gradients as deformed."""
        plane = f[0, 0] * f[1, 1] - f[0, 1] * f[1, 0]
        by_r, by_z = self.rings.gradients
        r = (f[1, 1][..., None] * by_r - f[1, 0][..., None] * by_z) / plane[..., None]
        z = (f[0, 0][..., None] * by_z - f[0, 1][..., None] * by_r) / plane[..., None]
        strains = np.zeros((*plane.shape, 4, 9, 2))
        strains[..., 0, :, 0] = r
        strains[..., 1, :, 1] = z
        strains[..., 2, :, 0] = self.rings.values / (self.rings.points[0] * f[2, 2])[..., None]
        strains[..., 3, :, 0], strains[..., 3, :, 1] = z, r
        return strains.reshape(*plane.shape, 4, 18), np.stack([r, z])

    def _dilatation_stiffness(self, strains: Array, volume: Array) -> Array:
        """kappa Proj(J div v) Proj(J div u)."""
        weighted = self.rings.linear_functions * (self.rings.weights * volume)[..., None]
        moments = weighted.transpose(0, 2, 1) @ strains[..., :3, :].sum(axis=-2)
        return np.asarray(moments.transpose(0, 2, 1) @ (self.bulk[:, None, None] * moments))

    def _stress_stiffness(self, gradients: Array, stress: Array, f: Array) -> Array:
        r, z = gradients
        along_r = stress[0][..., None] * r + stress[3][..., None] * z
        along_z = stress[3][..., None] * r + stress[1][..., None] * z
        plane = r.transpose(0, 2, 1) @ along_r + z.transpose(0, 2, 1) @ along_z
        over_r = self.rings.values / (self.rings.points[0] * f[2, 2])[..., None]
        hoop = over_r.transpose(0, 2, 1) @ (stress[2][..., None] * over_r)
        blocks = np.zeros((len(plane), 9, 2, 9, 2))
        blocks[:, :, 0, :, 0] = plane + hoop
        blocks[:, :, 1, :, 1] = plane
        return blocks.reshape(-1, 18, 18)

    # -- results -----------------------------------------------------------------------------------------------------

    def deformed_mesh(self, displacement: Array) -> Any:
        """The deformed mesh: skfem ``MeshQuad2`` with the same regions and boundaries."""
        import skfem

        curved = skfem.MeshQuad2.from_mesh(self.mesh)
        places = self.rings.nodes + displacement
        locations = np.array(curved.doflocs)
        locations[:, np.asarray(curved.dofs.element_dofs).T] = places[:, self.rings.element_nodes]
        return replace(curved, doflocs=locations, _subdomains=self.mesh.subdomains, _boundaries=self.mesh.boundaries)

    def state(self, displacement: Array, pressure: float) -> Prestressed:
        """The deformed state as the start of a small further motion."""
        f = self.deformation(displacement)
        stress, p, volume = self._stresses(f)
        tangent, dissipating = self._tangent(f, p, volume)
        fixed = tuple(name for name, components in self.held.items() if set(components) == {"r", "z"})
        bulk = self.bulk[:, None] * volume
        return Prestressed(
            self.deformed_mesh(displacement), stress / volume, tangent / volume, bulk, dissipating / volume, pressure,
            fixed=fixed, pressurised=self.pressurised,
            support=self._support(displacement, 3) if self.flanges else None,
            rim_top=max((flange.centre[0] + flange.radius for flange in self.flanges), default=0.0),
            law=BodyLaw(self.rings, self.parts, self.mesh.subdomains, self.bulk, f),
            rubber=self._compounds(f, dissipating) / volume,
        )  # fmt: skip


def _dofs(nodes: Indices) -> Indices:
    return (2 * nodes[:, :, None] + np.arange(2)).reshape(len(nodes), -1)
