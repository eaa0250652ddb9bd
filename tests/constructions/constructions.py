"""The shipped radials: section, study, coarse size of its mesh, and what is known about the tyre."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

import tyrefem as tf
from tyrefem.geometry import Section, load


@dataclass(frozen=True)
class Radial:
    """``mass`` [kg] and ``resistance``: usual ranges; ``voids``: share of the tread as drawn that grooves take
    away which are not drawn."""

    section_name: str
    study: str
    size: float
    outermost_belt: str
    mass: tuple[float, float]
    voids: float
    resistance: tuple[float, float]

    @property
    def section(self) -> Section:
        return load(self.section_name)


RADIALS = {
    # Usual ranges, from memory: 8 to 10 kg; resistance coefficients of car tyres 0.006 to 0.014.
    "passenger": Radial(
        "passenger-205-55r16", "passenger-205-55r16", 8e-3, "belt-1", (8.0, 10.0), 0.05, (0.006, 0.014)
    ),
    # From memory: 55 to 66 kg; resistance coefficients of truck tyres 0.004 to 0.008.
    "truck": Radial("truck-295-80r22.5", "truck-295-80r22.5", 14e-3, "belt-2", (55.0, 66.0), 0.03, (0.004, 0.008)),
    # An estimate of its own: as heavy as a bias tyre of the size (about 9 kg), and rolling easier than it.
    "aircraft": Radial(
        "aircraft-radial-22x5.5", "aircraft-radial", 6e-3, "inner-belts", (7.0, 10.0), 0.1, (0.004, 0.007)
    ),
}


@functools.cache
def coarse_run(name: str) -> Any:
    """The study with its given strain energies on a coarse mesh of linear elements, to 0.1 K in time."""
    radial = RADIALS[name]
    changes = {
        "mechanics.strain": "given",
        "mesh.size": f"{radial.size} m",
        "mesh.element": "P1",
        "numerics.tolerance": "0.1 delta_degC",
        "output.every": "300 s",
        "output.fields": 2,
    }
    return tf.study(radial.study).replace(changes).run()
