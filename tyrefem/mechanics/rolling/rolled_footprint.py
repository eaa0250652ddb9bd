"""A tyre that rolls with friction in a drive: its strains over a revolution, and the friction of its rings."""

from __future__ import annotations

import functools
from collections.abc import Hashable
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.cache import Cache
from tyrefem.errors import InputError
from tyrefem.materials.reads import FEM_ROLLING, key_of, values_read
from tyrefem.mechanics.footprint.footprint import Footprint
from tyrefem.mechanics.footprint.pressed_tyre import inputs
from tyrefem.mechanics.footprint.strain_harmonics import StrainHarmonics
from tyrefem.mechanics.rolling.contact_patch import ContactPatch
from tyrefem.mechanics.rolling.friction_rings import FrictionRings
from tyrefem.mechanics.rolling.lagging_strains import LaggingFootprint, LaggingStrains, strain_amplitudes
from tyrefem.mechanics.rolling.roll import TOLERANCE, RolledStudy, settled
from tyrefem.mechanics.rolling.rolling_motion import RollingMotion
from tyrefem.mechanics.rolling.section_fields import SectionFields
from tyrefem.mechanics.rolling.wheel_on_road import WheelOnRoad, friction_card, tread_friction, wheel_on_road

if TYPE_CHECKING:
    from tyrefem.inputs.loading import LoadCase
    from tyrefem.inputs.study import StudyData
    from tyrefem.mechanics.footprint.press import Pressed

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
#: Tyres and wheels whose compliances a process keeps, and rolling states, which are a hundred times smaller.
TYRES, WHEELS, STATES = 2, 2, 64
#: Least speed, m/s, at which the coefficient of friction is evaluated.
SLOWEST = 0.1


@dataclass(frozen=True, eq=False)
class RolledStrains(LaggingStrains):
    """Strains of a `RolledFootprint`. In large motion: Green's of the pressed tyre, turned round the wheel as its shape
    is, and the linear strains of the forces that friction adds.

    ``side`` : of `SectionFields.sides`; None: of a half section, its symmetric motion.
    """

    side: int | None = None

    @functools.cached_property
    def amplitudes(self) -> Any:
        """(harmonics + 1, 6, n_elements, n_points) complex E_n."""
        footprint = self.footprint
        assert isinstance(footprint, RolledFootprint)
        added = strain_amplitudes(self.elements, footprint.added(self.side))
        if footprint.balanced is None:
            return added
        return _sum(footprint.turned(StrainHarmonics(footprint.tyre.footprint).amplitudes), added)


def _sum(first: Complex, second: Complex) -> Complex:
    """Sum of amplitudes (harmonics + 1, ...) with different highest harmonics."""
    total = np.zeros((max(len(first), len(second)), *first.shape[1:]), dtype=complex)
    total[: len(first)] += first
    total[: len(second)] += second
    return total


@dataclass(frozen=True, eq=False)
class RolledFootprint(LaggingFootprint):
    """The footprint of a tyre that rolls with friction: load, deflection and size are those of this tyre.

    ``error`` is that of `RolledStudy`. Forces, pressure and shape are those of the upright tyre without friction.

    Parameters
    ----------
    rolling : `SectionFields` of the tyre; in large motion those of the forces that friction adds.
    travel : m rolled per radian over the share of the speed that the drive's slip leaves. friction : of the rings.
    patch : size of the contact. rolled_harmonics : highest of them. pressed : the upright tyre.
    turn : rad, of the pressed shape round the wheel in large motion.
    """

    friction: FrictionRings | None = None
    patch: ContactPatch | None = None
    rolled_harmonics: int = 0
    pressed: Pressed | None = None
    turn: float = 0.0

    @property
    def cycle(self) -> RolledStrains:
        """Strains over a revolution."""
        return RolledStrains(self)

    @property
    def sides(self) -> tuple[RolledStrains, ...]:
        """Strains of a full section; of a half section, of the side z > 0 and of the mirror image of the other."""
        assert isinstance(self.rolling, SectionFields)
        return tuple(RolledStrains(self, side) for side in range(1 if self.rolling.antisymmetric is None else 2))

    def added(self, side: int | None = None) -> Complex:
        """(harmonics + 1, n_dofs) motion of `rolling`, m; ``side``: as `RolledStrains`."""
        assert isinstance(self.rolling, SectionFields)
        return self.rolling.amplitudes if side is None else self.rolling.sides[side]

    def turned(self, amplitudes: Array) -> Complex:
        """Amplitudes (harmonics + 1, ...) of the pressed tyre, turned round the wheel as its shape is."""
        turn = np.exp(1j * self.turn * np.arange(len(amplitudes)))
        return np.asarray(turn.reshape(-1, *np.ones(amplitudes.ndim - 1, dtype=int)) * amplitudes)

    def motion_of(self, side: int) -> Complex:
        """(harmonics + 1, n_dofs) amplitudes U, m, of the whole motion beyond inflation, u = Re((U_r, U_z, -i U_t)
        e^(i n t)), of one of `sides`."""
        added = self.added(side)
        return added if self.balanced is None else _sum(self.turned(self.tyre.footprint.amplitudes), added)

    @property
    def tyre(self) -> Pressed:
        """The upright tyre without friction."""
        assert self.pressed is not None
        return self.pressed

    @property
    def touched(self) -> ContactPatch:
        """Size and pressure of the contact."""
        assert self.patch is not None
        return self.patch

    @property
    def length(self) -> float:
        """Greatest length, m."""
        return self.touched.length

    @property
    def width(self) -> float:
        """Axial extent of the contact, m, with the grooves between."""
        return self.touched.width

    @property
    def area(self) -> float:
        """Contact area, m2."""
        return self.touched.area

    @property
    def contact_harmonics(self) -> int:
        """Highest harmonic of the contact with friction."""
        return self.rolled_harmonics

    @classmethod
    def of_rolled(cls, rolled: RolledStudy, forward: float) -> RolledFootprint:
        """Of a rolling tyre; ``forward``: `WheelState.forward`."""
        state, upright = rolled.state, rolled.wheel.pressed.footprint
        parts: dict[str, Any] = {part.name: getattr(upright, part.name) for part in fields(Footprint)}
        parts |= {"load": float(state.force[2]), "deflection": state.deflection, "error": rolled.error}
        return cls(
            **parts,
            rolling=state.added_fields,
            travel=state.travel * forward,
            friction=FrictionRings.of(rolled),
            patch=state.patch,
            rolled_harmonics=state.harmonics,
            pressed=rolled.wheel.pressed,
            turn=state.grid.turn,
        )


