"""The life of a study's tyre: distance until a small flaw has grown to a crack, at every Gauss point."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.cache import read_only
from tyrefem.errors import InputError
from tyrefem.fatigue.cracking_energy import products
from tyrefem.fatigue.duty import Duty, WarmRevolutions
from tyrefem.fatigue.growth import LONGEST, cycles_to_failure, lindley_factor
from tyrefem.fatigue.matrix_cycle import MatrixCycle
from tyrefem.fatigue.planes import critical_planes
from tyrefem.mechanics.cycle_schedule import cycle_schedule
from tyrefem.mechanics.strain_laws import strain_law, strain_laws
from tyrefem.quantity import KELVIN
from tyrefem.requirements import Requirements

if TYPE_CHECKING:
    from tyrefem.fatigue.cracking_energy import CrackingEnergy
    from tyrefem.fatigue.duty import WarmRun
    from tyrefem.inputs.study import StudyData
    from tyrefem.materials.fatigue import Fatigue
    from tyrefem.mechanics.solid.elements import Rings

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
#: Requirements of a life on the study.
NEEDS = Requirements("a fatigue life")
#: Longest life that is reported, km: a longer one, also of points without cycle, counts as this.
LONGEST_KM = 1e12
#: Highest temperature of a quick look, degC.
HOTTEST = 300.0
#: Fields of a life that are arrays.
ARRAYS = ("km", "normals", "temperatures", "peak", "valley", "stretch", "opening", "drift", "shares")
#: Points whose planes are searched together.
TOGETHER = 64


@dataclass(frozen=True, eq=False)
class LifeData(Brief):
    """Life at the Gauss points of a study's mechanical mesh. Made by `life`. NaN: a region without ``[fatigue]``.

    Parameters
    ----------
    study : the study. rings : the undeformed section's elements. regions : names of the regions with a life.
    left_out : regions whose card has no ``[fatigue]``. temperature : degC that was given; None: those of a run.
    plateau : each phase at its last temperatures. distance : m over the road in one drive.
    km : (e, q) distance to failure. normals : (e, q, 3) of the critical plane, in (r, z, t) of the inflated tyre.
    temperatures : (e, q) degC, mean over the drive as it counts for the growth.
    peak, valley, stretch, opening, drift : (e, q) of the load case that does most on that plane, as in `PlaneCycle`.
    shares : (phases, e, q) of the damage.
    """

    study: StudyData
    rings: Rings
    regions: tuple[str, ...]
    left_out: tuple[str, ...]
    temperature: float | None
    plateau: bool
    distance: float
    km: Array
    normals: Array
    temperatures: Array
    peak: Array
    valley: Array
    stretch: Array
    opening: Array
    drift: Array
    shares: Array

    def __post_init__(self) -> None:
        for name in ARRAYS:
            object.__setattr__(self, name, read_only(getattr(self, name)))

    def _title(self) -> str:
        return f"of {self.study.name}"

    def _facts(self) -> Mapping[str, Any]:
        element = self.first
        r, z = self.rings.points[:, element].mean(axis=-1)
        return {
            "shortest": f"{self.shortest:.4g} km in the {self.rings.region_of(element)}, "
            f"r = {r * 1e3:.1f} mm, z = {z * 1e3:.1f} mm",
            "regions": ", ".join(self.regions),
            "left out": ", ".join(self.left_out) or "none",
        }

    @functools.cached_property
    def element_km(self) -> Array:
        """(e,) geometric mean over each element's Gauss points, by volume, km: a crack of `Fatigue.crack` extends over
        that much rubber, and single points at the sharp end of a layer depend on the mesh."""
        weights = self.rings.weights / self.rings.weights.sum(axis=1, keepdims=True)
        with np.errstate(divide="ignore"):
            return read_only(np.exp((weights * np.log(self.km)).sum(axis=1)))

    @functools.cached_property
    def typical(self) -> Indices:
        """(e,) the Gauss point of each element whose life is nearest to the element's."""
        with np.errstate(divide="ignore", invalid="ignore"):
            distance = np.abs(np.log(self.km) - np.log(self.element_km)[:, None])
        return np.asarray(np.where(np.isnan(distance), np.inf, distance).argmin(axis=1))

    @property
    def first(self) -> int:
        """The element that fails first."""
        return int(np.nanargmin(self.element_km))

    @property
    def shortest(self) -> float:
        """Life of the element that fails first, km."""
        return float(self.element_km[self.first])

    @functools.cached_property
    def tearing_energy(self) -> Array:
        """(e, q) largest T = 2 k W c_0 of the flaw, J/m2."""
        flaws = np.full(self.km.shape, np.nan)
        for region in self.regions:
            flaws[self.members(region)] = self.study.materials[region].fatigue.flaw  # type: ignore[union-attr]
        return np.asarray(2 * lindley_factor(self.stretch) * self.peak * flaws)

    def members(self, region: str) -> Indices:
        """Numbers of a region's elements."""
        return np.asarray(self.rings.mesh.subdomains[region], dtype=np.int64)


