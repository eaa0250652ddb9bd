"""A tyre that rolls with friction in a drive: its strains over a revolution, and the friction of its rings."""

from __future__ import annotations

import functools
from collections.abc import Hashable
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.cache import Cache
from tyrefem.errors import InputError
from tyrefem.materials.reads import FEM_ROLLING, values_read
from tyrefem.mechanics.footprint.compliance import interpolation, solved_harmonics
from tyrefem.mechanics.footprint.footprint import Footprint
from tyrefem.mechanics.footprint.pressed_tyre import inputs
from tyrefem.mechanics.rolling.friction_rings import FrictionRings, contact_angles
from tyrefem.mechanics.rolling.lagging_strains import LaggingFootprint
from tyrefem.mechanics.rolling.lossy_harmonics import LossyHarmonics
from tyrefem.mechanics.rolling.roll import TOLERANCE, RolledStudy, WheelOnRoad, friction_card, settled, wheel_on_road
from tyrefem.mechanics.rolling.rolling_motion import RollingMotion
from tyrefem.mechanics.rolling.tread_influence import ON_PLANE, PHASE

if TYPE_CHECKING:
    from tyrefem.inputs.loading import LoadCase
    from tyrefem.inputs.study import StudyData
    from tyrefem.mechanics.footprint.press import Pressed
    from tyrefem.mechanics.rolling.rolled import RolledTyre

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
#: Tyres and wheels whose compliances a process keeps, and rolling states, which are a hundred times smaller.
TYRES, WHEELS, STATES = 2, 2, 64
#: Least speed, m/s, at which friction is asked for its coefficient.
SLOWEST = 0.1


@dataclass(frozen=True, eq=False)
class RollingFields(Brief):
    """Motion of the whole section under the contact forces of a rolling tyre.

    Parameters
    ----------
    tread : its compliance. loads : (harmonics + 1, 3, m) force amplitudes at the section's tread nodes along
        (r, z, t), N per radian. deflection : m.
    """

    tread: Any
    loads: Complex
    deflection: float

    @classmethod
    def of(cls, state: RolledTyre) -> RollingFields:
        """The fields of a rolling tyre; a half section takes the forces of its side."""
        grid = state.grid
        vectors = np.einsum("kax,ka->kx", state.axes, state.contact.forces).reshape(len(grid.angles), -1, 3)
        forces = np.einsum("jpx,jcx->jpc", vectors, grid.wheel_axes)
        _, sides = grid.influence.source
        tread = grid.influence.tread
        if tread.half:
            shares = np.where(np.abs(grid.influence.places[1]) <= ON_PLANE, 0.5, 1.0)
            forces = (forces * shares[:, None])[:, sides > 0]
        n = np.arange(grid.harmonics + 1)
        weights = np.sinc(n * grid.step / (2 * np.pi)) ** 2 / np.where(n == 0, 2 * np.pi, np.pi)
        waves = weights[:, None] * np.exp(-1j * np.multiply.outer(n, grid.angles))
        loads = np.einsum("nj,jpc->ncp", waves, forces) / PHASE[:, None]
        loads[0] = loads[0].real
        return cls(tread, np.asarray(loads), state.deflection)

    @property
    def harmonics(self) -> int:
        """Highest harmonic."""
        return len(self.loads) - 1

    @functools.cached_property
    def amplitudes(self) -> Complex:
        """(harmonics + 1, n_dofs) complex amplitudes U, m, of u = Re((U_r, U_z, -i U_t) e^(i n t))."""
        harmonics = self.tread.harmonics
        dofs = 3 * self.tread.nodes + np.arange(3)[:, None]
        loads = np.zeros((self.harmonics + 1, harmonics.elements.n_dofs), dtype=complex)
        loads[:, dofs.ravel()] = self.loads.reshape(len(loads), -1)
        loads[:, harmonics.held] = 0.0
        if isinstance(harmonics, LossyHarmonics):
            return np.asarray(self.tread.responses(loads))
        weights, moved = interpolation(self.harmonics), np.zeros_like(loads)
        for column, n in enumerate(solved_harmonics(self.harmonics)):
            served = np.flatnonzero(weights[:, column])
            if len(served):
                columns = np.concatenate([loads[served].real, loads[served].imag]).T
                real, imaginary = np.split(harmonics.solve(n, columns).T, 2)
                moved[served] += weights[served, column, None] * (real + 1j * imaginary)
        return moved


