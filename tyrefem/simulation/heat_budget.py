"""The heat budget of a run of the whole tyre: generated + sliding = stored + lost, in J and W."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.cache import read_only
from tyrefem.errors import InputError, nearest

if TYPE_CHECKING:
    import pandas as pd

    from tyrefem.conduction.budget import Budget

Array = NDArray[np.float64]

#: What a budget counts; heat of friction only with slip, lumped bodies only where there are some.
KINDS = ("generated", "sliding", "stored", "lost", "lumped")


@dataclass(frozen=True, eq=False)
class HeatBudget(Brief):
    """Heat of the whole tyre (a half section's is doubled).

    Body: sum generated + sum sliding = sum stored + sum lost. Lumped bodies: heat from the tyre = stored + passed on.

    Attributes
    ----------
    times : (n,) s. ``energies``, ``powers`` : (kind, name) -> (n,) J since the start, and W; kinds are
        ``generated`` by hysteresis (by strain zone), ``sliding`` (friction on the road, the tread's share; only with
        slip), ``stored`` (by region), ``lost`` (by boundary), ``lumped`` (gas, rim; J only).
    residual : (n,) J, generated + sliding - stored - lost. ``imbalance`` : largest residual over the largest
        throughput. ``floor`` : J, less is rounding (`tyrefem.conduction.budget.Budget`).

    All arrays are read-only.
    """

    times: Array
    energies: Mapping[tuple[str, str], Array]
    powers: Mapping[tuple[str, str], Array]
    residual: Array
    imbalance: float
    floor: float = 0.0

    def __post_init__(self) -> None:
        for name in ("energies", "powers"):
            object.__setattr__(self, name, {key: read_only(each) for key, each in getattr(self, name).items()})
        for name in ("times", "residual"):
            object.__setattr__(self, name, read_only(getattr(self, name)))

    def _facts(self) -> Mapping[str, Any]:
        kinds = dict.fromkeys(kind for kind, _ in self.energies if kind != "lumped")
        entries = [row for row in self.rows if row["kind"] in ("lost", "lumped")]
        return {
            "until": f"{float(self.times[-1]):g} s",
            **{kind: f"{self.total(kind):.6g} J, {float(self.power(kind)[-1]):.6g} W at the end" for kind in kinds},
            "imbalance": self.imbalance,
            **{f"{row['kind']}: {row['name']}": f"{row['energy_J'] + 0.0:.6g} J" for row in entries},
        }

    def total(self, kind: str) -> float:
        """Energy of a kind at the end, J; 0 of a kind that the run has not.

        Raises
        ------
        InputError : no such kind.
        """
        _check_kind(kind)
        return float(sum(series[-1] for (k, _), series in self.energies.items() if k == kind))

    @property
    def empty(self) -> bool:
        """True if no heat was generated, stored or lost, except for rounding."""
        return max((float(np.abs(series).max()) for series in self.energies.values()), default=0.0) <= self.floor

    @property
    def closing(self) -> str:
        """Text on the imbalance of the budget.

        >>> HeatBudget(np.zeros(1), {("lost", "rim"): np.array([1e-8])}, {}, np.array([1e-8]), 1.0, floor=1e-3).closing
        'no heat is exchanged'
        """
        return "no heat is exchanged" if self.empty else f"closes to {self.imbalance:.0e}"

    @property
    def made(self) -> float:
        """Heat into the rubber until the end, generated and sliding, J."""
        return self.total("generated") + self.total("sliding")

    def power(self, kind: str) -> Array:
        """Power of a kind over time, (n,) W; errors as `total`."""
        _check_kind(kind)
        return np.asarray(
            sum((series for (k, _), series in self.powers.items() if k == kind), np.zeros(len(self.times)))
        )

    @property
    def table(self) -> pd.DataFrame:
        """`rows` as a table."""
        import pandas as pd

        return pd.DataFrame(self.rows)

    @property
    def rows(self) -> list[dict[str, Any]]:
        """One row per entry: ``kind``, ``name``, ``energy_J`` and ``power_W`` at the end, ``share`` of `made`."""
        made = self.made
        rows = []
        for (kind, name), series in self.energies.items():
            power = self.powers.get((kind, name))
            rows.append(
                {
                    "kind": kind,
                    "name": name,
                    "energy_J": float(series[-1]),
                    "power_W": float("nan") if power is None else float(power[-1]),
                    "share": float(series[-1]) / made if made > 0 else float("nan"),
                }
            )
        return rows

    @property
    def series(self) -> pd.DataFrame:
        """`columns` as a table."""
        import pandas as pd

        return pd.DataFrame(self.columns)

    @property
    def columns(self) -> dict[str, Any]:
        """Powers over time: ``time_s`` and one column ``kind:name_W`` each."""
        columns: dict[str, Any] = {"time_s": self.times}
        return columns | {f"{kind}:{name}_W": series for (kind, name), series in self.powers.items()}

    def to_dict(self) -> dict[str, Any]:
        """Data for JSON: energies and final powers by kind and name, and the imbalance."""
        shares: dict[str, Any] = {"imbalance": self.imbalance, "residual_J": float(self.residual[-1])}
        for row in self.rows:
            entry = {"energy_J": row["energy_J"]}
            if row["kind"] != "lumped":
                entry["power_W"] = row["power_W"]
            shares.setdefault(row["kind"], {})[row["name"]] = entry
        return shares


def _check_kind(kind: str) -> None:
    if kind not in KINDS:
        raise InputError(f"no heat of the kind '{kind}'{nearest(str(kind), KINDS)}", field="kind")


#: (boundary, number of the condition) -> name in the budget.
NAMES = {("road", 0): "road contact", ("road", 1): "air at the tread", ("outside_air", 0): "outside air"}
#: Friction heat, and heat from a locked wheel to the passing road: their sum is the sliding heat of the tread.
FRICTION = "friction on the road"


def whole_tyre(
    budget: Budget, zone_titles: Mapping[str, str], half: bool, added: Mapping[tuple[str, int], str] | None = None
) -> HeatBudget:
    """Convert the budget of a section to that of the whole tyre; ``added`` names the conditions of effects."""
    names = NAMES | dict(added or {})
    factor = 2.0 if half else 1.0
    energies: dict[tuple[str, str], Array] = {}
    powers: dict[tuple[str, str], Array] = {}

    def add(kind: str, name: str, energy: Array, power: Array | None) -> None:
        # Two conditions may have one name.
        energies[kind, name] = energies.get((kind, name), 0.0) + factor * np.asarray(energy)
        if power is not None:
            powers[kind, name] = powers.get((kind, name), 0.0) + factor * np.asarray(power)

    for zone, energy in budget.generated.items():
        add("generated", zone_titles.get(zone, zone), energy, budget.generated_power[zone])
    rubbing = [key for key in budget.lost_by_condition if names.get(key) == FRICTION]
    if rubbing:
        energy = -np.sum([budget.lost_by_condition[key] for key in rubbing], axis=0)
        add("sliding", FRICTION, energy, -np.sum([budget.lost_power_by_condition[key] for key in rubbing], axis=0))
    for region, energy in budget.stored.items():
        add("stored", region, energy, budget.stored_power[region])
    for key, energy in budget.lost_by_condition.items():
        if key in rubbing:
            continue
        name = names.get(key, key[0].replace("_", " "))
        add("lost", name, energy, budget.lost_power_by_condition[key])
    for reservoir, energy in budget.reservoir_stored.items():
        add("lumped", f"{reservoir}: stored", energy, None)
        add("lumped", f"{reservoir}: passed on", -budget.reservoir_gained[reservoir], None)
    return HeatBudget(budget.times, energies, powers, factor * budget.residual, budget.imbalance, factor * budget.floor)
