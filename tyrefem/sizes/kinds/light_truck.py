"""Light-truck radials: ``LT245/75R16``, ``195/70R15C``."""

from __future__ import annotations

from tyrefem.sizes.designation import TyreSize
from tyrefem.sizes.drawn import Drawn
from tyrefem.sizes.kinds.passenger import draw_with
from tyrefem.sizes.rules import Rules


def draw(size: TyreSize, rule: Rules) -> Drawn:
    """A passenger construction with three body plies and a deeper tread, at the pressure of load range E."""
    return draw_with(size, rule, plies=3, tread=11e-3, pressure=550e3, density=53.0, apex=0.24)