@dataclass(frozen=True, eq=False)
class RolledFootprint(LaggingFootprint):
    """The footprint of a tyre that rolls with friction: load, deflection, area and length are those of this tyre.

    Forces, pressure and shape are those of the upright tyre without friction, beside it.

    Parameters
    ----------
    rolling : `RollingFields` of the tyre. travel : m rolled per radian over the share of the speed that the drive's
        slip leaves. friction : of the rings. touched_length, touched_area : m, m2. pressed : the upright tyre.
    """

    friction: FrictionRings | None = None
    touched_length: float = 0.0
    touched_area: float = 0.0
    pressed: Pressed | None = None

    @property
    def tyre(self) -> Pressed:
        """The upright tyre without friction."""
        assert self.pressed is not None
        return self.pressed

    @property
    def length(self) -> float:
        """Greatest length, m."""
        return self.touched_length

    @property
    def area(self) -> float:
        """Contact area, m2."""
        return self.touched_area

    @classmethod
    def of_rolled(cls, rolled: RolledStudy, forward: float) -> RolledFootprint:
        """Of a rolling tyre; ``forward``: `WheelState.forward`."""
        state, upright = rolled.state, rolled.wheel.pressed.footprint
        parts: dict[str, Any] = {part.name: getattr(upright, part.name) for part in fields(Footprint)}
        parts |= {"load": float(state.force[2]), "deflection": state.deflection}
        influence = state.grid.influence
        lengths = contact_angles(state.pressure) * state.grid.step * influence.places[0]
        along, across = (width[influence.source[0]] for width in influence.tread.widths)
        return cls(
            **parts,
            rolling=RollingFields.of(state),
            travel=state.travel * forward,
            friction=FrictionRings.of(rolled),
            touched_length=float(lengths.max()),
            touched_area=float(lengths @ (influence.lengths * across / along)),
            pressed=rolled.wheel.pressed,
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
    key = (_tyre_key(study, case), case)
    return _STATES.get(key, lambda: _rolled(study, case))


def rolled_study(study: StudyData, case: LoadCase) -> RolledStudy:
    """The rolling tyre of a load case as `roll` gives it; with its contact, and not kept."""
    state = case.wheel
    assert state is not None
    wheel = _WHEELS.get((_tyre_key(study, case), _given(case), state.camber), lambda: _wheel(study, case))
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


def _speed(case: LoadCase) -> float:
    """Speed of the wheel's centre, m/s; 1 where nothing depends on it."""
    assert case.wheel is not None
    return max(case.speed / case.wheel.forward, SLOWEST) if case.speed else 1.0


def _tyre_key(study: StudyData, case: LoadCase) -> Hashable:
    frictions = {region: card.friction for region, card in study.materials.items()}
    # A coefficient that is not constant, and loss, are those of the drive's initial temperature.
    warmth = (study.card.drive.initial, tuple((study.parts.temperatures or {}).items()))
    key: tuple[Hashable, ...] = (inputs(study), repr(frictions), case.pressure, case.drum_diameter, _speed(case))
    if any(law is not None and law.law != "constant" for law in frictions.values()):
        key += warmth
    if study.card.mechanics.rolling:
        key += (repr(values_read(FEM_ROLLING, study.materials)), *warmth, _given(case))
    return key


def _wheel(study: StudyData, case: LoadCase) -> WheelOnRoad:
    """The tyre on the road at the camber of a load case."""
    name, given = _given(case)
    wanted: dict[str, Any] = {name: given}

    def pressed() -> WheelOnRoad:
        road = {"pressure": case.pressure, "drum_diameter": case.drum_diameter, "speed": _speed(case)}
        return wheel_on_road(study, motion="linear", **wanted, **road)

    tyre = _TYRES.get(_tyre_key(study, case), pressed)
    if friction_card(tyre.pressed) is None:
        message = "the rubber on the road needs the table [friction] for the law of sliding 'rolling'"
        raise InputError(message, field="friction")
    assert case.wheel is not None
    footprint = tyre.pressed.pressing.solve(**wanted, tolerance=tyre.pressed.tolerance)
    rolling = replace(tyre.rolling, camber=case.wheel.camber, influence=tyre.rolling.points)
    on_road = replace(tyre.pressed, footprint=footprint)
    return WheelOnRoad(on_road, rolling, wanted.get("load"), wanted.get("deflection"), tyre.speed)