def life(
    study: StudyData,
    *,
    temperature: float | None = None,
    plateau: bool = False,
    result: WarmRun | None = None,
    progress: Callable[[float], None] | None = None,
) -> LifeData:
    """Distance until flaws become cracks, at every Gauss point of the mechanical mesh.

    The drive is repeated until the damage sum over its load cases is 1 (Miner): 1/L = sum n_i / N_i / distance, n_i the
    revolutions of a load case at the temperature of the point, N_i its `growth.cycles_to_failure` on the critical
    plane. That plane is the one with the greatest sum.

    Parameters
    ----------
    study : with ``mechanics.strain = "fem"`` and cards with ``[fatigue]``.
    temperature : degC everywhere, as a quick look without a run. plateau : each phase at the temperatures of its end.
    result : a finished run of the study; None: it is simulated. progress : see `tyrefem.simulation.run`.

    Raises
    ------
    InputError : a temperature with a run or its plateau; an interrupted run; a campaign; a strain law without strains
        at points; no card with ``[fatigue]``; a tyre that never rolls; errors of a run.
    """
    check(study)
    if temperature is not None and (plateau or result is not None):
        raise InputError("goes without a run and without plateau: it holds everywhere", field="temperature")
    if temperature is not None and not -KELVIN <= temperature <= HOTTEST:
        allowed = f"allowed: {-KELVIN:g} to {HOTTEST:g} degC"
        raise InputError(f"no tyre has {temperature:g} degC; {allowed}", field="temperature")
    if result is not None and not all(hasattr(result, name) for name in ("tyre", "times", "near")):
        raise InputError(f"must be the result of a run, not {result!r:.60}", field="result")
    if temperature is not None:
        duty = Duty.at_temperature(cycle_schedule(study), temperature)
    else:
        if result is None:
            from tyrefem.simulation.run import run

            result = run(study, progress)
        last, end = float(result.times[-1]), study.card.drive.end
        if last < end * (1 - 1e-9):
            words = f"the run ends at {last:g} s of {end:g} s: a life needs a run of the whole drive"
            raise InputError(words, field="result")
        duty = Duty.of_run(result, plateau=plateau)
    cycles = duty.cycles()
    if not cycles:
        raise InputError("the tyre never rolls under load: no strain cycle, no fatigue", field="drive", file=study.file)
    return _life(study, duty, cycles, temperature, plateau)


def check(study: StudyData) -> None:
    """Raise an error for a study whose life cannot be computed, before any work."""
    NEEDS.check(study)
    law = strain_law(study)
    if not law.presses:
        allowed = ", ".join(f'"{name}"' for name, other in strain_laws().items() if other.presses)
        message = (
            f'the strain law "{law.name}" gives an energy, not the strain of every point over a revolution, which a '
            f"fatigue life needs: set mechanics.strain = {allowed}"
        )
        raise InputError(message, field="mechanics.strain", file=study.file)
    if not any(card.fatigue is not None for card in study.materials.values()):
        message = "no card of the study has the table [fatigue], without which there is no growth of cracks"
        raise InputError(message, field="materials", file=study.file)


