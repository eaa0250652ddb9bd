"""Light-truck radials: ``LT245/75R16``, ``195/70R15C``, ``31x10.50R15LT``."""

from __future__ import annotations

from tyrefem.sizes.designation import TyreSize
from tyrefem.sizes.drawn import Drawn
from tyrefem.sizes.kinds.passenger import draw_with
from tyrefem.sizes.rules import Rules

#: Pressure of the load ranges of metric sizes, Pa, and exponent of the load over it: LT245/75R16 carries 2205, 2623
#: and 3042 lb at 50, 65 and 80 psi (Tire and Rim Association, from memory). Flotation sizes have their own.
PRESSURES = {"C": 350e3, "D": 450e3, "E": 550e3}
EXPONENT = 0.7


def draw(size: TyreSize, rule: Rules) -> Drawn:
    """A passenger construction with three body plies and a deeper tread, at the pressure of the load range, else E."""
    pressure = PRESSURES.get(size.load_range or "", PRESSURES["E"])
    density = 53.0 * (pressure / PRESSURES["E"]) ** EXPONENT
    return draw_with(size, rule, plies=3, tread=11e-3, pressure=pressure, density=density, apex=0.24)
