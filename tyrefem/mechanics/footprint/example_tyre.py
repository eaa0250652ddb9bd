"""Plain bodies: stress-free rubber, and a simple belted tyre, for examples, tests and benchmarks."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.footprint.elements import SectionElements
from tyrefem.mechanics.solid.body import Body, Prestressed
from tyrefem.mechanics.solid.compounds import neo_hookean
from tyrefem.mechanics.solid.cords import CordLayer
from tyrefem.mechanics.solid.parts import RegionMaterial

Array = NDArray[np.float64]


def isotropic(shear_modulus: float | Array) -> Array:
    """(6, 6, ...) tangent of isotropic rubber without its bulk stiffness, Pa: 2 G times the deviator.

    >>> round(float(isotropic(3.0)[0, 0]), 9), float(isotropic(3.0)[3, 3])
    (4.0, 3.0)
    """
    unit = np.diag([2.0, 2.0, 2.0, 1.0, 1.0, 1.0])
    unit[:3, :3] -= 2.0 / 3.0
    return np.multiply.outer(unit, np.asarray(shear_modulus))


def fibres(stiffness: Array, direction: Array) -> Array:
    """(6, 6, ...) tangent of fibres of stiffness E v (Pa) along unit vectors (3, ...) in (r, z, t), +-t averaged."""
    r, z, t = direction
    d = np.stack([r * r, z * z, t * t, r * z, r * t, z * t])
    matrix = stiffness * d[:, None] * d[None, :]
    matrix[:4, 4:] = matrix[4:, :4] = 0.0
    return np.asarray(matrix)


def stress_free(mesh: Any, shear_modulus: float, bulk_modulus: float, fixed: tuple[str, ...] = ("rim",)) -> Prestressed:
    """A body of one rubber without stress or pressure."""
    shape = SectionElements(mesh).radii.shape
    tangent = np.broadcast_to(isotropic(shear_modulus)[..., None, None], (6, 6, *shape))
    return Prestressed(mesh, np.zeros((6, *shape)), tangent, np.full(shape, bulk_modulus), tangent, 0.0, fixed)


def pressurised(state: Prestressed, pressure: float) -> Prestressed:
    """The same geometry and stiffness with the stress of linear elasticity that balances ``pressure``, Pa, exactly."""
    from tyrefem.mechanics.footprint.harmonics import Harmonics

    harmonics = Harmonics(replace(state, stress=np.zeros_like(state.stress), pressure=0.0))
    u = harmonics.inflated_by(pressure)
    stress = np.einsum("ijeq,jeq->ieq", state.tangent, harmonics.elements.strain(0, u))
    stress[:3] += state.bulk * harmonics.elements.projected_dilatation(0, u)
    stress[4:] = 0.0
    return replace(state, stress=stress, pressure=pressure)


@dataclass(frozen=True)
class PlainTyre:
    """A belted tyre of one rubber, its meridian a crown arc and a sidewall arc. SI; all values are made up.

    Layers from inside: a radial ply (cords along the meridian), belts (cords at +-``belt_angle`` to the circumference,
    up to ``belt_end`` of the crown), tread or sidewall rubber. ``half``: only z >= 0.
    """

    crown_radius: float = 0.31
    crown_width: float = 0.07
    crown_curvature: float = 0.3
    sidewall_radius: float = 0.06
    sidewall_turn: float = 2.0
    tread_thickness: float = 0.010
    shear_modulus: float = 1.5e6
    bulk_ratio: float = 100.0
    ply_stiffness: float = 1e8
    belt_stiffness: float = 2e9
    belt_angle: float = 0.42
    belt_end: float = 0.92
    half: bool = True

    def _meridian(self, s: Array) -> tuple[Array, Array]:
        """Middle of the structure (2, n) in (r, z) and outward normal (2, n) at meridian lengths s >= 0."""
        big, small = self.crown_curvature, self.sidewall_radius
        shoulder = self.crown_width / big
        first = np.minimum(s, self.crown_width) / big
        place = np.array([self.crown_radius - big * (1 - np.cos(first)), big * np.sin(first)])
        turn = shoulder + np.maximum(s - self.crown_width, 0.0) / small
        place[0] += small * (np.cos(turn) - np.cos(shoulder)) * (s > self.crown_width)
        place[1] += small * (np.sin(turn) - np.sin(shoulder)) * (s > self.crown_width)
        angle = np.where(s > self.crown_width, turn, first)
        return place, np.array([np.cos(angle), np.sin(angle)])

    @property
    def belt_edge(self) -> Array:
        """Middle of the belt's end (2,) in (r, z), m."""
        place, normal = self._meridian(np.array([self.belt_end * self.crown_width]))
        return np.asarray((place + normal * 0.00075)[:, 0])

    def mesh(self, along: int = 24, through: tuple[int, int, int] = (1, 1, 1)) -> Any:
        """Quadrilaterals: ``along`` the half meridian, and through ply, belt and tread."""
        import skfem

        length = self.crown_width + self.sidewall_radius * self.sidewall_turn
        n_crown = max(round(along * 0.5), 1)
        end = self.belt_end * self.crown_width
        n_belt = max(n_crown - max(n_crown // 8, 1), 1)
        s = np.concatenate([
            np.linspace(0, end, n_belt + 1), np.linspace(end, self.crown_width, n_crown - n_belt + 1)[1:],
            np.linspace(self.crown_width, length, max(along - n_crown, 1) + 1)[1:],
        ])  # fmt: skip
        if not self.half:
            s = np.concatenate([-s[:0:-1], s])
        layers = np.concatenate([np.linspace(k, k + 1, count + 1)[k > 0 :] for k, count in enumerate(through)])
        flat = skfem.MeshQuad.init_tensor(layers, s)
        depth, signed = flat.p
        middle, normal = self._meridian(np.abs(signed))
        fade = np.clip((np.abs(signed) - self.crown_width) / (0.35 * length), 0.0, 1.0)
        rubber = self.tread_thickness * (1 - 0.8 * fade)
        offset = 0.0015 * np.minimum(depth, 2.0) - 0.0015 + rubber * np.maximum(depth - 2.0, 0.0)
        placed = middle + normal * offset
        placed[1] = np.where(signed < 0, -placed[1], placed[1])
        at, across = flat.p[:, flat.facets].mean(axis=1), flat.p[:, flat.t].mean(axis=1)
        road = (at[0] > 3 - 1e-9) & (np.abs(at[1]) < self.crown_width)
        names = {
            "contained_air": at[0] < 1e-9,
            "road": road,
            "outside_air": (at[0] > 3 - 1e-9) & ~road,
            "rim": np.abs(at[1]) > length - 1e-9,
        } | ({"symmetry": at[1] < 1e-9} if self.half else {})  # fmt: skip
        belted = (across[0] > 1) & (across[0] < 2) & (np.abs(across[1]) < end)
        regions = {
            "ply": across[0] < 1,
            "belt": belted,
            "tread": (across[0] > 2) & (np.abs(across[1]) < self.crown_width),
        }
        regions["sidewall"] = ~np.logical_or.reduce(list(regions.values()))
        mesh = skfem.MeshQuad(placed, flat.t, sort_t=False)
        return mesh.with_subdomains({k: np.flatnonzero(v) for k, v in regions.items()}).with_boundaries(
            {k: np.flatnonzero(v) for k, v in names.items()}
        )

    def body(self, along: int = 24, through: tuple[int, int, int] = (1, 1, 1)) -> Body:
        """The tyre before inflation: neo-Hookean rubber, cords whose force is linear in their stretch.

        >>> from tyrefem.mechanics.solid.newton import equilibrium
        >>> body = PlainTyre().body(along=6)
        >>> round(1e3 * float(equilibrium(body, 2e5).displacement[0].max()), 1)
        9.0
        """
        mesh = self.mesh(along, through)
        direction = meridian_direction(SectionElements(mesh))[:2]
        rubber = neo_hookean(self.shear_modulus, self.bulk_ratio * self.shear_modulus)
        parts = {name: RegionMaterial(rubber) for name in mesh.subdomains}
        layers = {"ply": (np.pi / 2, self.ply_stiffness), "belt": (self.belt_angle, self.belt_stiffness)}
        for name, (angle, stiffness) in layers.items():
            meridian = direction[:, mesh.subdomains[name]]
            ones = np.ones(meridian.shape[1:])
            parts[name] = RegionMaterial(rubber, (CordLayer(angle * ones, meridian, stiffness * ones),))
        held = {"rim": "rz"} | ({"symmetry": "z"} if self.half else {})
        return Body(mesh, parts, held)

    def state(self, pressure: float = 2e5, along: int = 24, through: tuple[int, int, int] = (1, 1, 1)) -> Prestressed:
        """The inflated tyre: the given shape with a stress that balances ``pressure``, Pa."""
        mesh = self.mesh(along, through)
        elements = SectionElements(mesh)
        shape = elements.radii.shape
        rubber = np.broadcast_to(isotropic(self.shear_modulus)[..., None, None], (6, 6, *shape))
        tangent = np.array(rubber)
        direction = meridian_direction(elements)
        ply, belt = mesh.subdomains["ply"], mesh.subdomains["belt"]
        tangent[:, :, ply] += fibres(np.asarray(self.ply_stiffness), direction[:, ply])
        cos, sin = np.cos(self.belt_angle), np.sin(self.belt_angle)
        tilted = sin * direction[:, belt]
        tilted[2] = cos
        tangent[:, :, belt] += fibres(np.asarray(self.belt_stiffness), tilted)
        bulk = np.full(shape, self.bulk_ratio * self.shear_modulus)
        state = Prestressed(mesh, np.zeros((6, *shape)), tangent, bulk, rubber, 0.0)
        return pressurised(state, pressure)


def meridian_direction(elements: SectionElements) -> Array:
    """(3, n_elements, n_points) unit vectors (r, z, 0) along the meridian, for meshes made by `PlainTyre`."""
    corners = elements.mesh.p[:, elements.mesh.t]
    # Tensor meshes number corners such that edges 0-1 and 3-2 have the second coordinate's direction.
    along = corners[:, 1] + corners[:, 2] - corners[:, 0] - corners[:, 3]
    along = along / np.linalg.norm(along, axis=0)
    return np.stack([*np.broadcast_to(along[..., None], (2, *elements.radii.shape)), np.zeros(elements.radii.shape)])
