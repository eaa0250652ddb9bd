"""Layers of a radial, from its named numbers: plies, belts, cap ply, apex, turn-up, tread with grooves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from tyrefem.sizes.belt import Belt
from tyrefem.sizes.drawn import Drawn, length, section_data, table, thickness
from tyrefem.sizes.meridian import SizedMeridian
from tyrefem.sizes.radial import FABRIC, TOGETHER, Radial

#: Surface rubber is nowhere thinner, m.
SKIN = 1.2e-3


@dataclass(frozen=True)
class RadialLayers:
    """The tables of a radial's section file."""

    radial: Radial

    def n(self, name: str) -> float:
        """A number by its name, SI."""
        return self.radial.n(name)

    @property
    def line(self) -> SizedMeridian:
        """The plies' line."""
        return self.radial.line

    @property
    def places(self) -> dict[str, float]:
        """Stations of the construction along the line, m."""
        return self.radial.places

    def drawn(self, materials: Mapping[str, Any]) -> Drawn:
        """The section's file."""
        rules, line = self.radial.rules, self.line
        layers = self.layers()
        count = int(self.n("grooves"))
        grooves = None
        if count:
            # So many across the whole tread; an odd one in the middle.
            share = (np.arange(count) + 1) / (count + 1)
            at = np.sort(np.abs(2 * share - 1)[: (count + 1) // 2]) * self.radial.shoulder * 0.95
            width = self.n("groove_share") * self.n("tread_width") / count
            grooves = {
                "at": [length(max(x, 1e-6)) for x in at],
                "width": length(width),
                "source": rules.sources("grooves", "groove_share"),
            }
        data = section_data(
            self.radial.size,
            rules,
            line,
            self.radial.ply,
            layers,
            title=self.radial.title,
            shoulder_s=self.radial.shoulder,
            bead_length=line.length - self.places["bead"],
            grooves=grooves,
            wrap={"region": "bead-wrap", "source": "estimate: the plies keep their thickness below the bead wires"},
        )
        return Drawn(self.radial.size, rules, line, data, materials)

    def _rows(self, index: int, belt: Belt) -> list[tuple[float, float]]:
        """(s, thickness) of a belt's layer, from the belt to the bead."""
        p, thin, gauge, edge = self.places, self.n("rest_gauge"), self.n(belt.gauge), self.n(belt.width) / 2
        rows = [
            (0.0, gauge),
            (edge, gauge),
            (p["peak"], max(belt.cushion, thin)),
            (p["cushion"], 1.3 * thin),
            (p["wide"], thin),
        ]
        if index == 0:
            width = self.n("bead_width")
            bends = self.radial.reinforced and p["tip"] + TOGETHER < p["flange"] < p["bead"] - TOGETHER
            full = [(p["flange"], width)] if bends else []
            return [*rows, (p["tip"], thin), *full, (p["bead"], width), (p["end"], width)]
        if index == 1:
            lead = min(2.5 * self.radial.ply_gauge, (p["turn-up"] - p["wide"]) / 2)
            return [
                *rows,
                (p["turn-up"] - lead, thin),
                (p["turn-up"], self.radial.ply_gauge),
                (p["end"], self.radial.ply_gauge),
            ]
        return [*rows, (p["end"], thin)]

    def _regions(self, index: int, belt: Belt) -> list[dict[str, str]]:
        p = self.places
        regions = [{"name": belt.region, "to": length(self.n(belt.width) / 2)}]
        if belt.cushion:
            regions.append({"name": "shoulder-cushion", "to": length(p["cushion"])})
        elif self.n(belt.width) / 2 < p["peak"] - 10e-3:
            regions.append({"name": "undertread", "to": length(p["peak"])})
        if index > 1:
            return [*regions, *self._wall()]
        below = [{"name": "bead-wrap", "to": self._back(p["bottom"] + self.radial.ply_gauge)}, {"name": "chafer"}]
        if index == 1:
            return [
                *regions,
                {"name": "sidewall", "to": self._back(p["turn-up"])},
                {"name": "turn-up", "to": self._back(p["bottom"])},
                *below,
            ]
        parts, reached = [], p["tip"]
        for number, (name, share) in enumerate(self.radial.apex):
            reached += share * (p["bead"] - p["tip"])
            last = number == len(self.radial.apex) - 1
            parts.append({"name": name, "to": "bead_start" if last else self._back(reached)})
        return [
            *regions,
            {"name": "sidewall", "to": self._back(p["tip"])},
            *parts,
            {"name": "bead", "to": self._back(p["bottom"])},
            *below,
        ]

    def _wall(self) -> list[dict[str, str]]:
        return [{"name": "sidewall", "to": f"-{length(self.n('chafer_height'))}"}, {"name": "chafer"}]

    def _back(self, s: float) -> str:
        return f"-{length(self.line.length - s)}"

    def layers(self) -> list[dict[str, Any]]:
        """The tables, from the inside to the outside."""
        p, rules, thin = self.places, self.radial.rules, self.n("rest_gauge")
        liner, gauge, end = self.n("liner_gauge"), self.radial.ply_gauge, self.line.length
        wrap = [
            {"name": self.radial.ply, "to": self._back(p["bottom"])},
            {"name": "bead-wrap", "to": self._back(p["bottom"] + gauge)},
            {"name": "chafer"},
        ]
        rows = {
            "liner": [(0.0, liner), (end, liner)],
            self.radial.ply: [(0.0, gauge), (end, gauge)],
            **{f"{belt.region}": self._rows(index, belt) for index, belt in enumerate(self.radial.belts)},
            "undertread": [
                (0.0, self.n("undertread_gauge")),
                (self.radial.shoulder, self.n("undertread_gauge")),
                (p["cushion"], 1.3 * thin),
                (p["wide"], thin),
                (end, thin),
            ],
        }
        layers = [
            table(
                "liner",
                rows["liner"],
                [{"name": "liner", "to": "rim_start"}, {"name": FABRIC if self.radial.reinforced else "chafer"}],
                rules.sources("liner_gauge"),
            ),
            table(self.radial.ply, rows[self.radial.ply], wrap, rules.sources("plies", "ply_gauge")),
        ]
        ends = {0: " and apex", 1: " and turn-up"}
        more = {0: ("apex_height", "bead_height", "bead_width"), 1: ("turn_up_height",)}
        for index, belt in enumerate(self.radial.belts):
            source = rules.sources(belt.width, belt.gauge, *more.get(index, ()), "rest_gauge")
            layers.append(
                table(belt.region + ends.get(index, ""), rows[belt.region], self._regions(index, belt), source)
            )
        layers.append(
            table(
                "undertread",
                rows["undertread"],
                [{"name": "undertread", "to": length(p["peak"])}, *self._wall()],
                rules.sources("undertread_gauge"),
            )
        )
        wall = self._wall()
        if self.radial.reinforced:
            wall = [wall[0], {"name": "chafer", "to": f"-{length(self.n('fabric_height'))}"}, {"name": FABRIC}]
        surface = rules.sources("tread_gauge", "tread_radius", "sidewall_gauge", "chafer_gauge", "chafer_height")
        layers.append(table("tread", self._surface(rows), [{"name": "tread", "to": "shoulder"}, *wall], surface))
        return layers

    def _surface(self, rows: Mapping[str, list[tuple[float, float]]]) -> list[tuple[float, float]]:
        """(s, thickness) of the outermost layer: what is left up to the tyre's outside."""
        p, sh = self.places, self.radial.shoulder
        tread = np.linspace(0.0, sh, 6)
        rounded = sh - np.array([0.25, 0.5, 0.75, 1.0]) * self.radial.tread.rounding_width
        edge = sh + np.array([0.2, 0.4, 0.6, 0.8]) * (p["wide"] - sh)
        wall = np.linspace(p["wide"], p["flange"], 6)
        low = [s for layer in rows.values() for s, _ in layer if s > p["flange"]]
        low.append((p["bead"] + p["bottom"]) / 2)
        s = np.unique(np.round(np.concatenate([tread, rounded, edge, wall, low, [p["end"]]]), 6))
        inside = [layer for name, layer in rows.items() if name not in ("liner", self.radial.ply)]
        below = self.radial.ply_gauge / 2 + np.sum([thickness(layer, s) for layer in inside], axis=0)
        shoulder = float(self.radial.tread.distance(np.array([sh]))[0])
        drop = np.clip((s - sh) / (p["wide"] - sh), 0, 1)
        rise = np.clip((s - p["wide"]) / (p["flange"] - p["wide"]), 0, 1)
        outside = np.where(
            s <= sh,
            self.radial.tread.distance(np.minimum(s, sh)),
            self.radial.wall_outside + (shoulder - self.radial.wall_outside) * (1 - drop) ** 2,
        )
        top = float(self.line.to_flange(p["flange"]))
        outside = np.where(
            s > p["wide"], self.radial.wall_outside + (top - self.radial.wall_outside) * rise**1.5, outside
        )
        at = self.line.to_flange(np.minimum(s, self.line.length - self.radial.rim.straight))
        outside = np.where(s > p["flange"], at, outside)
        return list(zip(s.tolist(), np.maximum(outside - below, SKIN).tolist(), strict=True))
