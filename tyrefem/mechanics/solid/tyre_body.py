"""From a study's cards to the body before inflation: compounds, cords, fixed boundaries."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.cache import Cache, fingerprint
from tyrefem.errors import InputError
from tyrefem.estimates import work as estimate
from tyrefem.geometry.legs import leg_thickness
from tyrefem.geometry.meshing.expected import QUADRATIC
from tyrefem.mechanics.solid.body import Body
from tyrefem.mechanics.solid.compounds import Compound, neo_hookean
from tyrefem.mechanics.solid.cords import CordLayer, lifted_angle, lifted_ends
from tyrefem.mechanics.solid.elements import Rings
from tyrefem.mechanics.solid.parts import RegionMaterial
from tyrefem.mechanics.solid.rim import FLANGE_RADIUS, SEAT, on_rim
from tyrefem.mechanics.solid.tread_blocks import TreadBlocks

if TYPE_CHECKING:
    from tyrefem.geometry.meshing.mesh import TyreMesh
    from tyrefem.inputs.study import StudyData
    from tyrefem.materials.card import MaterialCard

Array = NDArray[np.float64]
#: Temperature, degC, at which the losses of cords and rubber are compared.
LOSS_TEMPERATURE = 60.0
#: Compressive limit of a layer along its cords, over the shear modulus of its rubber. Estimate: wavy cords buckle
#: below the limit of straight cords, which is 1.
BUCKLING = 0.5
#: Range of crown angles, deg, in which the cords' stiffness can be computed from the ply shear modulus.
BIAS_ANGLES = (10.0, 80.0)

#: Directions, stations and depths of the Gauss points of a region.
_PLACES: Cache[tuple[Array, Array, Array]] = Cache(size=32)


def tyre_body(study: StudyData, mesh: TyreMesh | None = None) -> Body:
    """The body of a study's tyre on its mesh: fixed on the rim's seat, supported by its flanges; u_z = 0 on the mid
    plane of a half section.

    A region's compound is its card's ``[elasticity]``, or neo-Hookean with its ``shear_modulus`` (that of the carcass
    where it has none). Its cords are the card's ``[cords]``; or bias plies with v_c E = 4 G_p / sin^2(2 a), from
    the ``[cord]`` table's ply shear modulus G_p and crown angle a; or, in the bead, the rating's wire along the hoop.

    Raises
    ------
    InputError : triangles; a region without a modulus; cords for which the lift law has no angle.
    """
    meshed = study.mesh() if mesh is None else mesh
    nodes = QUADRATIC * meshed.n_nodes
    try:
        estimate.check_memory(estimate.mechanics(nodes).memory, f"{nodes:,} nodes of nine-node elements")
    except InputError as error:
        raise error.within(field="mesh", file=study.file) from None
    reader = _Reader(study, meshed, Rings(meshed.mesh))
    parts = {}
    for region in study.section.regions:
        try:
            parts[region] = reader.part(region)
        except InputError as error:
            raise error if error.file else error.within(field=f"materials.{region}", file=study.file) from None
    section = study.section
    named, flanges = on_rim(meshed.mesh, section.flange_radius or FLANGE_RADIUS, centre=section.flange_centre)
    held = {SEAT: "rz", **({"symmetry": "z"} if section.half else {})}
    return Body(named, parts, held, flanges=flanges)


def reference_density(study: StudyData, body: Body) -> Array:
    """(n_elements, n_points) kg/m3 of the undeformed volume: the cards' at the drive's initial temperature."""
    density = np.zeros(body.rings.weights.shape)
    for region in body.parts:
        density[body.mesh.subdomains[region]] = study.materials[region].density.at(study.card.drive.initial)
    section = study.section
    if section.pattern is not None and section.patterned is not None:
        density[body.mesh.subdomains[section.patterned]] *= section.pattern.rubber
    return density


@dataclass(frozen=True, eq=False)
class _Reader:
    study: StudyData
    mesh: TyreMesh
    rings: Rings

    def part(self, region: str) -> RegionMaterial:
        card = self.study.materials[region]
        cords = getattr(card, "cords", None)
        compound = self.compound(card)
        if region == self.study.section.patterned:
            if cords is not None:
                raise InputError("a tread with a pattern has no cords", field="cords")
            compound, blocks = self.patterned(compound, region)
            return RegionMaterial(compound, blocks=blocks)
        if cords is not None:
            cord_loss = getattr(cords, "loss_tangent", None) or 0.0
            ratio = cord_loss / max(float(card.loss_tangent(LOSS_TEMPERATURE)), 1e-12)
            return RegionMaterial(compound, (self._with_buckling_limit(self.layer(region, cords), compound),), ratio)
        layer = self.bias_plies(region, card) or self.bead_wire(region, card)
        return RegionMaterial(compound, (self._with_buckling_limit(layer, compound),) if layer else ())

    @staticmethod
    def _with_buckling_limit(layer: CordLayer, compound: Compound) -> CordLayer:
        return replace(layer, limit=BUCKLING * compound.shear_modulus)

    def compound(self, card: MaterialCard) -> Compound:
        law = getattr(card, "elasticity", None)
        if law is not None:
            if law.law == "neo-hookean":
                return neo_hookean(law.shear_modulus, law.bulk)
            c01, c20, c30 = (float(getattr(law, name, 0.0)) for name in ("c01", "c20", "c30"))
            return Compound(law.c10, c01, c20, c30, law.bulk)
        carcass = self.study.materials.get("carcass")
        modulus = card.shear_modulus or (carcass.shear_modulus if carcass else None)
        if modulus is None:
            raise InputError("the card needs 'shear_modulus' or '[elasticity]' for large displacements")
        return neo_hookean(float(modulus.value))

    def patterned(self, compound: Compound, region: str) -> tuple[Compound, TreadBlocks]:
        """The rubber that transverse grooves leave, and what the bending of its blocks takes off."""
        pattern, layer = self.study.section.pattern, self.study.section.layers[-1]
        assert pattern is not None
        left = pattern.rubber
        constants = {name: left * getattr(compound, name) for name in ("c10", "c01", "c20", "c30")}
        compound = Compound(**constants, bulk=left * compound.bulk_modulus)
        _, (along_r, along_z), s, _ = self._places(region)
        missing = (1 - pattern.bending(layer.thickness(s))) * compound.shear_modulus
        return compound, TreadBlocks(np.stack([along_z, -along_r]), missing)

    def layer(self, region: str, cords: Any) -> CordLayer:
        points, meridian, s, depth = self._places(region)
        if cords.lift:
            angle = lifted_angle(cords.angle, cords.angle_radius, points[0])
            ends = cords.ends * lifted_ends(cords.angle, cords.angle_radius, points[0])
        else:
            angle, ends = np.full(s.shape, cords.angle), np.full(s.shape, cords.ends)
        area = np.pi * cords.diameter**2 / 4
        share = ends * area / self._thickness(region, s, depth)
        if share.max() > 1:
            raise InputError(
                f"the cords fill {share.max():.0%} of the region at its narrowest place", field="cords.ends"
            )
        return CordLayer(
            angle, meridian, share * cords.modulus, cords.in_compression / cords.modulus, cords.modulus * area
        )

    def bias_plies(self, region: str, card: MaterialCard) -> CordLayer | None:
        if card.cord is None or card.cord.ply_shear_modulus is None:
            return None
        rating = self.study.section.rating
        angle = (rating.cord_angle if rating else None) or card.cord.crown_angle
        if not angle:
            raise InputError("neither the section nor the card gives the crown cord angle", field="cord.crown_angle")
        if not BIAS_ANGLES[0] <= np.degrees(angle) <= BIAS_ANGLES[1]:
            # v_c E = 4 G_p / sin^2(2 a) is infinite at 0 and 90 deg.
            raise InputError(
                f"the cords' stiffness follows from a ply shear modulus for crown angles of {BIAS_ANGLES[0]:g} to "
                f"{BIAS_ANGLES[1]:g} deg, not {np.degrees(angle):.4g} deg; give the card [cords]",
                field="cord.crown_angle",
            )
        points, meridian, _, _ = self._places(region)
        crown = float(self.study.section.line.position(np.zeros(1))[0, 0])
        # The outer half of the plies exceeds the radius of the lift law at the crown: the midline's angle is used
        # there.
        angles = lifted_angle(angle, crown, np.minimum(points[0], crown))
        stiffness = 4 * card.cord.ply_shear_modulus / np.sin(2 * angle) ** 2
        return CordLayer(angles, meridian, np.full(angles.shape, stiffness))

    def bead_wire(self, region: str, card: MaterialCard) -> CordLayer | None:
        rating = self.study.section.rating
        if region != "bead" or rating is None or card.youngs_modulus is None:
            return None
        points, meridian, _, _ = self._places(region)
        sides = 1 if self.study.section.half else 2
        share = rating.bead_area * sides / self.study.section.area(region)
        stiffness = np.full(points.shape[1:], share * float(card.youngs_modulus.value))
        return CordLayer(np.zeros(points.shape[1:]), meridian, stiffness)

    def _places(self, region: str) -> tuple[Array, Array, Array, Array]:
        """Gauss points (2, n, q), unit vectors along the meridian, stations |s| and depths of a region."""
        points = self.rings.points[:, self.mesh.mesh.subdomains[region]]
        flat = points.reshape(2, -1)

        def placed() -> tuple[Array, Array, Array]:
            s, depth = self.study.section.locate(flat.T)
            along = self.mesh.along_meridian(flat).reshape(points.shape)
            return along, np.abs(s).reshape(points.shape[1:]), depth.reshape(points.shape[1:])

        # Tyres that differ in their materials have the same places.
        return points, *_PLACES.get((self.study.section, self.mesh.section, fingerprint(flat)), placed)

    def _thickness(self, region: str, s: Array, depth: Array) -> Array:
        """Thickness of the layer that has the cords: of one leg of the region."""
        section = self.study.section
        if section.wrapping is not None and region == section.wrap:
            return np.full(s.shape, section.wrapping.thickness)
        return leg_thickness(section, region, s, depth)