#: The latest inflated tyres, wheels and rolling states, by all inputs of each.
_TYRES: Cache[WheelOnRoad] = Cache(size=TYRES)
_WHEELS: Cache[WheelOnRoad] = Cache(size=WHEELS)
_STATES: Cache[RolledFootprint] = Cache(size=STATES)


def rolled_footprint(study: StudyData, case: LoadCase) -> RolledFootprint:
    """The tyre of a load case with a `WheelState`, in steady rolling with the friction of its tread's card.

    Each pressure and drum is inflated once, each state solved once in a process (`STATES`). With
    ``[mechanics] rolling`` the tyre spins, so each load and speed is inflated.

    Raises
    ------
    InputError : no ``[friction]`` on the card of the rubber on the road; a load, torque or slip that the contact
        cannot carry.
    """
    key = (_tyre_key(study, case), _warm(study, case), case)
    return _STATES.get(key, lambda: _rolled(study, case))


def rolled_study(study: StudyData, case: LoadCase) -> RolledStudy:
    """The rolling tyre of a load case as `roll` gives it; with its contact, and not kept."""
    state = case.wheel
    assert state is not None
    key = (_tyre_key(study, case), _given(case), state.camber, _warm(study, case))
    wheel = _WHEELS.get(key, lambda: _wheel(study, case))
    along = {"torque": state.torque or 0.0} if state.slip is None else {"slip": state.slip}
    try:
        return settled(wheel, RollingMotion(state.slip_angle), along, TOLERANCE)
    except InputError as error:
        if state.torque and error.field is None:
            message = f"{error.message}: {state.torque:.5g} N m are beyond the grip that is left"
            raise InputError(message, field="torque") from None
        raise


def _rolled(study: StudyData, case: LoadCase) -> RolledFootprint:
    assert case.wheel is not None
    return RolledFootprint.of_rolled(rolled_study(study, case), case.wheel.forward)


def _given(case: LoadCase) -> tuple[str, float]:
    return ("deflection", case.deflection) if case.by_deflection else ("load", case.load)


def _speed(study: StudyData, case: LoadCase) -> float:
    """Speed of the wheel's centre, m/s; 1 where nothing depends on it."""
    assert case.wheel is not None
    laws = (card.friction for card in study.materials.values())
    if not case.speed and not any(law is not None and law.depends_on_speed for law in laws):
        return 1.0
    return max(case.speed / case.wheel.forward, SLOWEST)


def _warm(study: StudyData, case: LoadCase) -> float | None:
    """Temperature of the coefficient of friction, degC; None where it does not depend on it."""
    if not any(card.friction is not None and card.friction.follows_temperature for card in study.materials.values()):
        return None
    assert case.wheel is not None
    given = case.wheel.tread_temperature
    return float(study.card.drive.initial) if given is None else given


def _tyre_key(study: StudyData, case: LoadCase) -> Hashable:
    frictions = {region: card.friction for region, card in study.materials.items()}
    speed = _speed(study, case)
    key: tuple[Hashable, ...] = (inputs(study), key_of(frictions), case.pressure, case.drum_diameter, speed)
    if study.card.mechanics.rolling:
        # Loss is that of the regions' temperatures.
        warmth = (study.card.drive.initial, tuple((study.parts.temperatures or {}).items()))
        key += (key_of(values_read(FEM_ROLLING, study.materials)), *warmth, _given(case))
    if study.card.mechanics.motion == "large" or study.card.mechanics.moduli == "secant":
        key += (_given(case),)
    return (study.card.mechanics.motion, *key)


def _wheel(study: StudyData, case: LoadCase) -> WheelOnRoad:
    """The tyre on the road at the camber of a load case."""
    name, given = _given(case)
    wanted: dict[str, Any] = {name: given}

    def pressed() -> WheelOnRoad:
        road = {"pressure": case.pressure, "drum_diameter": case.drum_diameter, "speed": _speed(study, case)}
        return wheel_on_road(study, motion=study.card.mechanics.motion, **wanted, **road)

    tyre = _TYRES.get(_tyre_key(study, case), pressed)
    if friction_card(tyre.pressed) is None:
        message = "the rubber on the road needs the table [friction] for the law of sliding 'rolling'"
        raise InputError(message, field="friction")
    assert case.wheel is not None
    footprint = tyre.pressed.footprint
    if not tyre.pressed.balanced:
        footprint = tyre.pressed.pressing.solve(**wanted, tolerance=tyre.pressed.tolerance)
    friction = tread_friction(tyre.pressed, _warm(study, case))
    rolling = replace(tyre.rolling, camber=case.wheel.camber, friction=friction, influence=tyre.rolling.points)
    on_road = replace(tyre.pressed, footprint=footprint)
    return WheelOnRoad(on_road, rolling, wanted.get("load"), wanted.get("deflection"), tyre.speed)
