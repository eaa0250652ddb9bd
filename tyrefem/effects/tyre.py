"""Data of the tyre and of its study for effects, as protocols. SI units, degC.

Effects use only these protocols; `tyrefem.simulation.surroundings` and `tyrefem.inputs.study` satisfy them. If an
effect needs more data, add the member here, with its unit.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from tyrefem.boundaries.contained_air import ContainedAirLaw
    from tyrefem.boundaries.outside_air import OutsideAirLaw
    from tyrefem.boundaries.rim import RimLaw
    from tyrefem.boundaries.road import RoadLaw
    from tyrefem.geometry import Section
    from tyrefem.geometry.layer import Rating

Array = NDArray[np.float64]


class Tyre(Protocol):
    """A tyre on its drive: the argument of every port that acts on heat, conduction and boundaries."""

    @property
    def study(self) -> StudyOfTyre:
        """The study of the tyre."""

    @property
    def drive(self) -> DriveOfTyre:
        """Its drive."""

    @property
    def schedule(self) -> LoadSchedule:
        """The load cases over time."""

    @property
    def rated_deflection(self) -> float:
        """Deflection at the rated load and pressure, m."""

    @property
    def tread(self) -> tuple[float, float]:
        """Conductivity through the tread, W/m/K, and its volumetric heat capacity, J/m3/K, at 25 degC."""

    def motion(self, t: float) -> MotionOfTyre:
        """Motion of the wheel at time t (s)."""

    def speed(self, t: float) -> float:
        """Speed over the road at time t (s), m/s: short for ``motion(t).speed``."""

    def ambient(self, t: float) -> float:
        """Ambient temperature at time t (s), degC, with effects."""

    def state(self, effect: object, name: str, t: float) -> float | Array:
        """A state of an effect at time t (s): ``tyre.state(self, "water", t)``."""

    def road_fraction(self, t: float) -> float:
        """Fraction of time that the section is on the road, 0 to 1, at time t (s)."""

    def region(self, zone: str) -> str:
        """The section's region of a strain zone."""

    def places(self, x: Array) -> tuple[Array, Array]:
        """|s| along the meridian from the crown and depth from the inner surface of points x (2, n), m."""


class MotionOfTyre(Protocol):
    """The motion of the wheel at one time."""

    @property
    def speed(self) -> float:
        """Speed of the wheel's centre over the road, m/s."""

    @property
    def rolling_speed(self) -> float:
        """Speed of the tread through the footprint, m/s; 0 for a locked wheel."""

    @property
    def sliding_speed(self) -> float:
        """Speed of the tread over the road, m/s."""

    @property
    def slip_ratio(self) -> float:
        """Longitudinal slip: 1 for a locked wheel."""

    @property
    def revolutions_per_second(self) -> float:
        """Revolutions of the wheel per second, 1/s."""


class LoadSchedule(Protocol):
    """The load cases of a drive, interpolated in time."""

    def mean(self, quantity: Callable[[LoadOnTyre], float], time: float) -> float:
        """A quantity of the load case at a time (s): ``mean(lambda case: case.deflection, t)``."""

    def revolutions_per_second(self, time: float) -> float:
        """Revolutions of the wheel per second, 1/s, at a time (s): short for the tyre's ``motion``."""


class LoadOnTyre(Protocol):
    """A load case."""

    @property
    def load(self) -> float:
        """Vertical load, N."""

    @property
    def deflection(self) -> float:
        """Deflection, m."""

    @property
    def pressure(self) -> float:
        """Gauge pressure, Pa."""


class DriveOfTyre(Protocol):
    """The study's drive."""

    @property
    def initial(self) -> float:
        """Temperature at the start, degC."""

    @property
    def phases(self) -> Sequence[PhaseOfDrive]:
        """The phases in order."""

    def locate(self, time: float) -> tuple[int, float]:
        """Number of the phase at a time (s), and the elapsed fraction of it, 0 to 1."""


class PhaseOfDrive(Protocol):
    """A phase of the drive."""

    @property
    def name(self) -> str:
        """Its name in the study file."""

    @property
    def load(self) -> object | None:
        """None if the drive gives the deflection instead of the load."""

    @property
    def pressure(self) -> PressureOfPhase:
        """Gauge pressure of the phase."""


class PressureOfPhase(Protocol):
    """Gauge pressure during a phase."""

    @property
    def start(self) -> float:
        """Pressure at the start of the phase, Pa."""


class StudyOfTyre(Protocol):
    """Data of a study, to check whether an effect is possible in it."""

    @property
    def card(self) -> CardOfStudy:
        """The study file, validated, in SI."""

    @property
    def section(self) -> Section:
        """The section, worn by the study's effects."""

    @property
    def sensors(self) -> Mapping[str, object]:
        """Thermocouples by name."""


class CardOfStudy(Protocol):
    """The tables of a study file that effects may read."""

    @property
    def drive(self) -> DriveOfTyre:
        """``[drive]``."""

    @property
    def mesh(self) -> MeshOfStudy:
        """``[mesh]``."""

    @property
    def mechanics(self) -> MechanicsOfStudy:
        """``[mechanics]``."""

    @property
    def boundaries(self) -> BoundariesOfStudy:
        """``[boundaries]``."""

    @property
    def effects(self) -> Sequence[object]:
        """All entries of ``[[effects]]``, including those at null."""


class MeshOfStudy(Protocol):
    """``[mesh]`` of a study."""

    @property
    def section(self) -> str:
        """``half`` or ``full``."""

    @property
    def file(self) -> str | None:
        """The user's mesh; None if the section is meshed."""


class MechanicsOfStudy(Protocol):
    """``[mechanics]`` of a study."""

    @property
    def strain(self) -> str:
        """Name of the strain law."""

    @property
    def load_law(self) -> LoadLaw:
        """Load to deflection."""

    @property
    def feedback(self) -> FeedbackOfStudy | None:
        """Settings of the feedback of temperature; None: no feedback."""

    @property
    def rolling(self) -> bool:
        """Whether the strain cycles have the inertia of the rolling tyre."""


class LoadLaw(Protocol):
    """A load-deflection law."""

    @property
    def law(self) -> str:
        """Name in study files."""

    def deflection(self, load: float, pressure: float, tyre: Rating | None) -> float:
        """Deflection, m, at a load (N) and gauge pressure (Pa)."""


class FeedbackOfStudy(Protocol):
    """``[mechanics.feedback]`` of a study."""

    @property
    def pressure(self) -> bool:
        """True if the gauge pressure follows the contained air's temperature."""


class BoundariesOfStudy(Protocol):
    """``[boundaries]`` of a study: one law per side."""

    @property
    def road(self) -> RoadLaw:
        """Tread and road."""

    @property
    def outside_air(self) -> OutsideAirLaw:
        """Outer surface and air."""

    @property
    def contained_air(self) -> ContainedAirLaw:
        """Inner surface and contained air."""

    @property
    def rim(self) -> RimLaw:
        """Bead and rim."""
