"""What is to be pressed: the checked options of a press, with the defaults of the drive's first phase."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, get_args

from tyrefem.errors import InputError, nearest
from tyrefem.estimates import work as estimate
from tyrefem.geometry.meshing.expected import QUADRATIC
from tyrefem.inputs.loading import check_drum
from tyrefem.inputs.study_card import FootprintMotion
from tyrefem.mechanics.footprint.footprint import QUICK_LOOK
from tyrefem.mechanics.footprint.pressed_tyre import TOLERANCE, mechanical_mesh
from tyrefem.mechanics.footprint.road import Road
from tyrefem.mechanics.footprint.secant_moduli import SecantModuli, under_load
from tyrefem.requirements import Requirements

if TYPE_CHECKING:
    from tyrefem.geometry.meshing.mesh import TyreMesh
    from tyrefem.inputs.study import StudyData

#: Requirements of a footprint on the study.
NEEDS = Requirements("a footprint")
MOTIONS = get_args(FootprintMotion)


@dataclass(frozen=True)
class PressOrder:
    """What is to be pressed. Made by `press_order`.

    Parameters
    ----------
    study : with the secant moduli, if it asks for them. mesh : the mechanical mesh. pressure : Pa. road : the road.
    load, deflection : N or m, one of them. tolerance : with the number of harmonics. large : large motion.
    moduli : the secant moduli.
    """

    study: StudyData
    mesh: TyreMesh
    pressure: float
    road: Road
    load: float | None
    deflection: float | None
    tolerance: float
    large: bool
    moduli: SecantModuli | None = None

    @property
    def wanted(self) -> dict[str, Any]:
        """What a solver of footprints takes."""
        return {"load": self.load, "deflection": self.deflection, "tolerance": self.tolerance}


def press_order(
    study: StudyData,
    *,
    pressure: float | None = None,
    load: float | None = None,
    deflection: float | None = None,
    drum_diameter: float | None = None,
    camber: float = 0.0,
    tolerance: float = TOLERANCE,
    motion: str | None = None,
) -> PressOrder:
    """Checked options of `press.press`, with the defaults of the drive's first phase; raises the same errors."""
    NEEDS.check(study)
    motion = study.card.mechanics.motion if motion is None else motion
    if motion not in MOTIONS:
        raise InputError(f"no motion '{motion}'{nearest(motion, MOTIONS)}", field="motion")
    large = motion == "large"
    phase = study.card.drive.phases[0]
    if load is not None and deflection is not None:
        raise InputError("give a load or a deflection, not both", field="load")
    if load is None and deflection is None:
        load = None if phase.load is None else phase.load.start
        deflection = None if phase.deflection is None else phase.deflection.start
    pressure = phase.pressure.start if pressure is None else pressure
    wanted = {"pressure": (pressure, "Pa"), "load": (load, "N"), "deflection": (deflection, "m")}
    for name, (value, unit) in wanted.items():
        if value is not None and not value > 0:
            raise InputError(f"must be more than 0 {unit}, not {value:g} {unit}", field=name)
    drum = phase.drum_diameter if drum_diameter is None else drum_diameter
    if drum > 0:
        check_drum(drum, study.section.outer_diameter)
    road = Road(drum, camber)
    if camber and study.section.half:
        study = study.replace({"mesh.section": "full"})
    mesh = mechanical_mesh(study, large=large)
    nodes = QUADRATIC * mesh.n_nodes
    estimate.warn_if_long(
        estimate.mechanics(nodes, large=large).time,
        f"the footprint of {nodes:,} nodes",
        lambda: f"; {QUICK_LOOK}" if large else "",
    )
    moduli = None
    if study.card.mechanics.moduli == "secant":
        study, moduli = under_load(study, mesh, pressure, road, load=load, deflection=deflection)
    return PressOrder(study, mesh, pressure, road, load, deflection, tolerance, large, moduli)
