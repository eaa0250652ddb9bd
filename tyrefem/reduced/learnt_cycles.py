"""Strain cycles by finite elements over a box, learnt from some dozen presses: energies at the nodes, and the contact.

The energies U of all zones at the nodes of the common mesh, divided by their mean over the presses, are reduced by POD.
Their coefficients and the contact's numbers are interpolated over the box by cubic radial functions with a quadratic
trend (Wendland 2005, Scattered Data Approximation, ch. 8).
"""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.errors import InputError
from tyrefem.inputs.changes import value_at
from tyrefem.inputs.loading import PressedContact
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.cycle_schedule import CycleSchedule, same_cycles
from tyrefem.mechanics.solved_cases import KnotSolver
from tyrefem.mechanics.strain_cycle import Zone
from tyrefem.mechanics.strain_laws import strain_law
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.variants.samples import changes_at
from tyrefem.variants.varied import Varied

Array = NDArray[np.float64]
#: Presses: so many times the terms of the quadratic trend, and so many more.
PRESSES_PER_TERM, MORE_PRESSES = 1.5, 4
#: Relative error of the energies' modes.
ENERGY_TOLERANCE = 1e-4
#: Numbers of a drive that a standing press reads.
PRESSED_BY = ("load", "pressure", "deflection", "drum_diameter")


@dataclass(frozen=True, eq=False)
class NodeEnergies(Brief):
    """A strain cycle as energies at the nodes of a conduction mesh.

    Parameters
    ----------
    zones : whole regions. energies : zone -> (n_nodes,) U, J/m3, in the order of the zone's nodes.
    """

    zones: tuple[Zone, ...]
    energies: Mapping[str, Array]

    def at_nodes(self, zone: str, numbers: NDArray[np.intp]) -> Array:
        """U, J/m3, at some nodes of a zone, by their numbers among its nodes."""
        return np.asarray(self.energies[zone][numbers])

    def energy_density(self, zone: str, points: Array) -> Array:
        """U, J/m3, at all nodes (2, n) of a zone.

        Raises
        ------
        InputError : other points than the zone's nodes.
        """
        energies = self.energies[zone]
        if np.shape(points)[1] != len(energies):
            raise InputError("energies learnt from presses are known at the nodes of the mesh only", field="points")
        return energies


@dataclass(frozen=True, eq=False)
class Press:
    """A press of a variant: energies (n_cycles, all zones' nodes) U, J/m3, and contacts (n_cycles, 5): load, N,
    deflection, m, length, m, area, m2, and rolling radius, m, of the load cases of all phases."""

    energies: Array
    contacts: Array


def press_of(tyre: RollingTyre) -> Press:
    """Energies and contacts of a tyre's strain cycles."""
    schedule, ops = tyre.schedule, tyre.problem.operators
    energies, contacts = [], []
    for cases, cycles in zip(schedule.cases, schedule.cycles, strict=True):
        for case, cycle in zip(cases, cycles, strict=True):
            energies.append(np.concatenate([cycle.energy_density(z.name, ops.nodes(z.name)) for z in schedule.zones]))
            contact = case.contact
            if contact is None:
                raise InputError("a load case without a computed contact", field="mechanics.strain")
            contacts.append([case.load, case.deflection, contact.length, contact.area, contact.rolling_radius])
    return Press(np.array(energies), np.array(contacts, dtype=float))


