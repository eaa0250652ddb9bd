"""A study's tyre, inflated and pressed on the road: the results of the command `tyrefem press`."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.errors import InputError
from tyrefem.inputs.motion import motion_in
from tyrefem.inputs.study_plugins import plugin_summary
from tyrefem.mechanics.footprint.press_order import press_order
from tyrefem.mechanics.footprint.pressed_tyre import TOLERANCE
from tyrefem.mechanics.footprint.secant_moduli import SecantModuli
from tyrefem.threads import one_thread

if TYPE_CHECKING:
    from tyrefem.geometry.meshing.mesh import TyreMesh
    from tyrefem.inputs.published import PublishedComparison
    from tyrefem.inputs.study import StudyData
    from tyrefem.mechanics.footprint.contact import Pressing
    from tyrefem.mechanics.footprint.footprint import Footprint
    from tyrefem.mechanics.footprint.loss import RevolutionLoss
    from tyrefem.mechanics.footprint.strain_harmonics import LinearisationError, StrainHarmonics
    from tyrefem.mechanics.solid.inflation import Inflation

Array = NDArray[np.float64]
#: The load-deflection curve ends at this factor beyond the footprint, or just before the rim.
BEYOND = 1.25
BEFORE_RIM = 0.98


@dataclass(frozen=True, eq=False)
class Pressed(Brief):
    """A study's tyre under one pressure and one load. Made by `press`.

    Parameters
    ----------
    study : the study. mesh : the mechanical mesh. tyre : the inflated tyre.
    pressing : tyre and road with the contact solver. footprint : the tyre on the road.
    tolerance : allowed change with the number of harmonics.
    path : (deflection, load), m and N, of the load steps in large motion; empty: linear about the inflated state.
    moduli : the secant moduli, if the study asks for them; ``study`` then has cards with these.
    turning : the tyre that turns, with ``[mechanics] rolling``; None: it stands while it is pressed.
    path_harmonics : highest harmonic of each load step of ``path``.
    given_speed : m/s, in place of the drive's.
    """

    study: StudyData
    mesh: TyreMesh
    tyre: Inflation
    pressing: Pressing
    footprint: Footprint
    tolerance: float = TOLERANCE
    path: tuple[tuple[float, float], ...] = ()
    moduli: SecantModuli | None = None
    path_harmonics: tuple[int, ...] = ()
    turning: TurningTyre | None = None
    given_speed: float | None = None

    def _title(self) -> str:
        return f"tyre of {self.study.name}"

    def _facts(self) -> Mapping[str, Any]:
        return self.footprint._facts()

    @property
    def balanced(self) -> bool:
        """True if the footprint is in large motion."""
        return self.footprint.motion == "large"

    @property
    def bead_tension(self) -> float | None:
        """Hoop force of one bead, N; None: the section has no bead wires."""
        try:
            return self.tyre.bead_tension
        except InputError:
            return None

    @property
    def secant_stiffness(self) -> float:
        """Load over deflection, N/m."""
        return self.footprint.load / self.footprint.deflection

    @property
    def peak_pressure(self) -> float:
        """Largest contact pressure, Pa; at a sharp edge of the tread it depends on the mesh."""
        return float(self.footprint.pressure.max())

    @property
    def accuracy(self) -> str:
        """Number of harmonics and error, in words; in large motion the number has a limit, whatever the tolerance."""
        footprint, allowed = self.footprint, f"{100 * self.tolerance:.3g}%"
        more = f"more than the {allowed} wanted: large motion takes no more harmonics"
        verdict = more if footprint.error > self.tolerance else f"allowed {allowed}"
        return f"{footprint.harmonics}, error {footprint.error:.2%} ({verdict})"

    @property
    def speed(self) -> float:
        """The given speed, or that at the start of the drive's first phase, m/s; at its end if it starts at rest."""
        return speed_of(self.study) if self.given_speed is None else self.given_speed

    @functools.cached_property
    def cycle(self) -> StrainHarmonics:
        """Strains over a revolution."""
        from tyrefem.mechanics.footprint.strain_harmonics import StrainHarmonics

        return StrainHarmonics(self.footprint) if self.turning is None else self.turning.cycle

    @property
    def linearisation_error(self) -> LinearisationError:
        """What linear strains leave out."""
        return self.cycle.linearisation_error

    @functools.cached_property
    def loss(self) -> RevolutionLoss | None:
        """Loss per revolution at `speed` and the drive's initial temperature; None: the wheel is at rest."""
        from tyrefem.mechanics.footprint.loss import RevolutionLoss

        if not self.speed:
            return None
        cards = {region: self.study.materials[region] for region in self.tyre.body.parts}
        return RevolutionLoss.of_cards(self.cycle, cards, self.speed, self.study.card.drive.initial)

    @property
    def published(self) -> tuple[PublishedComparison, ...]:
        """The results with the study's published ranges."""
        from tyrefem.inputs.published import compared, of_footprint

        values = of_footprint(self.footprint)
        if self.loss is not None:
            values["rolling_resistance_coefficient"] = self.loss.coefficient
        return compared(self.study.card.published, values)

    def curve(self, count: int = 10) -> Array:
        """(n, 2) deflection, m, and load, N, from zero load, with the same number of harmonics as the footprint; in
        large motion the footprint after its load steps, whose few harmonics make the load up to a quarter too high."""
        if self.balanced:
            return np.array([*(step[:2] for step in self._before), (self.footprint.deflection, self.footprint.load)])
        last = min(BEYOND * self.footprint.deflection, BEFORE_RIM * self.pressing.bottoming)
        deflections = np.linspace(0.0, last, count + 1)
        # The largest first: its grid of angles is used for the others.
        loads = [
            self.pressing.at_deflection(float(point), self.footprint.harmonics).load for point in deflections[:0:-1]
        ]
        return np.column_stack([deflections, [0.0, *loads[::-1]]])

    def curve_harmonics(self, curve: Array) -> Array:
        """(n,) highest harmonic of each point of a `curve`; in large motion that of its load step, and at the last
        point that of the footprint."""
        if self.balanced:
            return np.array([*(step[2] for step in self._before), self.footprint.harmonics])
        return np.full(len(curve), self.footprint.harmonics)

    @property
    def _before(self) -> list[tuple[float, float, int]]:
        """(deflection, load, highest harmonic), m and N, of the load steps short of the footprint."""
        end = 0.99 * self.footprint.deflection
        return [(*point, n) for point, n in zip(self.path, self.path_harmonics, strict=True) if point[0] < end]

    def summary(self) -> dict[str, Any]:
        """All results in SI as the keys state, with versions, mesh and tolerance."""
        from tyrefem.output import versions

        footprint, loss = self.footprint, self.loss
        cords = {
            region: {"strain": layer.strain, "stress_Pa": layer.stress, "tension_N": layer.tension}
            for region, layer in self.tyre.cord_tensions.items()
        }
        return {
            "study": self.study.name,
            "title": self.study.title,
            "pressure_Pa": self.tyre.pressure,
            "drum_diameter_m": self.pressing.road.drum_diameter,
            "camber_rad": self.pressing.road.camber,
            "radius_growth_m": self.tyre.radius_growth,
            "width_growth_m": self.tyre.width_growth,
            "cords_least_mean_greatest": cords,
            "bead_tension_N": self.bead_tension,
            "load_N": footprint.load,
            "deflection_m": footprint.deflection,
            "bottoming_deflection_m": self.pressing.bottoming,
            "secant_stiffness_N_m": self.secant_stiffness,
            "tangent_stiffness_N_m": footprint.stiffness,
            "footprint_length_m": footprint.length,
            "footprint_width_m": footprint.width,
            "footprint_area_m2": footprint.area,
            "mean_contact_pressure_Pa": footprint.mean_pressure,
            "peak_contact_pressure_Pa": self.peak_pressure,
            "loaded_radius_m": footprint.loaded_radius,
            "rolling_radius_m": footprint.rolling_radius,
            "speed_m_s": self.speed,
            "temperature_degC": self.study.card.drive.initial,
            "loss_per_revolution_J": loss.energy if loss else None,
            "rolling_resistance_N": loss.rolling_resistance if loss else None,
            "rolling_resistance_coefficient": loss.coefficient if loss else None,
            "published": [value.to_dict() for value in self.published],
            "harmonics": footprint.harmonics,
            "error": footprint.error,
            "motion": footprint.motion,
            "balanced": self.balanced,
            "left_out_by_linear_strains": asdict(self.linearisation_error),
            "tolerance": self.tolerance,
            "unstable_harmonics": list(footprint.unstable),
            "secant_moduli": None if self.moduli is None else asdict(self.moduli),
            **({} if self.turning is None else {"rolling": self.turning.summary()}),
            "mesh": {**self.mesh.summary(), "nodes_of_nine_node_elements": self.tyre.body.rings.n_nodes},
            "versions": versions(),
            **plugin_summary(self.study),
        }


