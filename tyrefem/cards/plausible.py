"""Ranges of likely values for the numbers of cards, with their sources.

A number outside is a warning, not an error. Typical causes are a unit wrong by 1000, a decimal point, or a modulus in
place of a density. Zero, where a card allows it, means absent and gives no warning.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from tyrefem.errors import InputWarning

if TYPE_CHECKING:
    from pydantic import GetJsonSchemaHandler
    from pydantic_core import CoreSchema


@dataclass(frozen=True)
class Plausible:
    """Annotation of a card's field beside its `Unit`: the likely range, in that unit, and its source.

    >>> print(Plausible(100.0, 8000.0, "kg/m**3", "a book").warning(1.18, "density"))
    density: 1.18 kg/m3 is unlikely; likely are 100 to 8000 kg/m3 (a book); check the unit
    """

    low: float
    high: float
    unit: str
    source: str

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return {**handler(core), "x-likely": {"low": self.low, "high": self.high, "source": self.source}}

    def warning(self, value: float, field: str) -> InputWarning | None:
        """The warning for a value in SI, if it is outside the range."""
        if value == 0 or self.low <= value <= self.high:
            return None
        unit = "" if self.unit == "1" else f" {self.unit.replace('**', '').replace('*', ' ')}"
        words = f"{value:.4g}{unit} is unlikely; likely are {self.low:g} to {self.high:g}{unit} ({self.source})"
        return InputWarning(f"{words}; check the unit", field=field)


_BOOKS = "handbook values from memory"
DENSITY = Plausible(100.0, 8000.0, "kg/m**3", f"sponge rubber 100, compounds 900 to 1400, steel 7850; {_BOOKS}")
CONDUCTIVITY = Plausible(0.03, 60.0, "W/m/K", f"still air 0.026, compounds 0.13 to 0.5, carbon steel 50; {_BOOKS}")
SPECIFIC_HEAT = Plausible(400.0, 4200.0, "J/kg/K", f"steel 460, compounds 1400 to 2200, water 4180; {_BOOKS}")
LOSS_TANGENT = Plausible(
    1e-3,
    3.0,
    "1",
    "resilient gum 0.02, steel cord 0.001, rubber at its glass transition 1 to 3; textbooks, from memory",
)
SHEAR_MODULUS = Plausible(
    5e4,
    2e8,
    "Pa",
    "gum 0.2 MPa to hard apex 30 MPa, Gent, Engineering with Rubber, from memory; four to seven times more either way",
)
YOUNGS_MODULUS = Plausible(
    1.5e5, 2.5e11, "Pa", "three times a gum's shear modulus, steel wire 210 GPa; textbooks, from memory"
)
PLY_SHEAR_MODULUS = Plausible(
    1e6, 5e10, "Pa", "138 MPa for nylon at 35 deg, from rubber alone to steel cords at 45 deg: an estimate"
)
CORD_MODULUS = Plausible(
    5e8,
    3e11,
    "Pa",
    "nylon 2 to 5, polyester 4 to 10, rayon 6 to 12, aramid 60 to 130, steel 110 to 210 GPa; from memory",
)
CORD_DIAMETER = Plausible(5e-5, 5e-3, "m", "one filament to the wires of a large bead: an estimate")
EXPANSION = Plausible(
    5e-6, 4e-4, "1/K", "steel 1.2e-5, compounds 1.6e-4 to 2.4e-4, linear; handbook values from memory"
)
TEARING_ENERGY = Plausible(
    100.0, 2e5, "J/m**2", "gum 1 to 10, filled natural rubber 5 to 50 kJ/m2: Lake; Mars & Fatemi 2002, from memory"
)
GROWTH_RATE = Plausible(
    1e-8,
    1e-1,
    "m",
    "1 um to 1 mm a cycle near the tearing energy; Lake & Lindley, from memory; 100 times more either way",
)
CRACK = Plausible(1e-6, 2e-2, "m", "flaws of 20 to 50 um (Lake, Mars, from memory) to visible cracks: an estimate")
EMISSIVITY = Plausible(
    0.5, 1.0, "1", "hard rubber 0.94, soft grey rubber 0.89: Testo's table of emissivities; paint 0.9 to 0.96"
)
AIR_FILM = Plausible(
    0.5,
    1000.0,
    "W/m**2/K",
    "gases: free convection 2 to 25, forced 25 to 250 (Cengel, Heat Transfer); four times more either way",
)
CONTACT_FILM = Plausible(
    10.0, 1e6, "W/m**2/K", "NASA report 10460 on the road, 20920 at the rim; pressed rubber to bare metal: an estimate"
)
GAS_HEAT = Plausible(300.0, 15000.0, "J/kg/K", "argon 312 to hydrogen 14300; handbook values from memory")
SOLID_CAPACITY = Plausible(5e5, 5e6, "J/m**3/K", "light concrete to water, 4.2e6; handbook values from memory")
ROAD_CONDUCTIVITY = Plausible(0.05, 60.0, "W/m/K", "snow and cork to a steel drum; handbook values from memory")
WHEEL_MASS = Plausible(0.2, 500.0, "kg", "a kart's to an earth mover's wheel: an estimate")
GAS_CONSTANT = Plausible(50.0, 4200.0, "J/kg/K", "sulphur hexafluoride 57, air 287, hydrogen 4124; from memory")
GAS_DENSITY = Plausible(0.05, 100.0, "kg/m**3", "hydrogen 0.08, air 1.2, nitrogen at 40 bar 45; from memory")
FILM_PER_SPEED = Plausible(
    0.05, 50.0, "W*s/m**3/K", "NASA report 1.67 W/m2/K per m/s; thirty times more either way: an estimate"
)
CONTACT_RESISTANCE = Plausible(
    1e-7, 0.1, "m**2*K/W", "pressed metals 1e-5, a millimetre of air 0.04; handbook values from memory"
)
WHEEL_CONDUCTANCE = Plausible(0.01, 1e4, "W/K", "a wheel of 0.05 to 10 m2 in air: an estimate")
CONTACT_PRESSURE = Plausible(1e4, 2e7, "Pa", "tyres 0.1 to 3 MPa: an estimate")
DECOMPOSITION = Plausible(100.0, 1000.0, "degC", "vulcanisates soften and decompose at 200 to 450 degC; from memory")
STIFFNESS = Plausible(1e4, 2e7, "N/m", "bicycles 100, cars 200, lorries 1000, earth movers 5000 N/mm: an estimate")
FOOTPRINT = Plausible(5e-3, 2.0, "m", "a model's wheel to an earth mover's: an estimate")
RATED_LOAD = Plausible(10.0, 2e6, "N", "a model's wheel to an earth mover's, 1 MN: an estimate")
RATED_PRESSURE = Plausible(2e4, 3e6, "Pa", "balloon tyres 0.3 bar to aircraft 16 bar, bicycles 10 bar: an estimate")
WIRE_AREA = Plausible(1e-7, 5e-3, "m**2", "one wire of 0.4 mm to an earth mover's bead: an estimate")
CORD_ENDS = Plausible(50.0, 5e4, "1/m", "steel cords of an earth mover 200 a ply to many plies of nylon: an estimate")
BLOCK_LENGTH = Plausible(5e-4, 1.0, "m", "rubber between two sipes 3 mm to the lugs of a tractor: an estimate")
THERMOCOUPLE_LAG = Plausible(1e-3, 600.0, "s", "bare wires 0.01 s to a probe in a well, 60 s: an estimate")
THERMOCOUPLE_ERROR = Plausible(1e-3, 50.0, "delta_degC", "resolution 0.01 K to a wrong calibration: an estimate")
PLACING = Plausible(1e-6, 0.05, "m", "a drilling machine 0.05 mm to a place by eye 10 mm: an estimate")
ENERGY_DENSITY = Plausible(0.1, 1e7, "J/m**3", "a stiff bead 10 to a sheared belt edge 1e6 J/m3; rubber tears at 1e7")
AIR_TEMPERATURE = Plausible(-90.0, 100.0, "degC", "weather -89 to 57 degC, a climatic chamber: an estimate")
SOFTENED = Plausible(
    1e-3, 1e3, "1", "rubber loses a factor of about 1000 from its glassy to its rubbery modulus; textbooks, from memory"
)
