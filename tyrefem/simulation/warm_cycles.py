"""The strain cycles of a drive at the temperatures of a run: contained air, and mean of every region."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.cycle_schedule import CycleSchedule
from tyrefem.mechanics.footprint.pressed_tyre import mechanical_mesh
from tyrefem.mechanics.rolling.wheel_on_road import road_region
from tyrefem.mechanics.solved_cases import KnotSolver, changes_cycle, ramp_knots, warming_knots
from tyrefem.mechanics.strain_cycle import solved_case
from tyrefem.quantity import KELVIN

if TYPE_CHECKING:
    from tyrefem.inputs.loading import LoadCase
    from tyrefem.inputs.study import StudyData
    from tyrefem.inputs.study_card import Feedback
    from tyrefem.mechanics.strain_cycle import StrainCycle
    from tyrefem.simulation.result import ResultData

Array = NDArray[np.float64]


@dataclass(frozen=True)
class TyreTemperatures:
    """Temperatures at a time, degC: of the contained air, and mean of every region."""

    gas: float
    regions: Mapping[str, float]

    def distance(self, other: TyreTemperatures, *, gas: bool, regions: tuple[str, ...]) -> float:
        """Largest difference, K, of the contained air (if ``gas``) and of some regions."""
        distances = [abs(self.gas - other.gas)] if gas else []
        distances += [abs(self.regions[name] - other.regions[name]) for name in regions]
        return max(distances, default=0.0)

    def towards(self, other: TyreTemperatures, share: float) -> TyreTemperatures:
        """Interpolate linearly towards other temperatures by a share."""
        if share == 1:
            return other
        regions = {name: T + share * (other.regions[name] - T) for name, T in self.regions.items()}
        return TyreTemperatures(self.gas + share * (other.gas - self.gas), regions)


@dataclass(frozen=True, eq=False)
class Warmth:
    """Temperatures over a drive, degC: ``times`` (n,) s, contained air ``gas`` (n,), ``regions`` name -> (n,).

    Linear between the times, constant beyond them.

    >>> warmth = Warmth(np.array([0.0, 100.0]), np.array([25.0, 45.0]), {"tread": np.array([25.0, 65.0])})
    >>> warmth.at(50.0)
    TyreTemperatures(gas=35.0, regions={'tread': 45.0})
    """

    times: Array
    gas: Array
    regions: Mapping[str, Array]

    def at(self, time: float) -> TyreTemperatures:
        """The temperatures at a time, s."""
        regions = {name: float(np.interp(time, self.times, T)) for name, T in self.regions.items()}
        return TyreTemperatures(float(np.interp(time, self.times, self.gas)), regions)

    @classmethod
    def even(cls, study: StudyData, warmer_by: float = 0.0) -> Warmth:
        """Initial temperatures of regions and contained air, constant in time; or all warmer by ``warmer_by``, K."""
        initial = study.card.drive.initial
        gas = study.card.boundaries.contained_air.start(initial)
        regions = {region: np.array([initial + warmer_by]) for region in study.materials}
        return cls(np.zeros(1), np.array([gas + warmer_by]), regions)

    @classmethod
    def of(cls, result: ResultData) -> Warmth:
        """Temperatures of a finished run: means by volume."""
        operators, values, regions = result.tyre.problem.operators, result.history.values, {}
        for region in result.study.materials:
            weights = np.asarray(operators.source(region).sum(axis=0)).ravel()
            regions[region] = values[:, operators.dofs(region)] @ (weights / weights.sum())
        return cls(result.times, result.gas_temperature, regions)


#: A strain cycle is kept if its temperatures changed by less than this share of the tolerance.
STILL = 0.25


#: Relative modulus of every region's compound and cords that soften.
Softened = tuple[float, ...]


@dataclass(frozen=True, eq=False)
class _Knot:
    """A strain cycle, its load case in the drive, and its temperatures."""

    moment: TyreTemperatures
    case: LoadCase
    softened: Softened
    cycle: StrainCycle


def _rubbing(study: StudyData) -> str | None:
    """The region on the road, if the tyre rolls with a friction that depends on its temperature."""
    laws = {region: card.friction for region, card in study.materials.items() if card.friction is not None}
    if not study.card.boundaries.sliding.rolls or not any(law.follows_temperature for law in laws.values()):
        return None
    region = road_region(mechanical_mesh(study).mesh)
    return region if region in laws and laws[region].follows_temperature else None


class WarmCycles:
    """Load cases at p + p_atm = (p_drive + p_atm) T_gas / T_gas,start, strain cycles at the regions' moduli.

    The coefficient of friction of a tyre that rolls with friction is that of the mean temperature of its tread.

    Parameters
    ----------
    study, choice : the study, and its ``[mechanics.feedback]``. warmth : the first temperatures.

    Raises
    ------
    InputError : the section cannot carry a load, deflection or pressure; names the phase.
    """

    def __init__(self, study: StudyData, choice: Feedback, warmth: Warmth) -> None:
        self.study, self.choice, self._cold = study, choice, KnotSolver(study)
        drive, law = study.card.drive, study.card.boundaries.contained_air
        self.gas_start = law.start(drive.initial)
        self.softening = tuple(r for r, card in study.materials.items() if choice.modulus and card.softens)
        self.rubbing = _rubbing(study) if choice.friction else None
        self.knots = tuple(
            tuple(ramp_knots(True) if changes_cycle(study, number) else warming_knots(choice.knots))
            for number, _ in enumerate(drive.phases)
        )
        self._solvers: dict[Softened, KnotSolver] = {}
        self._kept: dict[tuple[int, int], _Knot] = {}
        for place in self._places():
            self._kept[place] = self._solved(place, self._moment(place, warmth))
        self._solvers.clear()

    def change(self, warmth: Warmth) -> float:
        """Largest difference, K, between these temperatures and those of the strain cycles, over all knots."""
        return max(self._distance(place, warmth) for place in self._places())

    def update(self, warmth: Warmth, share: float = 1.0) -> None:
        """Move the strain cycles a share of the way to other temperatures, where these differ noticeably."""
        for place in self._places():
            if self._distance(place, warmth) > STILL * self.choice.tolerance:
                moment = self._kept[place].moment.towards(self._moment(place, warmth), share)
                self._kept[place] = self._solved(place, moment)
        self._solvers.clear()

    def schedule(self) -> CycleSchedule:
        """Load cases and strain cycles for a run; a constant phase has one strain cycle, as without feedback."""
        fractions, cases, cycles, warmth = [], [], [], []
        for number, knots in enumerate(self.knots):
            kept = [self._kept[number, place] for place in range(len(knots))]
            same = all(
                (warm_cycle.case, warm_cycle.softened) == (kept[0].case, kept[0].softened) for warm_cycle in kept
            )
            if same and not changes_cycle(self.study, number):
                kept, knots = kept[:1], (0.0,)
            fractions.append(knots)
            cases.append(tuple(solved_case(warm_cycle.cycle, warm_cycle.case) for warm_cycle in kept))
            cycles.append(tuple(warm_cycle.cycle for warm_cycle in kept))
            warmth.append(tuple(warm_cycle.moment.regions if self.softening else None for warm_cycle in kept))
        return CycleSchedule(self.study.card.drive, tuple(fractions), tuple(cases), tuple(cycles), tuple(warmth))

    def _places(self) -> list[tuple[int, int]]:
        return [(number, place) for number, knots in enumerate(self.knots) for place in range(len(knots))]

    def _moment(self, place: tuple[int, int], warmth: Warmth) -> TyreTemperatures:
        drive, (number, knot) = self.study.card.drive, place
        return warmth.at(drive.starts[number] + self.knots[number][knot] * drive.phases[number].duration)

    def _distance(self, place: tuple[int, int], warmth: Warmth) -> float:
        moment = self._kept[place].moment
        regions = self.softening if self.rubbing is None else (*self.softening, self.rubbing)
        return moment.distance(self._moment(place, warmth), gas=self.choice.pressure, regions=regions)

    def _solved(self, place: tuple[int, int], moment: TyreTemperatures) -> _Knot:
        number, knot = place
        warmed = (moment.gas + KELVIN) / (self.gas_start + KELVIN) if self.choice.pressure else 1.0
        case = self._cold.case(number, self.knots[number][knot], warmed)
        if self.rubbing is not None and case.wheel is not None:
            case = replace(case, wheel=replace(case.wheel, tread_temperature=moment.regions[self.rubbing]))
        softened = self._softened(moment)
        for other in self._kept.values():
            if (other.case, other.softened) == (case, softened):
                return _Knot(moment, case, softened, other.cycle)
        near = self._kept.get(place) or self._kept.get((number, knot - 1))
        start = None if near is None else near.cycle
        return _Knot(moment, case, softened, self._solver(softened, moment).cycle(number, case, start))

    def _softened(self, moment: TyreTemperatures) -> Softened:
        shares: list[float] = []
        for region in self.softening:
            card, T = self.study.materials[region], moment.regions[region]
            laws = [part.softening for part in (card, card.cord, card.cords) if part is not None]
            shares += [law(T) for law in laws if law is not None]
        return tuple(shares)

    def _solver(self, softened: Softened, moment: TyreTemperatures) -> KnotSolver:
        """Solver for all knots of equal moduli; cleared after every update, which changes the moduli."""
        if not self.softening:
            return self._cold
        if softened not in self._solvers:
            self._solvers[softened] = KnotSolver(self.study.warmed(moment.regions))
        return self._solvers[softened]
