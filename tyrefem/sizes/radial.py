"""Layers of a radial, from its named numbers: plies, belts, cap ply, apex, turn-up, tread with grooves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.sizes.cards import bead_card
from tyrefem.sizes.designation import TyreSize
from tyrefem.sizes.drawn import Drawn, length, section_data, table, thickness
from tyrefem.sizes.meridian import belted_meridian, radial_meridian
from tyrefem.sizes.rim import Rim
from tyrefem.sizes.rules import Rules

Array = NDArray[np.float64]
#: Surface rubber is nowhere thinner, m.
SKIN = 1.2e-3
#: Region of the chafer's fabric, and its card.
FABRIC = "chafer-fabric"
#: Range of a ``belt_power`` that is solved for: from a parabola, as the inflated 295/80R22.5 has it.
LEAST_POWER, MOST_POWER = 2.0, 5.0
#: A given crown radius that is as near as this to the one of a given ``belt_power`` is that one, as files write it.
SAME_RADIUS = 1e-3
#: Ends of layers are not nearer to each other than this, m.
TOGETHER = 2e-3


@dataclass(frozen=True)
class Belt:
    """A belt's region, its rule names for width and gauge, and the cushion at its edge, m."""

    region: str
    cushion: float

    @property
    def width(self) -> str:
        return f"{self.region.replace('-', '_')}_width"

    @property
    def gauge(self) -> str:
        return f"{self.region.replace('-', '_')}_gauge"


