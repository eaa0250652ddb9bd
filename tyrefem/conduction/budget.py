"""The heat budget of a run: generated = stored + lost, by region and boundary."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief

Array = NDArray[Any]


@dataclass(frozen=True)
class Budget(Brief):
    """Energies (J) since the first time and powers (W) at `times`; every array is (n_times,).

    Powers at a breakpoint are those just before it; powers at the first time are those just after it.

    Attributes
    ----------
    generated, generated_power : by source subdomain.
    stored, stored_power : by region.
    lost, lost_power : by boundary, positive outwards; the sum over all conditions of the boundary.
    lost_by_condition, lost_power_by_condition : by (boundary, index of the condition).
    reservoir_stored : by reservoir, J.
    reservoir_gained : by reservoir, J from its exchanges and its power.
    residual : generated - stored - lost of the body, J.
    reservoir_residual : received + gained - stored of every reservoir, J.
    throughput : J, sum of |generated| + |lost| + |gained|, the reference of the residuals.
    floor : J, a millionth of the heat that the body holds above 0 degC at the start; smaller residuals are rounding.
    """

    times: Array
    generated: Mapping[str, Array]
    generated_power: Mapping[str, Array]
    stored: Mapping[str, Array]
    stored_power: Mapping[str, Array]
    lost: Mapping[str, Array]
    lost_power: Mapping[str, Array]
    lost_by_condition: Mapping[tuple[str, int], Array]
    lost_power_by_condition: Mapping[tuple[str, int], Array]
    reservoir_stored: Mapping[str, Array]
    reservoir_gained: Mapping[str, Array]
    residual: Array
    reservoir_residual: Mapping[str, Array]
    throughput: Array
    floor: float = 0.0

    def _facts(self) -> Mapping[str, Any]:
        def last(series: Mapping[Any, Array]) -> str:
            return f"{sum(float(each[-1]) for each in series.values()):.6g} J"

        return {
            "times": f"{len(self.times)} from {self.times[0]:g} to {self.times[-1]:g} s",
            "generated": last(self.generated),
            "stored": last(self.stored),
            "lost": last(self.lost),
            "imbalance": self.imbalance,
        }

    @property
    def imbalance(self) -> float:
        """Largest residual of body and reservoirs over the largest throughput, or over the floor if that is larger."""
        worst = max(float(np.max(np.abs(r))) for r in (self.residual, *self.reservoir_residual.values()))
        reference = max(float(np.max(self.throughput)), self.floor)
        return worst / reference if reference > 0 else worst


class Tally:
    """Collects energies and powers at the requested times for the `Budget`."""

    def __init__(
        self,
        entries: list[tuple[str, str, int]],
        regions: list[str],
        reservoirs: list[str],
        into: Mapping[tuple[str, int], str],
        between: Mapping[tuple[str, int], tuple[str, str | None]],
    ) -> None:
        self.entries, self.regions, self.reservoirs = entries, regions, reservoirs
        self.into, self.between = into, between
        self.floor = 0.0
        self.energy: list[Array] = []
        self.power: list[Array] = []
        self.stored: list[Array] = []
        self.storage_power: list[Array] = []
        self.kept: list[Array] = []

    def record(self, energy: Array, power: Array, stored: Array, storage_power: Array, kept: Array) -> None:
        """Add one requested time: ledger energies and powers, region energies and powers, reservoir energies."""
        for series, value in (
            (self.energy, energy),
            (self.power, power),
            (self.stored, stored),
            (self.storage_power, storage_power),
            (self.kept, kept),
        ):
            series.append(np.array(value))

    def budget(self, times: Array) -> Budget:
        """The finished budget."""
        n = len(times)

        def table(rows: list[Array], width: int) -> Array:
            return np.array(rows[:n]).reshape(n, width)

        energy, power = (table(rows, len(self.entries)) for rows in (self.energy, self.power))
        stored, storage_power = (table(rows, len(self.regions)) for rows in (self.stored, self.storage_power))
        kept = table(self.kept, len(self.reservoirs))
        generated: dict[str, Array] = {}
        generated_power: dict[str, Array] = {}
        lost: dict[str, Array] = {}
        lost_power: dict[str, Array] = {}
        by_condition: dict[tuple[str, int], Array] = {}
        power_by_condition: dict[tuple[str, int], Array] = {}
        gained = {name: np.zeros(n) for name in self.reservoirs}
        received = {name: np.zeros(n) for name in self.reservoirs}
        throughput = np.zeros(n)
        for j, (kind, name, index) in enumerate(self.entries):
            E, W = energy[:, j], power[:, j]
            throughput += np.abs(E)
            if kind == "source":
                generated[name] = generated.get(name, 0.0) + E
                generated_power[name] = generated_power.get(name, 0.0) + W
            elif kind == "boundary":
                lost[name] = lost.get(name, 0.0) - E
                lost_power[name] = lost_power.get(name, 0.0) - W
                by_condition[name, index], power_by_condition[name, index] = -E, -W
                if (name, index) in self.into:
                    received[self.into[name, index]] -= E
            else:
                owner, partner = self.between[name, index]
                gained[owner] += E
                if partner is not None:
                    gained[partner] -= E
        residual = sum(generated.values(), np.zeros(n)) - stored.sum(axis=1) - sum(lost.values(), np.zeros(n))
        return Budget(
            times=times,
            generated=generated,
            generated_power=generated_power,
            stored=dict(zip(self.regions, stored.T, strict=True)),
            stored_power=dict(zip(self.regions, storage_power.T, strict=True)),
            lost=lost,
            lost_power=lost_power,
            lost_by_condition=by_condition,
            lost_power_by_condition=power_by_condition,
            reservoir_stored=dict(zip(self.reservoirs, kept.T, strict=True)),
            reservoir_gained=gained,
            residual=residual,
            reservoir_residual={
                name: received[name] + gained[name] - kept[:, i] for i, name in enumerate(self.reservoirs)
            },
            throughput=throughput,
            floor=self.floor,
        )
