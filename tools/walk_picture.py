"""Draw the layers of packages and the walks through them as SVG: plain text, the same for the same walks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from xml.sax.saxutils import escape

from hand_overs import room

#: Sizes in pixels: of a floor, of the column with the rooms' names, of the picture, and above the floors.
FLOOR, NAMES, WIDTH, TOP = 40, 220, 1400, 64
INK, QUIET, LINES = "#222222", "#6b6b6b", "#d9d9d9"
FONT = "font-family='Helvetica, Arial, sans-serif'"


@dataclass(frozen=True)
class Trail:
    """A walk as it is drawn: its title, its modules in their order, its colour."""

    title: str
    modules: Sequence[str]
    colour: str


def picture(layers: Sequence[str], trails: Sequence[Trail]) -> str:
    """SVG of the floors, from people at the top to the ground, and each walk beside the other."""
    height = TOP + FLOOR * len(layers) + 12
    floors = [layer.split(" | ") for layer in layers]
    place = {name: TOP + FLOOR * number + FLOOR / 2 for number, names in enumerate(floors) for name in names}
    share = (WIDTH - NAMES - 20) / len(trails)
    drawn = [
        f"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {WIDTH} {height}' width='{WIDTH}' height='{height}'>",
        f"<rect width='{WIDTH}' height='{height}' fill='white'/>",
        _text(12, TOP - 18, "layers of packages, what people see at the top", 13, QUIET),
        *_floors(floors),
    ]
    for number, trail in enumerate(trails):
        drawn += _trail(trail, place, NAMES + number * share + 16, share - 24)
    return "\n".join([*drawn, "</svg>", ""])


def _floors(floors: Sequence[Sequence[str]]) -> list[str]:
    drawn = []
    for number, names in enumerate(floors):
        top = TOP + FLOOR * number
        shade = "#f7f7f7" if number % 2 == 0 else "#ffffff"
        drawn += [
            f"<rect x='0' y='{top}' width='{WIDTH}' height='{FLOOR}' fill='{shade}' stroke='{LINES}'/>",
            _text(12, top + FLOOR / 2 + 5, f"{number + 1}", 12, QUIET),
            _text(38, top + FLOOR / 2 + 5, ", ".join(names), 13, INK),
        ]
    return drawn


def _trail(trail: Trail, place: dict[str, float], left: float, width: float) -> list[str]:
    count = len(trail.modules)
    xs = [left + 30 + number * (width - 60) / max(count - 1, 1) for number in range(count)]
    ys = [place[room(module)] for module in trail.modules]
    points = " ".join(f"{x:.1f},{y:.1f}" for x, y in zip(xs, ys, strict=True))
    drawn = [
        _text(left, TOP - 40, trail.title, 15, trail.colour, weight="bold"),
        f"<polyline points='{points}' fill='none' stroke='{trail.colour}' stroke-width='2.5'/>",
    ]
    for number, (module, x, y) in enumerate(zip(trail.modules, xs, ys, strict=True)):
        name = module.removeprefix("tyrefem.").partition(".")[2] or room(module)
        # Neighbours on one floor have their names above and below.
        down = 24 if number % 2 else -14
        drawn += [
            f"<circle cx='{x:.1f}' cy='{y:.1f}' r='10' fill='{trail.colour}'/>",
            _text(x, y + 4, f"{number + 1}", 11, "white", anchor="middle", weight="bold"),
            _text(x, y + down, name, 12, trail.colour, anchor="middle", halo=True),
        ]
    return drawn


def _text(
    x: float, y: float, words: str, size: int, colour: str, *, anchor: str = "start", weight: str = "normal",
    halo: bool = False,
) -> str:  # fmt: skip
    behind = " stroke='white' stroke-width='4' paint-order='stroke'" if halo else ""
    return (
        f"<text x='{x:.1f}' y='{y:.1f}' {FONT} font-size='{size}' font-weight='{weight}' fill='{colour}' "
        f"text-anchor='{anchor}'{behind}>{escape(words)}</text>"
    )