@dataclass(frozen=True, eq=False)
class LearntCycles(Brief):
    """Strain cycles of the variants of a box.

    Parameters
    ----------
    varied : the numbers that the strain cycle depends on. places : (k, d) points of the unit box that were pressed.
    zones, sizes : of the strain law, and numbers of their nodes. knots : of the load cases. mean, modes : of the
        energies, (n,) and (n, K). values : (k, K + 5 n_cycles) coefficients and relative contacts of the presses.
    contacts : (n_cycles, 5) mean contacts.
    """

    varied: tuple[Varied, ...]
    places: Array
    zones: tuple[Zone, ...]
    sizes: tuple[int, ...]
    knots: tuple[tuple[float, ...], ...]
    mean: Array
    modes: Array
    values: Array
    contacts: Array

    def _facts(self) -> Mapping[str, Any]:
        return {"presses": len(self.places), "modes": self.modes.shape[1], "error": f"{self.error:.2g} of the energies"}

    @functools.cached_property
    def _interpolant(self) -> Any:
        return _interpolant(self.places, self.values)

    @functools.cached_property
    def error(self) -> float:
        """Relative rms error of the energies of presses that are left out, one at a time."""
        each = np.arange(len(self.places))
        gaps = np.array(
            [
                self.values[k] - _interpolant(self.places[each != k], self.values[each != k])(self.places[k : k + 1])[0]
                for k in each
            ]
        )
        count = self.modes.shape[1]
        wanted = self.mean + (self.values[:, :count] @ self.modes.T) * self.mean
        missed = (gaps[:, :count] @ self.modes.T) * self.mean
        return float(np.sqrt((missed**2).mean() / (wanted**2).mean()))

    def place(self, study: StudyData) -> Array:
        """Point of a study in the unit box, (1, d)."""
        return np.array([[each.place_of(value_at(study.data, each.key, study.folder)) for each in self.varied]])

    def schedule(self, study: StudyData) -> CycleSchedule:
        """Load cases and strain cycles of a study in the box."""
        values, count = self._interpolant(self.place(study))[0], self.modes.shape[1]
        energies = np.maximum(self.mean * (1 + self.modes @ values[:count]), 0.0).reshape(len(self.contacts), -1)
        contacts = self.contacts * (1 + values[count:].reshape(self.contacts.shape))
        solver, cases, cycles, number = KnotSolver(study), [], [], 0
        ends = np.cumsum(self.sizes)[:-1]
        for phase, knots in enumerate(self.knots):
            of_phase = []
            for fraction in knots:
                case = solver.case(phase, fraction)
                load, deflection, length, area, radius = (float(value) for value in contacts[number])
                of_phase.append(
                    (
                        replace(
                            case,
                            load=load if case.by_deflection else case.load,
                            deflection=case.deflection if case.by_deflection else deflection,
                            contact=PressedContact(length, area, radius),
                        ),
                        NodeEnergies(
                            self.zones,
                            dict(zip((z.name for z in self.zones), np.split(energies[number], ends), strict=True)),
                        ),
                    )
                )
                number += 1
            cases.append(tuple(case for case, _ in of_phase))
            cycles.append(tuple(cycle for _, cycle in of_phase))
        return CycleSchedule(study.card.drive, self.knots, tuple(cases), tuple(cycles))


def _interpolant(places: Array, values: Array) -> Any:
    from scipy.interpolate import RBFInterpolator

    enough = len(places) > _terms(places.shape[1])
    return RBFInterpolator(places, values, kernel="cubic", degree=2 if enough else 1)


def _terms(numbers: int) -> int:
    return math.comb(numbers + 2, 2)


def press_count(numbers: int) -> int:
    """Presses to learn from, for so many varied numbers."""
    return int(PRESSES_PER_TERM * _terms(numbers)) + MORE_PRESSES


def learnt(base: RollingTyre, varied: Sequence[Varied], places: Array, presses: Sequence[Press]) -> LearntCycles:
    """Strain cycles from presses at places (k, d); of presses at the same place the first counts."""
    _, first = np.unique(places.round(9), axis=0, return_index=True)
    places, presses = places[first], [presses[k] for k in first]
    schedule, ops = base.schedule, base.problem.operators
    fields = np.array([press.energies.reshape(-1) for press in presses])
    mean = np.maximum(fields.mean(axis=0), 1e-6 * fields.mean())
    relative = fields / mean - 1
    # Weighed by the mean energy: where there is little heat, little is to be learnt.
    root = np.sqrt(mean / mean.sum())
    left, size, right = np.linalg.svd(relative * root, full_matrices=False)
    left_out = np.sqrt(np.append(np.cumsum(size[::-1] ** 2)[::-1], 0.0) / len(fields))
    count = max(int(np.argmax(left_out <= ENERGY_TOLERANCE)), 1)
    modes, coefficients = (right[:count] / root).T, left[:, :count] * size[:count]
    contacts = np.array([press.contacts for press in presses])
    centre = contacts.mean(axis=0)
    values = np.column_stack([coefficients, (contacts / centre - 1).reshape(len(presses), -1)])
    sizes = tuple(len(ops.dofs(zone.name)) for zone in schedule.zones)
    return LearntCycles(tuple(varied), places, schedule.zones, sizes, schedule.knots, mean, modes, values, centre)


def mechanical_numbers(study: StudyData, varied: Sequence[Varied]) -> list[int]:
    """Places of the varied numbers that a press reads; empty where presses are not worth learning, or cannot be.

    They are learnt for strain laws by finite elements without friction, inertia and loss over frequency; the numbers
    must vary in ranges.
    """
    mechanics = study.card.mechanics
    law = strain_law(study)
    if not law.by_elements or mechanics.rolling or study.card.boundaries.sliding.rolls:
        return []
    if any(card.loss_tangent.depends_on_frequency for card in study.materials.values()):
        return []
    numbers = [n for n, number in enumerate(varied) if _read(study, varied, n)]
    return [] if any(varied[n].values for n in numbers) else numbers


def _read(study: StudyData, varied: Sequence[Varied], n: int) -> bool:
    """Does a press read this number?"""
    keys = varied[n].keys
    if all(key.startswith("drive.") for key in keys):
        tables = any(isinstance(value, Mapping | list) for value in varied[n].values)
        return tables or any(key.split(".")[-1] in PRESSED_BY for key in keys)
    ends = []
    for end in (0.0, 1.0):
        place = np.full(len(varied), 0.5)
        place[n] = end
        ends.append(study.replace(changes_at(varied, place)))
    return not same_cycles(*ends)
