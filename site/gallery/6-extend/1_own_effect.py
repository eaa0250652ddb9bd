"""
An effect of your own
=====================

A lamp shines on the sidewall; no effect of the catalogue says so. An effect is a small class in a Python file: which
quantity it changes, by how much, and where the number is from. `TYREFEM_PLUGINS` names the file's folder.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt

import tyrefem as tf
from tyrefem.effects import use_effects

FILE = '''
from typing import Annotated, ClassVar

from tyrefem.effects import Effect, Prior


class Lamp(Effect):
    """Flux through the outer sidewall."""

    name: ClassVar[str] = "lamp"
    family: ClassVar[str] = "boundary"
    sentence: ClassVar[str] = "A lamp shines on the sidewall."
    source: ClassVar[str] = "estimate: a halogen lamp of 500 W at 1 m"
    surfaces: ClassVar[tuple[str, ...]] = ("outside_air",)

    shine: Annotated[float, Prior("W/m**2", "flux through the sidewall", 50.0, 0.0, 1e4)] = 0.0

    def flux(self, tyre, surface, x, t):
        return self.shine
'''
folder = tempfile.mkdtemp()
Path(folder, "lamp.py").write_text(FILE, encoding="utf-8")
use_effects(folder)  # in this process; the same as TYREFEM_PLUGINS=folder

study = tf.study("nasa-22x5.5-8pr").replace({"mesh.size": "8 mm"})
lit = study.replace({"effects": [{"name": "lamp", "shine": "200 W/m**2"}]})
dark, bright = study.run(), lit.run()

sensors = [name for name in dark.readings if name not in ("time_s", "contained-air")]
warmer = (bright.readings[sensors] - dark.readings[sensors]).iloc[-1]
warmer.plot.barh(xlabel="warmer by the lamp, K", figsize=(7, 3))
plt.tight_layout()
plt.show()

# %%
# The sidewall's outside warms most, and by less than the flux over the film of the outside air, 5.44 + 1.674 v W/m2/K
# in the NASA report: that is where all of it would leave again.

film = 5.44 + 1.674 * 20 * 0.44704
assert warmer.idxmax() == "sidewall-outer"
assert 0.3 * 200 / film < warmer.max() < 200 / film
