"""
A strain law of your own
========================

How hot would a tyre be whose strain energy is the same everywhere? A strain law says the energy of a loss cycle at
every point; this one is a constant, so the heat follows by hand.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import tyrefem as tf
from tyrefem.contracts import check_file
from tyrefem.plugins import use

FILE = '''
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from tyrefem.mechanics.strain_cycle import Zone
from tyrefem.mechanics.strain_laws import StrainLaw

#: Strain energy per cycle everywhere, J/m3: an assumption.
ENERGY = 30e3


@dataclass(frozen=True)
class EvenCycle:
    """The same energy in every region."""

    section: Any

    @property
    def zones(self):
        return tuple(Zone(region, region, region) for region in self.section.regions)

    def energy_density(self, zone, points):
        return np.full(np.shape(points)[1], ENERGY)


class Even(StrainLaw):
    """Strain energy that is the same everywhere, at every load."""

    name: ClassVar[str] = "even"
    title: ClassVar[str] = "the same everywhere"
    energy_exponent: ClassVar[float | None] = 0.0

    def provider(self, study):
        return lambda case: EvenCycle(study.section)
'''
file = Path(tempfile.mkdtemp()) / "even.py"
file.write_text(FILE, encoding="utf-8")
checked = check_file(file)
print(*checked.lines, sep="\n")
assert checked.failed == 0

# %%
# The report's law puts most of the energy into the carcass at the crown; here every part has the same.

use(file)
study = tf.study("nasa-22x5.5-8pr", {"mesh.size": "8 mm", "mesh.element": "P1"})
runs = {"report": study.run(), "the same everywhere": study.replace({"mechanics.strain": "even"}).run()}

figure, pictures = plt.subplots(1, 2, figsize=(8, 3.6), layout="constrained")
for axes, (name, result) in zip(pictures, runs.items(), strict=True):
    result.plot(axes=axes)
    axes.set_title(name)
plt.show()

# %%
# Cold, the loss of a cycle is pi U tan delta (NASA report, equation 25). Summed over the volumes of the regions, which
# are those of half a tyre, it must be the integral over the elements.

even = runs["the same everywhere"]
volumes = even.summary()["section"]["volume_m3"]
tan_deltas = {region: float(card.loss_tangent(25.0)) for region, card in study.materials.items()}
per_revolution = 2 * sum(np.pi * 30e3 * tan_deltas[region] * volume for region, volume in volumes.items())
motion = even.tyre.motion(0.0)
computed = even.rolling_resistance.cold_force * motion.speed / motion.revolutions_per_second
print(f"{computed:.1f} J per revolution, by hand {per_revolution:.1f} J")
assert np.isclose(computed, per_revolution, rtol=0.01)
