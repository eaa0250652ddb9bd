"""The strain cycle of a user's law: tried at some points, and its errors name its file and class."""

from __future__ import annotations

import functools
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.inputs.loading import LoadCase
from tyrefem.mechanics.strain_cycle import ORDERS, Zone
from tyrefem.plugins import Origin, Range, Trial, registry, trial
from tyrefem.plugins.guard import guarded, plugin_error
from tyrefem.plugins.kind import is_ours

if TYPE_CHECKING:
    from tyrefem.geometry import Section
    from tyrefem.inputs.study import StudyData

Array = NDArray[np.float64]
#: Stations across every piece of a region where energies are tried.
STATIONS = 7
#: Strain energies are of 1e2 to 1e6 J/m3; beyond this the unit is another.
ENERGIES = Range("J/m3", 0.0, 1e9)


def with_tried_cycles(cls: type[Any], origin: Origin) -> None:
    """Let the provider of a user's law try its cycles: zones, and energies of the first one."""
    provider = cls.provider
    if hasattr(provider, "tries_cycles"):
        return

    @functools.wraps(provider)
    def tried(self: Any, study: StudyData) -> Callable[..., Any]:
        name = type(self).__name__
        cycle_of = guarded_call(provider(self, study), f"class {name}, what provider gives", origin)
        seen: list[bool] = []

        def cycle(case: LoadCase, *near: Any) -> Any:
            computed = cycle_of(case, *near)
            if is_ours(type(computed)):
                return computed
            user_cycle = UserCycle(computed, name, origin)
            if not seen:
                seen.append(True)
                fault = next((trial.fault for trial in user_cycle.trials(study.section) if trial.fault), None)
                if fault:
                    raise plugin_error(origin, f"class {name}", fault)
            return user_cycle

        return cycle

    tried.tries_cycles = True  # type: ignore[attr-defined]
    cls.provider = tried


def guarded_call(cycle_of: Any, place: str, origin: Origin) -> Callable[..., Any]:
    """A function from load case to cycle whose errors name the plugin; refused where it is no function."""
    if not callable(cycle_of):
        raise plugin_error(origin, place, f"must be a function from load case to strain cycle, not {cycle_of!r:.60}")
    if not hasattr(cycle_of, "__code__"):
        return guarded(lambda *cases: cycle_of(*cases), place, origin, _file_of(cycle_of))
    return guarded(cycle_of, place, origin)


def _file_of(thing: Any) -> str:
    """The Python file of an object's class; empty where it has none."""
    return str(getattr(sys.modules.get(type(thing).__module__), "__file__", None) or "")


@dataclass(frozen=True, eq=False)
class UserCycle:
    """A user's strain cycle. ``name``: of its law's class."""

    cycle: Any
    name: str
    origin: Origin

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or name == "cycle":
            raise AttributeError(name)
        value = getattr(self.cycle, name)
        return functools.partial(self._energies, name) if name == "spectrum" else value

    @property
    def zones(self) -> tuple[Zone, ...]:
        """The zones."""
        return tuple(self._given_zones)

    @property
    def _given_zones(self) -> Any:
        """The zones as the user's cycle gives them; errors name the plugin."""
        place = f"class {self.name}, zones"
        return guarded(lambda: self.cycle.zones, place, self.origin, _file_of(self.cycle))()

    def energy_density(self, zone: str, points: Array) -> Array:
        """U, J/m3, at points (2, n) of a zone."""
        return self._energies("energy_density", zone, points)

    def _energies(self, method: str, zone: str, points: Array) -> Array:
        """What a method of the cycle gives for the points: finite, of at least 0; (n,), a spectrum (orders, n)."""
        place, count = f"class {self.name}, {method}", points.shape[1]
        file = _file_of(self.cycle)
        values = guarded(lambda *given: getattr(self.cycle, method)(*given), place, self.origin, file)(zone, points)
        by_order = method == "spectrum"
        orders = f" for each of 1 to {len(ORDERS)} orders" if by_order else ""
        must = f"must give {count} numbers for {count} points{orders}, not "
        if values is None:  # a method without return, which numpy takes for nan
            raise plugin_error(self.origin, place, f"{must}None")
        try:
            energies = np.asarray(values, dtype=float)
            if not by_order:
                energies = np.broadcast_to(energies, (count,))
            elif energies.ndim != 2 or energies.shape[1] != count or not 0 < len(energies) <= len(ORDERS):
                raise ValueError
        except (TypeError, ValueError):
            raise plugin_error(self.origin, place, f"{must}{np.shape(values)}") from None
        wrong = ~np.isfinite(energies) | (energies < 0)
        if wrong.any():
            words = f"must be finite, of at least 0 J/m3, not {energies[wrong].flat[0]:g}"
            raise plugin_error(self.origin, place, words)
        return energies

    def trials(self, section: Section) -> Iterator[Trial]:
        """Zones of the section's regions, and energies at points of each."""
        fault = _zones_fault(self._given_zones, section)
        yield Trial("zones are parts of the section's regions", fault and f"the strain cycle's {fault}")
        if fault:
            return
        for zone in self.zones:
            points = points_of(section, zone)
            if points.shape[1]:
                words = f"energy_density('{zone.name}', {points.shape[1]} points)"
                energies = functools.partial(self.energy_density, zone.name, points)
                yield trial(words, energies, ENERGIES, points.shape[1:])
                if hasattr(self, "spectrum"):
                    self._energies("spectrum", zone.name, points)
                    yield Trial("spectrum gives energies of at least 0 J/m3 by order, one per place")
        if hasattr(self, "solved_case"):
            fits, must = isinstance(self.solved_case, LoadCase), "solved_case must be a tyrefem.inputs.loading.LoadCase"
            yield Trial("solved_case is a load case", None if fits else f"{must}, not {self.solved_case!r:.60}")


def of_present_law(cycle: Any, law: type[Any]) -> bool:
    """False for a cycle of a user's law whose file has been edited since."""
    plugin = registry().of_class(law)
    if plugin is None or not isinstance(cycle, UserCycle):
        return True
    return cycle.origin.sha256 == plugin.origin.sha256


def _zones_fault(zones: Any, section: Section) -> str | None:
    needs = "zones must be a tuple of tyrefem.mechanics.strain_cycle.Zone(name, region, title)"
    if not isinstance(zones, tuple | list) or not zones or not all(isinstance(zone, Zone) for zone in zones):
        return f"{needs}, not {zones!r:.60}"
    unknown = [zone.region for zone in zones if zone.region not in section.regions]
    if unknown:
        return f"zones name the region '{unknown[0]}', which section '{section.name}' does not have"
    names = [zone.name for zone in zones]
    twice = next((name for name in names if names.count(name) > 1), None)
    return None if twice is None else f"zones have the name '{twice}' twice: only the last would heat"


def points_of(section: Section, zone: Zone) -> Array:
    """Points (2, n) of a zone, some in each piece of its region."""
    points = []
    for piece in section.pieces:
        start, end = max(piece.start, zone.start), min(piece.end, zone.end)
        if piece.region != zone.region or end <= start:
            continue
        s = np.linspace(start, end, STATIONS + 2)[1:-1]
        faces = section.interfaces(s)
        depth = 0.5 * (faces[piece.layer] + faces[piece.layer + 1]) - faces[0]
        points.append(section.place(s, depth))
    return np.concatenate(points).T if points else np.zeros((2, 0))