class TurningTyre(Protocol):
    """What a pressed tyre that turns gives (`rolling.turning.Turning`)."""

    @property
    def tyre(self) -> Inflation:
        """Inflated and spinning."""

    @property
    def pressing(self) -> Pressing:
        """Tyre and road."""

    @property
    def footprint(self) -> Footprint:
        """The footprint."""

    @property
    def path(self) -> tuple[tuple[float, float], ...]:
        """Load steps in large motion."""

    @property
    def path_harmonics(self) -> tuple[int, ...]:
        """Their harmonics."""

    @property
    def cycle(self) -> StrainHarmonics:
        """Strains over a revolution."""

    @property
    def words(self) -> str:
        """One line."""

    def summary(self) -> dict[str, Any]:
        """Results in SI."""


def speed_of(study: StudyData) -> float:
    """Speed at the start of the drive's first phase, m/s; at its end if it starts at rest."""
    phase = study.card.drive.phases[0]
    return motion_in(phase, 0.0).speed or motion_in(phase, 1.0).speed


@one_thread()
def press(
    study: StudyData,
    *,
    pressure: float | None = None,
    load: float | None = None,
    deflection: float | None = None,
    drum_diameter: float | None = None,
    camber: float = 0.0,
    tolerance: float = TOLERANCE,
    motion: str | None = None,
) -> Pressed:
    """Inflate a study's tyre and press it on the road; defaults are the values at the start of the drive's first phase.

    Parameters
    ----------
    study : the study.
    pressure : Pa above the ambient, positive.
    load, deflection : N or m, positive; at most one of them.
    drum_diameter : m; infinite for a flat road.
    camber : rad; positive: the side z > 0 moves down. A half section is completed by its mirror image.
    tolerance : allowed change with the number of harmonics.
    motion : ``"large"``, or ``"linear"`` about the inflated state: the quick look. By default that of the study's
        ``[mechanics]``.

    Raises
    ------
    InputError : a campaign; a value that is not positive; both load and deflection; an unknown motion; no equilibrium;
        a load that the tyre cannot carry.

    >>> from tyrefem import study
    >>> pressed = press(study("nasa-22x5.5-8pr", {"mesh.size": "12 mm"}), deflection=0.015)
    >>> pressed.footprint.deflection, 3e5 < pressed.secant_stiffness < 6e5
    (0.015, True)
    """
    from tyrefem.mechanics.footprint.contact import Pressing
    from tyrefem.mechanics.solid.inflation import inflate

    options: dict[str, Any] = {"load": load, "deflection": deflection, "drum_diameter": drum_diameter, "camber": camber}
    order = press_order(study, pressure=pressure, **options, tolerance=tolerance, motion=motion)
    tyre = inflate(order.study, order.pressure, order.mesh)
    pressing = Pressing(tyre.state, order.road)
    if not order.large:
        footprint = pressing.solve(**order.wanted)
        return Pressed(order.study, order.mesh, tyre, pressing, footprint, order.tolerance, moduli=order.moduli)
    from tyrefem.mechanics.footprint.harmonic_balance import Balance

    balance = Balance(pressing)
    footprint = balance.solve(**order.wanted)
    path = (tuple(balance.path), order.moduli, tuple(balance.path_harmonics))
    return Pressed(order.study, order.mesh, tyre, pressing, footprint, order.tolerance, *path)
