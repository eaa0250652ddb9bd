"""A belt of a radial, or its cap ply."""

from __future__ import annotations

from dataclasses import dataclass


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
