"""The layouts of `benchmarks/plan.py`: sensors, first runs and competing effects, each with other likely confusions."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from tyrefem.effects import catalogue

#: Effects that compete in the layout "four".
ELEVEN = (
    "hot-road", "tread-slip", "brake-heat", "sun", "radiation", "loss-speed-exponent", "loss-temperature-law",
    "outside-film-speed", "pressure-rise", "under-inflation-flexing", "cord-conduction",
)  # fmt: skip
#: 15 minutes of rolling.
ROLLING: dict[str, Any] = {
    "speed": "20 mph", "load": "3000 lbf", "pressure": "83 psi", "ambient": "25 degC", "duration": "900 s",
}  # fmt: skip
#: 25 minutes of rolling, then ten minutes at rest.
COOLING: dict[str, Any] = {
    "speed": "20 mph", "load": "3000 lbf", "pressure": "83 psi", "ambient": "25 degC",
    "phases": [
        {"name": "rolling", "duration": "1500 s"},
        {"name": "standing", "speed": "0 mph", "duration": "600 s"},
    ],
}  # fmt: skip
#: Numbers of drives: the middle; corners by speed, load and pressure (lowest or highest).
MIDDLE, SLOW_LIGHT_SOFT, SLOW_HEAVY_SOFT, FAST_LIGHT_SOFT, FAST_HEAVY_SOFT = 0, 1, 3, 5, 7


@dataclass(frozen=True)
class LayoutChoice:
    """A layout: thermocouples besides the contained air, numbers of the first drives, the drive, competing effects.

    ``alike``: largest number of cases that hide the same effect. ``screened``: whether cases are tried only if the
    linear model, too, finds their first runs confounded.
    """

    sensors: tuple[str, ...]
    first: tuple[int, ...] = (MIDDLE,)
    drive: dict[str, Any] = field(default_factory=lambda: ROLLING)
    effects: tuple[str, ...] = tuple(catalogue())
    alike: int = 2
    screened: bool = True


LAYOUTS = {
    "four": LayoutChoice(
        ("crown-middle", "tread-outer", "shoulder-outer", "sidewall-outer"), effects=ELEVEN, alike=40, screened=False
    ),
    "crown": LayoutChoice(("crown-inner", "crown-middle")),
    "shoulder": LayoutChoice(("shoulder-inner", "sidewall-outer")),
    "bead": LayoutChoice(("crown-inner", "bead-middle")),
    "tread": LayoutChoice(("tread-outer", "sidewall-outer")),
    "tread, two loads": LayoutChoice(("tread-outer",), (SLOW_LIGHT_SOFT, SLOW_HEAVY_SOFT)),
    "tread, two speeds": LayoutChoice(("tread-outer",), (SLOW_LIGHT_SOFT, FAST_LIGHT_SOFT)),
    "shoulder, two runs": LayoutChoice(("shoulder-inner", "sidewall-outer"), (SLOW_LIGHT_SOFT, FAST_HEAVY_SOFT)),
    "cooling": LayoutChoice(("crown-inner", "sidewall-outer"), drive=COOLING),
}
