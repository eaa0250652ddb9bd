"""A study's tyre inflated and pressed on its road by finite elements, with a cache of pressures, roads and loads."""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.cache import Cache
from tyrefem.errors import InputError
from tyrefem.estimates import work as estimate
from tyrefem.geometry import meshing
from tyrefem.geometry.meshing.expected import QUADRATIC, expected_nodes
from tyrefem.materials.reads import key_of, values_read

if TYPE_CHECKING:
    from tyrefem.geometry.meshing.mesh import TyreMesh
    from tyrefem.geometry.section import Section
    from tyrefem.inputs.loading import LoadCase
    from tyrefem.inputs.study import StudyData
    from tyrefem.mechanics.footprint.contact import Pressing
    from tyrefem.mechanics.footprint.footprint import Footprint
    from tyrefem.mechanics.solid.inflation import Inflation

#: Allowed change with the number of harmonics.
TOLERANCE = 0.02
#: Size of nine-node elements over that of the study's mesh: the larger one up to this share of the meridian.
COARSER, COARSE_SHARE, AT_LEAST = 2.5, 1 / 18, 2.0
#: Numbers of pressures with roads, and of loads, that a tyre keeps: a ramp has nine. About 40 MB each.
REMEMBERED = 10
#: Number of tyres that a process keeps: the study's tyre, and the last one with another stiffness.
TYRES = 2

#: The latest mesh: tyres of other stiffness share it.
_MESHES: Cache[TyreMesh] = Cache(size=1)


def element_size(section: Section, size: float) -> float:
    """Size of nine-node elements, m, for a study's mesh of a size, m: 2.5 times, at least twice that.

    Between, they have 1/18 of the meridian. Shipped studies have 2.5 times, except the measured tyres' coarse meshes.
    """
    return max(AT_LEAST * size, min(COARSER * size, COARSE_SHARE * section.line.length))


def mechanical_mesh(study: StudyData, *, large: bool | None = None) -> TyreMesh:
    """The study's mesh file; gmsh's quadrilaterals if the study has these; otherwise a mapped mesh.

    The mapped mesh has nine-node elements of `element_size`, also if the study has gmsh's triangles (nine-node elements
    need quadrilaterals; energies are interpolated by region and place). ``large``: for large motion; None: as in the
    study.

    Raises
    ------
    InputError : a size too coarse or too fine for the section, or for the memory that is free.
    """
    choice = study.card.mesh
    if choice.file is not None:
        return study.mesh()
    as_given = choice.mesher == "gmsh" and choice.cell == "quad"
    mesher, size = ("gmsh", choice.size) if as_given else ("mapped", element_size(study.section, choice.size))
    mechanics = study.card.mechanics
    in_large = mechanics.strain == "fem" and mechanics.motion == "large" if large is None else large
    _check_memory(study, mesher, size, in_large)
    section = study.section
    try:
        return _MESHES.get(
            (section, mesher, size), lambda: meshing.build(section, mesher=mesher, size=size, cell="quad", through=1)
        )
    except InputError as error:
        if as_given:
            raise error.within(field="mesh", file=study.file) from None
        message = f"the mesh of the mechanics, {size / choice.size:.3g} times as coarse: {error.message}"
        raise InputError(message, field=f"mesh.{error.field}", file=study.file) from None


def _check_memory(study: StudyData, mesher: str, size: float, large: bool) -> None:
    """Raise an error for a mesh whose footprint does not fit into the memory."""

    def nodes(size: float) -> float:
        return QUADRATIC * expected_nodes(study.section, size, mesher=mesher)

    def fits(free: float) -> str:
        length = study.section.line.length
        coarser = estimate.smallest(
            lambda nodal_spacing: estimate.mechanics(nodes(nodal_spacing), large=large).memory <= free, size, length / 4
        )
        return f"{coarser / (size / study.card.mesh.size) * 1e3:g} mm or more would fit" if coarser else ""

    what = f"{study.card.mesh.size * 1e3:g} mm makes {nodes(size):,.0f} nodes of the footprint's finite elements"
    try:
        estimate.check_memory(estimate.mechanics(nodes(size), large=large).memory, what, fits)
    except InputError as error:
        raise error.within(field="mesh.size", file=study.file) from None


