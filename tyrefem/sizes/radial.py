"""A radial to be drawn: its named numbers, its line, the places of its parts, and its material cards."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from tyrefem.errors import InputError
from tyrefem.sizes.belt import Belt
from tyrefem.sizes.cards import bead_card
from tyrefem.sizes.designation import TyreSize
from tyrefem.sizes.meridian import SizedMeridian, belted_meridian, radial_meridian
from tyrefem.sizes.rim import Rim
from tyrefem.sizes.rules import Rules
from tyrefem.sizes.tread import TreadSurface

#: Region of the chafer's fabric, and its card.
FABRIC = "chafer-fabric"
#: Ends of layers are not nearer to each other than this, m.
TOGETHER = 2e-3


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
    def line(self) -> SizedMeridian:
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
    def tread(self) -> TreadSurface:
        """The tread's surface; square shoulders where no number rounds them off."""
        rounding = self.n("tread_radius"), 0.0
        if "shoulder_radius" in self.rules.numbers:
            rounding = self.n("shoulder_radius"), self.n("shoulder_width")
        sizes = self.n("outer_diameter"), self.n("tread_width"), self.n("tread_radius")
        return TreadSurface(self.line, *sizes, *rounding)

    @cached_property
    def shoulder(self) -> float:
        """Where the tread ends along the line, m: at the tread's `edge`.

        Nearer than `TOGETHER` to a belt's edge it ends with the belt: an element between them would be a sliver.
        """
        end = self.tread.edge
        edges = [self.n(belt.width) / 2 for belt in self.belts]
        nearest = min(edges, key=lambda edge: abs(edge - end))
        return nearest if abs(nearest - end) < TOGETHER else end

    @cached_property
    def places(self) -> dict[str, float]:
        """Stations of the construction along the line, m."""
        end, wide, sh = self.line.length, self.line.widest_s, self.shoulder
        bottom = end - self.n("toe_gauge") - self.ply_gauge
        # The plies bend about the flange's side: the bundle's middle is shorter than the line below it.
        bead = self.line.before(bottom, self.n("bead_height"), (self.ply_gauge + self.n("bead_width")) / 2)
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
        if not places["flange"] < bottom:
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

    def ply_card(self, base: str, usual: int, diameter: float) -> dict[str, Any]:
        """Card of the body plies: the ``usual`` ends per metre of a ply at the crown, fewer where its cords would
        overlap at the bead, where the ply is narrowest. ``diameter``: of a cord, m."""
        plies, rim = round(self.n("plies")), self.line.rim
        least = float(self.line.at(self.places["bottom"] + self.ply_gauge)[0]) - self.ply_gauge / 2 * np.sin(rim.taper)
        ends = plies * min(usual, int(least / self.line.crown / diameter))
        return {"base": base, "cords": {"angle_radius": self.radius(), "ends": f"{ends} 1/m", "plies": plies}}

    def fabric_card(self) -> dict[str, Any]:
        """Region and card of the chafer's fabric: its angle holds at the flange's height."""
        radius = f"{(self.rim.diameter / 2 + self.rim.height) * 1e3:.2f} mm"
        return {FABRIC: {"base": FABRIC, "cords": {"angle_radius": radius}}}

    def belt_card(self, belt: Belt, base: str, **cords: Any) -> dict[str, Any]:
        """Card of a belt: its angle holds at the radius of its middle."""
        return {"base": base, "cords": {"angle_radius": self.radius(belt), **cords}}