@dataclass(frozen=True)
class Radial:
    """A radial to be drawn: rules that hold all its numbers, its rim, and the names of its regions.

    The first belt's layer goes on as the apex, the second's as the turn-up. ``apex``: region of the apex and share
    of its height that it takes, from the tip on. ``share_end``: where the belts' share of the pressure ends,
    m along the line; None: the plies' crown is an arc. ``reinforced``: a bead of trucks and aircraft. Its apex is as
    thick as the bundle where the plies bend round the flange, and fabric wraps it: an inner leg on the plies, from the
    flange to the toe, and an outer one in the rim strip. ``belt_power``: that number's rule and
    source. None: solved for, so that the crown has ``crown_radius``. Without a source the crown is an arc.
    """

    size: TyreSize
    rules: Rules
    rim: Rim
    ply: str
    belts: tuple[Belt, ...]
    apex: tuple[tuple[str, float], ...]
    title: str
    bead_fill: float
    share_end: float | None = None
    reinforced: bool = False
    belt_power: tuple[float | None, str] = (None, "")

    def n(self, name: str) -> float:
        """A number by its name, SI."""
        return self.rules[name].value

    @cached_property
    def ply_gauge(self) -> float:
        """All body plies together, m."""
        return self.n("ply_gauge") * self.n("plies")

    @cached_property
    def crown_outside(self) -> float:
        """From the middle of the plies to the tread's surface, m."""
        return (
            self.ply_gauge / 2
            + sum(self.n(belt.gauge) for belt in self.belts)
            + self.n("undertread_gauge")
            + self.n("tread_gauge")
        )

    @cached_property
    def wall_outside(self) -> float:
        """The same at the widest place: thin rests of the layers, and sidewall rubber."""
        return self.ply_gauge / 2 + (len(self.belts) + 1) * self.n("rest_gauge") + self.n("sidewall_gauge")

    @cached_property
    def bead_outside(self) -> float:
        """The same at the bead: bundle, turn-up, rests and chafer."""
        thin = (len(self.belts) - 1) * self.n("rest_gauge")
        return self.ply_gauge / 2 + self.n("bead_width") + self.ply_gauge + thin + self.n("chafer_gauge")

    @cached_property
    def line(self) -> Any:
        """The plies' line."""
        crown = self.n("outer_diameter") / 2 - self.crown_outside
        if crown < self.rim.diameter / 2 + 0.02:
            raise InputError("leaves no room for a sidewall above the rim", field="parameters.outer_diameter")
        half = self.n("section_width") / 2 - self.wall_outside
        at_rim = self.rim, self.bead_outside, self.n("bend_radius")
        if self.share_end is None:
            return radial_meridian(crown, self.n("crown_radius"), half, *at_rim)
        return belted_meridian(crown, self.share_end, self.n("belt_power"), half, *at_rim)

    @cached_property
    def tread_edge(self) -> float:
        """Where the tread's surface is half the tread's width from the mid plane, m along the line."""
        s = np.linspace(0.0, self.line.widest_s * 0.999, 800)
        _, z, phi = self.line.at(s)
        beyond = np.flatnonzero(z + np.cos(phi) * self._to_tread(s) > self.n("tread_width") / 2)
        if not len(beyond):
            raise InputError("is wider than the section", field="parameters.tread_width")
        return float(s[beyond[0]])

    @cached_property
    def shoulder(self) -> float:
        """Where the tread ends along the line, m: at `tread_edge`.

        Nearer than `TOGETHER` to a belt's edge it ends with the belt: an element between them would be a sliver.
        """
        end = self.tread_edge
        edges = [self.n(belt.width) / 2 for belt in self.belts]
        nearest = min(edges, key=lambda edge: abs(edge - end))
        return nearest if abs(nearest - end) < TOGETHER else end

    @property
    def rounded_shoulder(self) -> tuple[float, float]:
        """Radius of the arc that rounds the tread off at its shoulder, and its axial width, m."""
        if "shoulder_radius" not in self.rules.numbers:
            return self.n("tread_radius"), 0.0
        return self.n("shoulder_radius"), self.n("shoulder_width")

    def _to_tread(self, s: Array) -> Array:
        """From the line to the tread's surface along the line's normal, m: the tread's arc, then the shoulder's."""
        r, z, phi = self.line.at(s)
        normal = np.stack([np.sin(phi), np.cos(phi)])
        radius = self.n("tread_radius")
        rounding, width = self.rounded_shoulder
        centre = np.array([self.n("outer_diameter") / 2 - radius, 0.0])
        angle = np.arcsin((self.n("tread_width") / 2 - width) / radius)
        turn = np.array([np.cos(angle), np.sin(angle)])

        def along(to: Array, of: float) -> Array:
            away = np.stack([r - to[0], z - to[1]])
            distance = (away * normal).sum(axis=0)
            return np.asarray(np.sqrt(np.maximum(of**2 - (away**2).sum(axis=0) + distance**2, 0.0)) - distance)

        tread = along(centre, radius)
        beyond = z + tread * normal[1] > radius * turn[1]
        return np.where(beyond, along(centre + (radius - rounding) * turn, rounding), tread)

    @cached_property
    def places(self) -> dict[str, float]:
        """Stations of the construction along the line, m."""
        end, wide, sh = self.line.length, self.line.widest_s, self.shoulder
        bottom = end - self.n("toe_gauge") - self.ply_gauge
        bead = bottom - self.n("bead_height")
        places = {
            "peak": sh + 0.2 * (wide - sh),
            "cushion": sh + 0.6 * (wide - sh),
            "wide": wide,
            "tip": bead - self.n("apex_height"),
            "turn-up": bead - self.n("turn_up_height"),
            "flange": self.line.flange_s,
            "bead": bead,
            "bottom": bottom,
            "end": end,
        }
        for name, number in (("tip", "apex_height"), ("turn-up", "turn_up_height")):
            if not wide + 2e-3 < places[name] < bead - 2e-3:
                most = bead - wide - 2e-3
                raise InputError(
                    f"must be from 2 mm to {most * 1e3:.4g} mm here: from the bead to below the widest place",
                    field=f"parameters.{number}",
                )
        if not places["flange"] < bead + self.n("bead_height"):
            raise InputError("the bead is higher than the rim's flange allows", field="parameters.bead_height")
        widest_belt = max(self.n(belt.width) for belt in self.belts) / 2
        if widest_belt > places["peak"] - 1e-3:
            raise InputError(
                f"a belt {2e3 * widest_belt:.4g} mm wide does not fit under a tread "
                f"{1e3 * self.n('tread_width'):.4g} mm wide; allowed along the plies here: up to "
                f"{2e3 * (places['peak'] - 1e-3):.4g} mm (narrower belts, or a wider tread_width)",
                field="parameters.tread_width",
            )
        return places

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
            bends = self.reinforced and p["tip"] + TOGETHER < p["flange"] < p["bead"] - TOGETHER
            full = [(p["flange"], 0.92 * width)] if bends else []
            return [
                *rows,
                (p["tip"], thin),
                *full,
                (p["bead"], 0.92 * width),
                ((p["bead"] + p["bottom"]) / 2, width),
                (p["end"], width),
            ]
        if index == 1:
            lead = min(2.5 * self.ply_gauge, (p["turn-up"] - p["wide"]) / 2)
            return [*rows, (p["turn-up"] - lead, thin), (p["turn-up"], self.ply_gauge), (p["end"], self.ply_gauge)]
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
        below = [{"name": "bead-wrap", "to": self._back(p["bottom"] + self.ply_gauge)}, {"name": "chafer"}]
        if index == 1:
            return [
                *regions,
                {"name": "sidewall", "to": self._back(p["turn-up"])},
                {"name": "turn-up", "to": self._back(p["bottom"])},
                *below,
            ]
        parts, reached = [], p["tip"]
        for number, (name, share) in enumerate(self.apex):
            reached += share * (p["bead"] - p["tip"])
            last = number == len(self.apex) - 1
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
        p, rules, thin = self.places, self.rules, self.n("rest_gauge")
        liner, gauge, end = self.n("liner_gauge"), self.ply_gauge, self.line.length
        wrap = [
            {"name": self.ply, "to": self._back(p["bottom"])},
            {"name": "bead-wrap", "to": self._back(p["bottom"] + gauge)},
            {"name": "chafer"},
        ]
        rows = {
            "liner": [(0.0, liner), (end, liner)],
            self.ply: [(0.0, gauge), (end, gauge)],
            **{f"{belt.region}": self._rows(index, belt) for index, belt in enumerate(self.belts)},
            "undertread": [
                (0.0, self.n("undertread_gauge")),
                (self.shoulder, self.n("undertread_gauge")),
                (p["cushion"], 1.3 * thin),
                (p["wide"], thin),
                (end, thin),
            ],
        }
        layers = [
            table(
                "liner",
                rows["liner"],
                [{"name": "liner", "to": "rim_start"}, {"name": FABRIC if self.reinforced else "chafer"}],
                rules.sources("liner_gauge"),
            ),
            table(self.ply, rows[self.ply], wrap, rules.sources("plies", "ply_gauge")),
        ]
        ends = {0: " and apex", 1: " and turn-up"}
        more = {0: ("apex_height", "bead_height", "bead_width"), 1: ("turn_up_height",)}
        for index, belt in enumerate(self.belts):
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
        if self.reinforced:
            wall = [wall[0], {"name": "chafer", "to": f"-{length(self.n('fabric_height'))}"}, {"name": FABRIC}]
        surface = rules.sources("tread_gauge", "tread_radius", "sidewall_gauge", "chafer_gauge", "chafer_height")
        layers.append(table("tread", self._surface(rows), [{"name": "tread", "to": "shoulder"}, *wall], surface))
        return layers

    def _surface(self, rows: Mapping[str, list[tuple[float, float]]]) -> list[tuple[float, float]]:
        """(s, thickness) of the outermost layer: what is left up to the tyre's outside."""
        p, sh = self.places, self.shoulder
        tread = np.linspace(0.0, sh, 6)
        rounded = sh - np.array([0.25, 0.5, 0.75, 1.0]) * self.rounded_shoulder[1]
        edge = sh + np.array([0.2, 0.4, 0.6, 0.8]) * (p["wide"] - sh)
        wall = np.linspace(p["wide"], p["flange"], 6)
        low = [s for layer in rows.values() for s, _ in layer if s > p["flange"]]
        s = np.unique(np.round(np.concatenate([tread, rounded, edge, wall, low, [p["end"]]]), 6))
        inside = [layer for name, layer in rows.items() if name not in ("liner", self.ply)]
        below = self.ply_gauge / 2 + np.sum([thickness(layer, s) for layer in inside], axis=0)
        shoulder = float(self._to_tread(np.array([sh]))[0])
        drop = np.clip((s - sh) / (p["wide"] - sh), 0, 1)
        rise = np.clip((s - p["wide"]) / (p["flange"] - p["wide"]), 0, 1)
        outside = np.where(
            s <= sh,
            self._to_tread(np.minimum(s, sh)),
            self.wall_outside + (shoulder - self.wall_outside) * (1 - drop) ** 2,
        )
        outside = np.where(
            s > p["wide"], self.wall_outside + (self.bead_outside - self.wall_outside) * rise**1.5, outside
        )
        return list(zip(s.tolist(), np.maximum(outside - below, SKIN).tolist(), strict=True))

    def add_bend(self) -> None:
        """Rule of the bend's radius: material outside of the plies lies evenly round the flange."""
        radius = self.n("flange_radius") + self.bead_outside
        source = (
            "flange_radius and what lies outside of the plies at the bead: the plies bend about the flange's centre"
        )
        self.rules("bend_radius", radius, "mm", source, 3e-3)

    def with_belt_share(self) -> Radial:
        """This radial, or with a ``belt_power``, given or of its kind, the one whose belts carry that share of the
        pressure up to the edge of the widest; `crown_radius` is then solved for.

        An arc is drawn where ``crown_radius`` is given, or no line has its kind's ``belt_power``.

        Raises
        ------
        InputError : both are given and do not agree; no line has the given ``belt_power``.
        """
        rules = self.rules
        given, flatness = "belt_power" in rules.given, "crown_radius" in rules.given
        if not (given or (self.belt_power[1] and not flatness)):
            return self
        power, words = self.belt_power
        if power is None and not given:
            power = self._power_of_crown_radius()
        rules("belt_power", power or LEAST_POWER, "1", words, 1.0, 20.0)
        try:
            belted = self._belted()
            radius = belted.line.crown_radius
        except InputError:
            if given:
                raise
            del rules.numbers["belt_power"]
            return self
        if flatness and abs(self.n("crown_radius") / radius - 1) > SAME_RADIUS:
            raise InputError(
                "is solved for where belt_power is given: give one of them", field="parameters.crown_radius"
            )
        source = "solved for: the belts' share of the pressure falls with belt_power to the edge of the widest belt"
        rules("crown_radius", radius, "mm", source)
        return belted

    def _power_of_crown_radius(self) -> float:
        """The ``belt_power``, to a hundredth, with which the crown is as flat as the rule of ``crown_radius``.

        The larger it is, the rounder the crown; too small a one has no line.
        """
        low, high = LEAST_POWER, MOST_POWER
        if self._is_rounder(low):
            return low
        while high - low > 5e-3:
            middle = (low + high) / 2
            low, high = (low, middle) if self._is_rounder(middle) else (middle, high)
        return round(high, 2)

    def _is_rounder(self, power: float) -> bool:
        """Whether the crown with a ``belt_power`` is rounder than by ``crown_radius``."""
        numbers = Rules(self.rules.given, dict(self.rules.numbers))
        numbers("belt_power", power, "1", "")
        try:
            return bool(replace(self, rules=numbers)._belted().line.crown_radius <= self.n("crown_radius"))
        except InputError:
            return False

    def _belted(self) -> Radial:
        """This radial with the belts' share up to the edge of the widest belt."""
        widths = [self.n(belt.width) for belt in self.belts if belt.width in self.rules.numbers]
        share_end = max(widths, default=0.0) / 2 or self.tread_edge
        belted = replace(self, share_end=share_end)
        # A belt without a width yet gets that of the tread, whose edge moves with the line.
        for _ in range(0 if widths else 30):
            share_end, before = belted.tread_edge, share_end
            belted = replace(self, share_end=share_end)
            if abs(share_end - before) < 1e-8:
                break
        return belted

    def drawn(self, materials: Mapping[str, Any]) -> Drawn:
        """The section's file."""
        rules, line = self.rules, self.line
        layers = self.layers()
        count = int(self.n("grooves"))
        grooves = None
        if count:
            # So many across the whole tread; an odd one in the middle.
            share = (np.arange(count) + 1) / (count + 1)
            at = np.sort(np.abs(2 * share - 1)[: (count + 1) // 2]) * self.shoulder * 0.95
            width = self.n("groove_share") * self.n("tread_width") / count
            grooves = {
                "at": [length(max(x, 1e-6)) for x in at],
                "width": length(width),
                "source": rules.sources("grooves", "groove_share"),
            }
        data = section_data(
            self.size,
            rules,
            line,
            self.ply,
            layers,
            title=self.title,
            shoulder_s=self.shoulder,
            bead_length=line.length - self.places["bead"],
            grooves=grooves,
            wrap={"region": "bead-wrap", "source": "estimate: the plies keep their thickness below the bead wires"},
        )
        return Drawn(self.size, rules, line, data, materials)

    def radius(self, belt: Belt | None = None) -> str:
        """Radius at the crown of a belt's middle, or of the plies' line, as a material card has it."""
        r = self.line.crown
        if belt is not None:
            inside = self.belts[: self.belts.index(belt)]
            r += self.ply_gauge / 2 + sum(self.n(other.gauge) for other in inside) + self.n(belt.gauge) / 2
        return f"{r * 1e3:.2f} mm"

    def bead_material(self, base: str, diameter: float) -> dict[str, Any]:
        """Card of the bundle of wires of a diameter, m."""
        area, height = self.n("bead_wire_area"), self.n("bead_height")
        plies = max(1, int(np.ceil(area / (np.pi * diameter / 4) / height / 0.9)))
        ends = {"ends": f"{area / (np.pi * diameter**2 / 4) / height:.5g} 1/m", "plies": plies}
        return bead_card(base, area / (height * self.n("bead_width")), ends)

    def fabric_card(self) -> dict[str, Any]:
        """Region and card of the chafer's fabric: its angle holds at the flange's height."""
        radius = f"{(self.rim.diameter / 2 + self.rim.height) * 1e3:.2f} mm"
        return {FABRIC: {"base": FABRIC, "cords": {"angle_radius": radius}}}

    def belt_card(self, belt: Belt, base: str, **cords: Any) -> dict[str, Any]:
        """Card of a belt: its angle holds at the radius of its middle."""
        return {"base": base, "cords": {"angle_radius": self.radius(belt), **cords}}