@dataclass(frozen=True, eq=False)
class PressedTyre:
    """A study's tyre; every pressure, road and load is solved once. Made by `pressed_tyre`."""

    study: StudyData

    def inflated(self, pressure: float, near: Inflation | None = None) -> Inflation:
        """The tyre under a gauge pressure, Pa; ``near``: a nearby inflated tyre to start from.

        Raises
        ------
        InputError : the pressure is not positive; no equilibrium.
        """
        if pressure <= 0:
            raise InputError("the strain laws 'fem' and 'barrel' need an inflated tyre", field="pressure")
        from tyrefem.mechanics.solid.inflation import inflate

        return self._inflated.get(
            pressure, lambda: inflate(self.study, pressure, mechanical_mesh(self.study), near=near)
        )

    def footprint(self, case: LoadCase, *, large: bool, near: Footprint | None = None) -> Footprint | None:
        """The tyre on the road of a load case, at its load or its deflection; None: the load is zero.

        ``near``: a nearby footprint in large motion to start from (`nearby_balance`). The new one is not kept: what a
        tyre keeps must not depend on the order of its cases.

        Raises
        ------
        InputError : errors of `inflated`; a load that the tyre cannot carry, a deflection that is impossible.
        """
        given = case.deflection if case.by_deflection else case.load
        if given <= 0:
            return None
        name = "deflection" if case.by_deflection else "load"
        if large and near is not None:
            from tyrefem.mechanics.footprint.harmonic_balance import Balance
            from tyrefem.mechanics.footprint.nearby_balance import nearby_balance

            wanted: Any = {name: given}
            footprint = nearby_balance(Balance(self._pressing(case.pressure, case.drum_diameter)), near, **wanted)
            if footprint is not None:
                return footprint
        return self._pressed(name, given, case.pressure, case.drum_diameter, large)

    def under(self, case: LoadCase) -> PressedTyre:
        """This tyre with its moduli at the strain amplitudes of a load case, if the study asks for secant moduli.

        Raises
        ------
        InputError : errors of `footprint`.
        """
        given = case.deflection if case.by_deflection else case.load
        if self.study.card.mechanics.moduli == "card" or given <= 0:
            return self
        name = "deflection" if case.by_deflection else "load"
        return self._softened(name, given, case.pressure, case.drum_diameter)

    @functools.cached_property
    def _softened(self) -> Callable[[str, float, float, float], PressedTyre]:
        from tyrefem.mechanics.footprint.road import Road
        from tyrefem.mechanics.footprint.secant_moduli import under_load

        @functools.lru_cache(REMEMBERED)
        def softened(name: str, given: float, pressure: float, drum: float) -> PressedTyre:
            wanted: Any = {name: given}
            mesh = mechanical_mesh(self.study)
            return PressedTyre(under_load(self.study, mesh, pressure, Road(drum_diameter=drum), **wanted)[0])

        return softened

    @functools.cached_property
    def _inflated(self) -> Cache[Inflation]:
        return Cache(REMEMBERED)

    @functools.cached_property
    def _pressing(self) -> Callable[[float, float], Pressing]:
        from tyrefem.mechanics.footprint.contact import Pressing
        from tyrefem.mechanics.footprint.road import Road

        @functools.lru_cache(REMEMBERED)
        def pressing(pressure: float, drum: float) -> Pressing:
            return Pressing(self.inflated(pressure).state, Road(drum_diameter=drum))

        return pressing

    @functools.cached_property
    def _pressed(self) -> Callable[[str, float, float, float, bool], Footprint]:
        from tyrefem.mechanics.footprint.harmonic_balance import Balance

        @functools.lru_cache(REMEMBERED)
        def pressed(name: str, given: float, pressure: float, drum: float, large: bool) -> Footprint:
            tyre = self._pressing(pressure, drum)
            wanted: Any = {name: given, "tolerance": TOLERANCE}
            return Balance(tyre).solve(**wanted) if large else tyre.solve(**wanted)

        return pressed


#: The latest tyres, by all inputs of their finite elements. A run with other numbers that do not matter here
#: (conductivity, films, sensors) reuses the solved tyre.
REMEMBERED_TYRES: Cache[PressedTyre] = Cache(size=TYRES)


def pressed_tyre(study: StudyData) -> PressedTyre:
    """The tyre of a study; a cached one if all inputs of its finite elements are the same."""
    return REMEMBERED_TYRES.get(inputs(study), lambda: PressedTyre(study))


def inputs(study: StudyData) -> Hashable:
    """All inputs of a study's finite elements except load, pressure and road: equal for equal tyres.

    These are the section, the choice of mesh with its file's content, the choice of moduli, and the card values that
    `materials.reads` names.
    """
    choice = study.card.mesh
    content = ""
    if choice.file is not None:
        path = (study.folder or Path()) / choice.file
        content = hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else ""
    read = values_read("fem", study.materials)
    return study.section, repr(choice), content, study.card.mechanics.moduli, key_of(read)
