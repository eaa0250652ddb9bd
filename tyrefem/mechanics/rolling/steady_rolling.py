"""A tyre that rolls steadily on a road with friction, in small motion about the inflated tyre."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from tyrefem.brief import Brief
from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.complementarity import contact_forces
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.road import Road
from tyrefem.mechanics.rolling.coefficient_search import CoefficientSearch, FrictionLaw
from tyrefem.mechanics.rolling.contact_body import ContactBody
from tyrefem.mechanics.rolling.friction import ACCURACY, Control, RollingContact
from tyrefem.mechanics.rolling.loaded_compliance import LoadedCompliance
from tyrefem.mechanics.rolling.pressed_shape import PressedShape
from tyrefem.mechanics.rolling.rolled import TORQUE, RolledTyre
from tyrefem.mechanics.rolling.rolling_grid import ANGLES_BEYOND, RollingGrid
from tyrefem.mechanics.rolling.rolling_motion import RollingMotion
from tyrefem.mechanics.rolling.tread_influence import TreadInfluence

Array = NDArray[np.float64]
#: Relative change of the forces at which geometry and friction have settled; rounds before giving up.
SETTLED, ROUNDS = 1e-7, 60
#: Change of the share of the first step in contact at which it has settled; rounds before it is left as it is.
FRONT_SETTLED, FRONT_ROUNDS = 0.05, 3
#: Rounds in which forces on the loaded tyre are made known, and the change of forces at which a round ends.
LOADED_ROUNDS, ON_THE_WAY = 12, 1e-3
#: Residual of the contact in a round over the change of forces at which rounds end.
CONTACT = 1e-2
#: With a law of friction a few points may stick and slip in turn: after so many rounds the change of all forces
#: together may be this.
PATIENCE, SETTLED_LAW = 16, 5e-4


@dataclass(frozen=True)
class RollingLoads:
    """What is given of a rolling wheel.

    Parameters
    ----------
    load : N; or deflection : m.
    travel : m the wheel travels per radian of its turn; or torque : N m about the axle, positive drives; or
        force : N of the road on the tyre, forward.
    """

    load: float | None = None
    deflection: float | None = None
    travel: float | None = None
    torque: float | None = None
    force: float | None = None

    def __post_init__(self) -> None:
        if (self.load is None) == (self.deflection is None):
            raise InputError("give exactly one of 'load' and 'deflection'")
        if sum(value is not None for value in (self.travel, self.torque, self.force)) != 1:
            raise InputError("give exactly one of 'travel', 'torque' and 'force'")


@dataclass(frozen=True, eq=False)
class SteadyRolling(Brief):
    """A tyre with friction between tread and road.

    Parameters
    ----------
    pressing : the inflated tyre on its road, without camber if it is a half section.
    camber : rad; positive: the side z > 0 moves down.
    friction : coefficient, or its law of sliding speed and pressure.
    influence : points of the whole tread, with loss where it counts; None: those of ``pressing``, without.
    shape : of the tyre pressed in large motion, from which friction moves it; None: of the inflated tyre.
    """

    pressing: Pressing
    camber: float = 0.0
    friction: float | FrictionLaw = 1.0
    influence: TreadInfluence | None = None
    shape: PressedShape | None = None
    #: The loaded tyre's motions that solutions made known: the next begins with them.
    _loaded: list[LoadedCompliance] = field(default_factory=list, init=False, repr=False)

    def __post_init__(self) -> None:
        if isinstance(self.friction, int | float) and not 0 <= self.friction < math.inf:
            raise InputError(f"must be at least 0, not {self.friction:g}", field="friction")

    @functools.cached_property
    def road(self) -> Road:
        """The road, leaning against the wheel."""
        return Road(self.pressing.road.drum_diameter, self.camber)

    @functools.cached_property
    def points(self) -> TreadInfluence:
        """Points of the whole tread and their compliance."""
        return TreadInfluence(self.pressing.tread) if self.influence is None else self.influence

    @functools.cached_property
    def reach(self) -> float:
        """Reach of the free tyre towards the road, m."""
        return self.road.lowest(self.points.places)

    def roll(
        self,
        motion: RollingMotion,
        given: RollingLoads,
        harmonics: int,
        start: RolledTyre | None = None,
        guess: tuple[float, float] | None = None,
    ) -> RolledTyre:
        """The rolling tyre with harmonics up to a number.

        On a flat road with a constant coefficient of friction one contact problem is solved. On a drum, on a curved
        path, or with a law of friction, geometry and coefficient follow the last solution until the forces settle.

        Parameters
        ----------
        start : a similar rolling tyre with as many harmonics, where the search begins.
        guess : deflection, m, and travel per radian, m, where it begins otherwise.

        Raises
        ------
        InputError : a deflection beyond the rim, or a load, torque or force that the contact cannot carry.
        """  # fmt: skip
        if start is not None and self._loaded:
            start = replace(start, grid=start.grid.loaded(self._loaded[0]))
        if self.shape is None or self.shape.loaded is None:
            return self._settled(motion, given, harmonics, start, guess)
        accuracy = ON_THE_WAY
        rolled = self._settled(motion, given, harmonics, start, guess, accuracy)
        for _ in range(LOADED_ROUNDS):
            grid, forces = rolled.grid, rolled.grid.shape_forces
            assert grid.shape is not None
            assert grid.shape.loaded is not None
            assert forces is not None
            added = np.moveaxis(rolled.components, 2, 1) - forces
            loaded = grid.shape.loaded.knowing(grid.points_on_wheel(), added)
            if loaded is not grid.shape.loaded:
                self._loaded[:] = [loaded]
                rolled = replace(rolled, grid=grid.loaded(loaded))
            elif accuracy == SETTLED:
                return rolled
            else:
                accuracy = SETTLED
            rolled = self._settled(motion, given, harmonics, rolled, guess, accuracy)
        return rolled if accuracy == SETTLED else self._settled(motion, given, harmonics, rolled, guess)

    def _settled(
        self,
        motion: RollingMotion,
        given: RollingLoads,
        harmonics: int,
        start: RolledTyre | None,
        guess: tuple[float, float] | None,
        accuracy: float = SETTLED,
    ) -> RolledTyre:
        """`roll` with the motions of the loaded tyre that are known, until forces change by less than ``accuracy`` of
        the largest."""
        if guess is None:
            guess = (0.1 * self.pressing.bottoming, self.reach) if start is None else (start.deflection, start.travel)
        guess = (
            guess[0] if given.deflection is None else given.deflection,
            guess[1] if given.travel is None else given.travel,
        )
        self.pressing.check(guess[0])
        grid = self._near(harmonics, guess[0]) if start is None else start.grid
        last, before, search = start, None, CoefficientSearch(self.friction)
        if start is not None and not callable(self.friction):
            before = start.contact.forces
        front = None if start is None else start.before
        exact = max(CONTACT * accuracy, ACCURACY)
        for number in range(ROUNDS):
            rolled = self._solved(grid, motion, given, guess, last, search.of(grid, last), front, exact)
            wider = grid.around(rolled.contact.forces[:, 0] > 0, 1)
            guess, last = (rolled.deflection, rolled.travel), rolled
            if wider is not grid:
                grid, before, front = wider, None, None
                last = None
                continue
            if self.shape is not None:
                grid = grid.turned(self._turn(rolled))
            forces = rolled.contact.forces
            loosely = callable(self.friction) and number >= PATIENCE
            size, settled = (np.sum, SETTLED_LAW) if loosely else (np.max, accuracy)
            change = math.inf if before is None else float(size(np.abs(forces - before)))
            fronted = self._fronted(rolled, front) or number >= FRONT_ROUNDS
            # A front that goes to and fro between two steps is left where it is.
            front = front if fronted else rolled.before
            if fronted and (self._closed(motion) or change <= settled * float(size(np.abs(forces)))):
                self.pressing.check(rolled.deflection)
                return rolled
            before = forces
        raise InputError(f"forces, geometry and friction of the rolling contact do not settle in {ROUNDS} rounds")

    def _common(self, grid: RollingGrid, axes: Array, last: RolledTyre | None) -> tuple[Array, Array] | None:
        """`ContactBody.common`: motions of the loaded tyre, and, near a ``last`` round, that of the pressed shape where
        it turns."""
        motions, weights = [], []
        if grid.motions is not None:
            motions.append(np.einsum("kax,kxn->kan", axes, grid.motions[0]))
            weights.append(grid.motions[1])
        if self.shape is not None and last is not None:
            rate = grid.shape_rate(last.vectors)
            stiffness = float((rate * grid.rate(last.vectors)).sum())
            if stiffness > 0:
                motions.append(grid.along(axes, rate)[..., None])
                weights.append(np.array([[1 / stiffness]]))
        return (np.concatenate(motions, axis=-1), block_diag(*weights)) if motions else None

    def _fronted(self, rolled: RolledTyre, used: Array | None) -> bool:
        """True if the front of the contact is where a solution took it to be."""
        if self.friction == 0:
            return True
        return used is not None and bool(np.abs(used - rolled.before).max() <= FRONT_SETTLED)

    def _closed(self, motion: RollingMotion) -> bool:
        """True if a contact problem does not depend on its solution."""
        level = math.isinf(self.road.drum_diameter) and not motion.turn_slip
        return level and not callable(self.friction) and self.shape is None

    @staticmethod
    def _turn(rolled: RolledTyre) -> float:
        """Angle, rad, by which the pressed shape turns until the forces do no work in turning it further."""
        forces = rolled.vectors
        rate = rolled.grid.shape_rate(forces)
        stiffness = float((rate * rolled.grid.rate(forces)).sum())
        return float((rate * forces).sum()) / stiffness if stiffness > 0 else 0.0

    def _near(self, harmonics: int, deflection: float) -> RollingGrid:
        """The angles of the frictionless footprint, and `ANGLES_BEYOND` on both sides."""
        half_angle = self.road.half_angle(self.reach, deflection)
        side = min(math.ceil(1.1 * half_angle / math.pi * harmonics) + 1, harmonics - 1)
        grid = RollingGrid(self.points, self.road, harmonics, -side, side, self.shape)
        if self._loaded:
            grid = grid.loaded(self._loaded[0])
        gaps, normals = grid.gaps(np.zeros((grid.n_points, 3)), self.reach - deflection)
        _, closed = contact_forces(grid.normal_compliance(normals), gaps, symmetric=not self.points.lossy)
        if not closed.any():
            raise InputError("the tyre does not touch the road", field="deflection")
        return grid.around(closed, ANGLES_BEYOND)

    def _solved(
        self,
        grid: RollingGrid,
        motion: RollingMotion,
        given: RollingLoads,
        guess: tuple[float, float],
        last: RolledTyre | None,
        friction: Array,
        front: Array | None,
        accuracy: float,
    ) -> RolledTyre:
        """Contact with the geometry of the ``last`` solution and coefficients of ``friction`` (k,); ``front``:
        `RolledTyre.before`; ``accuracy`` of the contact."""
        moved = np.zeros((grid.n_points, 3)) if last is None else last.moved
        gaps, normals = grid.gaps(moved, self.reach - (given.deflection or 0.0))
        axes = grid.road_axes(normals)
        gaps = gaps + np.einsum("kx,kx->k", normals, moved)
        before = None if self.friction == 0 else front
        turns = grid.turns(axes)
        from_level = None if turns is None else axes @ grid.level_axes.T
        body = ContactBody(
            grid.level_compliance, grid.upstream, turns, before, from_level, self._common(grid, axes, last)
        )
        free = grid.free_places
        rigid = body.change(grid.along(axes, free))
        per_radian = -grid.step * motion.road_per_travel(*grid.middles(moved))
        per_radian[~body.may_touch] = 0.0
        if given.travel is not None:
            rigid = rigid + given.travel * per_radian
        controls, values = [], []
        none, flat = np.zeros(grid.n_points), np.zeros((grid.n_points, 2))
        if given.load is not None:
            down = self.road.normal
            controls.append(Control(-normals @ down, flat, -axes @ down, given.load))
            values.append(guess[0])
        if given.force is not None:
            controls.append(Control(none, per_radian, axes[:, :, 0], given.force))
        if given.torque is not None:
            levers = axes @ TORQUE @ axes.transpose(0, 2, 1)
            arms = grid.along(axes, free @ TORQUE.T)
            controls.append(Control(none, per_radian, arms, given.torque, levers))
        if given.travel is None:
            values.append(guess[1])
        problem = RollingContact(body, gaps, rigid, friction, controls, accuracy=accuracy)
        contact = problem.solve(None if last is None else last.contact, values)
        numbers = list(contact.controls)
        deflection = given.deflection if given.load is None else numbers.pop(0)
        travel = given.travel if given.travel is not None else numbers.pop(0)
        assert deflection is not None
        assert travel is not None
        return RolledTyre(grid, motion, axes, contact, friction, deflection, travel, self.reach)