def _life(
    study: StudyData,
    duty: Duty,
    cycles: dict[tuple[int, ...], tuple[Any, Array]],
    temperature: float | None,
    plateau: bool,
) -> LifeData:
    body = next(iter(cycles.values()))[0].tyre.body
    rings, phases = body.rings, len(study.card.drive.phases)
    shape = rings.weights.shape
    fields = {name: np.full(shape, np.nan) for name in ("km", "temperatures", *_OF_CYCLE)}
    normals, shares = np.full((*shape, 3), np.nan), np.full((phases, *shape), np.nan)
    tables = {region: study.materials[region].fatigue for region in body.parts}
    matrices = {key: MatrixCycle(cycle) for key, (cycle, _) in cycles.items()}
    distance = duty.distance()
    for region, fatigue in tables.items():
        if fatigue is None:
            continue
        members = np.asarray(rings.mesh.subdomains[region], dtype=np.int64)
        for chosen in np.array_split(members, max(1, len(members) * shape[1] // TOGETHER)):
            places = rings.points[:, chosen].reshape(2, -1).T
            warm = WarmRevolutions.at(fatigue, duty.temperatures(places), cycles)
            paths = {key: matrix.energies(region, chosen) for key, matrix in matrices.items()}
            point = _Points(fatigue, paths, warm)
            directions, _ = critical_planes(point.damage, len(places))
            of_cycle, by_phase = point.details(directions)
            damage = by_phase.sum(axis=0)
            inside = (len(chosen), shape[1])
            with np.errstate(divide="ignore"):
                fields["km"][chosen] = np.minimum(distance / 1e3 / damage, LONGEST_KM).reshape(inside)
            fields["temperatures"][chosen] = warm.mean.reshape(inside)
            for name, values in of_cycle.items():
                fields[name][chosen] = values.reshape(inside)
            normals[chosen] = directions.reshape(*inside, 3)
            shares[:, chosen] = (by_phase / np.maximum(damage, 1e-300)).reshape(phases, *inside)
    regions = tuple(region for region, fatigue in tables.items() if fatigue is not None)
    left_out = tuple(region for region in tables if region not in regions)
    return LifeData(
        study, rings, regions, left_out, temperature, plateau, distance, normals=normals, shares=shares, **fields
    )


#: Fields of `PlaneCycle` that a life keeps.
_OF_CYCLE = ("peak", "valley", "stretch", "opening", "drift")


@dataclass(frozen=True, eq=False)
class _Points:
    """Points of one compound: their paths of stress and strain in each load case, and its revolutions."""

    fatigue: Fatigue
    paths: Mapping[tuple[int, ...], CrackingEnergy]
    warm: WarmRevolutions

    def _growth(self, peak: Array, valley: Array, stretch: Array) -> Array:
        """1/N of one revolution at the reference temperature; shape of the inputs."""
        ratio = valley / np.maximum(peak, 1e-30)
        return 1 / np.maximum(
            cycles_to_failure(self.fatigue, peak, ratio, stretch, self.fatigue.reference), 1 / LONGEST
        )

    def damage(self, directions: Array) -> Array:
        """Miner's sum of one drive on planes with normals (planes, 3) or (points, planes, 3)."""
        weights = products(directions)
        terms = (
            self.warm.weighted[key].sum(axis=0)[:, None] * self._growth(*path.extremes(weights))
            for key, path in self.paths.items()
        )
        return np.asarray(sum(terms))

    def details(self, directions: Array) -> tuple[dict[str, Array], Array]:
        """On one plane of each point: the cycle that does most damage; and the phases' damages, (phases, points)."""
        weights = products(directions)[:, None]
        cycles = [path.on(weights) for path in self.paths.values()]
        damages = np.array(
            [
                self.warm.weighted[key] * self._growth(cycle.peak, cycle.valley, cycle.stretch)[:, 0]
                for key, cycle in zip(self.paths, cycles, strict=True)
            ]
        )
        most = damages.sum(axis=1).argmax(axis=0)
        kept = {
            name: np.array([getattr(cycle, name)[:, 0] for cycle in cycles])[most, np.arange(len(directions))]
            for name in _OF_CYCLE
        }
        return kept, np.asarray(damages.sum(axis=0))
