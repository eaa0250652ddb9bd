"""From a user's problem to the heat balance, with a check of every name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from tyrefem.conduction.added_states import AddedStates
from tyrefem.conduction.balance import HeatBalance
from tyrefem.conduction.conditions import Condition, Convection, Film, Fixed, Flux, Material, Radiation, Reservoir
from tyrefem.conduction.datum import Datum
from tyrefem.conduction.operators import Operators, Surface
from tyrefem.conduction.reservoirs import reservoir_loads
from tyrefem.conduction.sources import SourceLoad
from tyrefem.conduction.surface_loads import ConvectionLoad, FilmLoad, FluxLoad, RadiationLoad
from tyrefem.conduction.terms import Load
from tyrefem.errors import InputError, nearest

Entry = tuple[str, str, int]


def balance_of(
    ops: Operators,
    regions: Mapping[str, Material],
    boundaries: Mapping[str, Sequence[Condition]],
    sources: Mapping[str, Any],
    reservoirs: Mapping[str, Reservoir],
    states: AddedStates | None = None,
) -> HeatBalance:
    """The heat balance of a problem; InputError for names that are not in the mesh."""
    numbers = {name: i for i, name in enumerate(reservoirs)}
    loads: list[tuple[Entry, Load]] = []
    fixed: list[tuple[Entry, Surface, Datum]] = []
    for name, q in sources.items():
        if name not in (ops.mesh.subdomains or {}):
            allowed = ops.mesh.subdomains or {}
            raise InputError(f"unknown subdomain {name!r}{nearest(name, allowed)}", field="sources")
        loads.append((("source", name, 0), SourceLoad(ops, name, q)))
        loads[-1][1].cause = q
    for name, conditions in boundaries.items():
        surface = ops.surface(name)
        for i, c in enumerate(conditions):
            entry, field = ("boundary", name, i), f"boundaries.{name}"
            if isinstance(c, Film):
                loads.append((entry, FilmLoad(surface, c, field, _reservoir(c, numbers, field))))
            elif isinstance(c, Flux):
                loads.append((entry, FluxLoad(surface, c, field)))
            elif isinstance(c, Radiation):
                loads.append((entry, RadiationLoad(surface, c, field)))
            elif isinstance(c, Convection):
                loads.append((entry, ConvectionLoad(surface, c, field)))
            elif isinstance(c, Fixed):
                fixed.append((entry, surface, Datum(c.temperature, surface.points, field)))
                continue
            else:
                raise InputError(f"must be a Film, Flux, Radiation or Fixed, or a Convection, not {c!r}", field=field)
            loads[-1][1].cause = c
    for name, reservoir in reservoirs.items():
        for index, load in reservoir_loads(numbers[name], name, reservoir, numbers):
            loads.append((("reservoir", name, index), load))
    return HeatBalance(ops, dict(regions), loads, fixed, dict(reservoirs), states)


def _reservoir(film: Film, numbers: Mapping[str, int], field: str) -> int | None:
    """Number of the reservoir behind a film; None: its sink is a temperature."""
    if not isinstance(film.sink, str):
        return None
    if film.sink not in numbers:
        hint = nearest(film.sink, numbers) if numbers else "; the problem has none"
        raise InputError(f"unknown reservoir {film.sink!r}{hint}", field=f"{field}.sink")
    return numbers[film.sink]


def check_partition(ops: Operators, regions: Mapping[str, Material]) -> None:
    """Raise InputError unless the regions hold every element exactly once."""
    count = np.zeros(ops.element_dofs.shape[1], dtype=int)
    for name, material in regions.items():
        if not isinstance(material, Material):
            raise InputError(f"must be a Material, not {material!r}", field=f"regions.{name}")
        elements = ops.elements(name)
        if not elements.size:
            raise InputError(f"region {name!r} has no elements", field="regions")
        count[elements] += 1
        if np.any(count[elements] > 1):
            others = [o for o in regions if o != name and np.isin(ops.elements(o), elements).any()]
            raise InputError(
                f"region {name!r} shares {int(np.sum(count[elements] > 1))} elements with {', '.join(others)}",
                field="regions",
            )
    left = np.flatnonzero(count == 0)
    if left.size:
        unassigned = [s for s, e in (ops.mesh.subdomains or {}).items() if s not in regions and np.isin(e, left).any()]
        hint = f" (in {', '.join(sorted(unassigned))})" if unassigned else ""
        raise InputError(f"{left.size} elements belong to no region{hint}", field="regions")
