"""The strain cycle of a load case by region: strain energy, shear strain amplitude, heat at the start."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief

if TYPE_CHECKING:
    import pandas as pd

    from tyrefem.inputs.loading import LoadCase
    from tyrefem.mechanics.strain_cycle import StrainCycle, Zone
    from tyrefem.simulation.rolling_tyre import RollingTyre

Array = NDArray[np.float64]
WHOLE = "whole tyre"


@dataclass(frozen=True, eq=False)
class StrainByRegion(Brief):
    """The strain cycle of the drive's largest deflection, region by region.

    Parameters
    ----------
    tyre : the rolling tyre. phase, knot : of the load case.
    """

    tyre: RollingTyre
    phase: int
    knot: int

    @classmethod
    def of(cls, tyre: RollingTyre) -> StrainByRegion:
        """The load case of the largest deflection of a tyre's drive."""
        return cls(tyre, *tyre.schedule.most_deflected)

    @property
    def case(self) -> LoadCase:
        """The load case."""
        return self.tyre.schedule.cases[self.phase][self.knot]

    @property
    def cycle(self) -> StrainCycle:
        """The strain cycle."""
        return self.tyre.schedule.cycles[self.phase][self.knot]

    @property
    def time(self) -> float:
        """Time of the load case, s."""
        phase, at = self.tyre.drive.phases[self.phase], self.tyre.schedule.knots[self.phase]
        return float(self.tyre.drive.starts[self.phase] + at[self.knot] * phase.duration * (1 - 1e-9))

    def heat_density(self, zone: Zone, points: Array) -> Array:
        """Heat source q, W/m3, at points (2, n) of a zone at the drive's initial temperature, without effects."""
        # A copy: the tyre's source keeps the energies at its nodes.
        source = replace(self.tyre.hysteresis[zone.name])
        return source(points, self.time, np.full(points.shape[1], self.tyre.drive.initial))

    @functools.cached_property
    def amplitudes(self) -> Mapping[str, tuple[float, float]]:
        """Region -> mean and highest shear strain amplitude of a revolution; empty without a footprint."""
        footprint: Any = getattr(self.cycle, "footprint", None)
        if footprint is None:
            return {}
        from tyrefem.mechanics.footprint.strain_amplitude import StrainAmplitude
        from tyrefem.mechanics.rolling.turning import cycle_of

        cycle = cycle_of(footprint)
        amplitudes, weights = StrainAmplitude(cycle, {}).amplitudes, cycle.elements.weights
        members = cycle.elements.mesh.subdomains or {}
        return {
            region: (float(np.average(amplitudes[here], weights=weights[here])), float(amplitudes[here].max()))
            for region, here in members.items()
            if region in self.tyre.study.section.regions
        }

    @functools.cached_property
    def table(self) -> pd.DataFrame:
        """A row per region (of arcs: per part of one strain law), the most heat first; the last is the whole tyre.

        ``volume_m3``; ``energy_mean_J_m3``, ``energy_highest_J_m3``: U per cycle; ``highest_s_m``,
        ``highest_depth_m``: where; ``amplitude_mean``, ``amplitude_highest``: shear strain (finite elements only);
        ``heat_W``, ``heat_share``: of the whole tyre in this load case, all of it at the initial temperature.
        """
        import pandas as pd

        rows: list[dict[str, Any]] = []
        for zone in self.tyre.schedule.zones:
            points, weights = self.tyre.mesh.ring_points(zone.name)
            energy = self.cycle.energy_density(zone.name, points)
            most = int(np.argmax(energy))
            s, depth = self.tyre.study.section.locate(points[:, [most]].T)
            mean, highest = self.amplitudes.get(zone.region, (np.nan, np.nan))
            rows.append(
                {
                    "region": zone.name if zone.name == zone.title else f"{zone.name}: {zone.title}",
                    "volume_m3": float(weights.sum()),
                    "energy_mean_J_m3": float(energy @ weights / weights.sum()),
                    "energy_highest_J_m3": float(energy[most]),
                    "highest_s_m": float(s[0]),
                    "highest_depth_m": float(depth[0]),
                    "amplitude_mean": mean,
                    "amplitude_highest": highest,
                    "heat_W": float(self.heat_density(zone, points) @ weights),
                }
            )
        table = pd.DataFrame(rows).sort_values("heat_W", ascending=False, ignore_index=True)
        volume, heat = table["volume_m3"].sum(), table["heat_W"].sum()
        top = max(rows, key=lambda row: float(row["energy_highest_J_m3"]))
        whole = {
            "region": WHOLE, "volume_m3": volume,
            "energy_mean_J_m3": (table["energy_mean_J_m3"] * table["volume_m3"]).sum() / volume,
            **{name: top[name] for name in ("energy_highest_J_m3", "highest_s_m", "highest_depth_m")},
            "amplitude_mean": np.nan, "amplitude_highest": table["amplitude_highest"].max(), "heat_W": heat,
        }  # fmt: skip
        table = pd.concat([table, pd.DataFrame([whole])], ignore_index=True)
        return table.assign(heat_share=table["heat_W"] / heat if heat > 0 else 0.0)
