"""
A friction law of your own
==========================

Rubber grips less the faster it slides. A file adds a coefficient of friction that falls with the sliding speed; the
tread's card chooses it, and the rolling tyre loses side force where much of its contact slides.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import tyrefem as tf
from tyrefem.contracts import check_file
from tyrefem.plugins import use

FILE = '''
from typing import Annotated, ClassVar, Literal

from tyrefem.materials.road_friction import FrictionOnRoad
from tyrefem.quantity import Unit


class WetGrip(FrictionOnRoad):
    """mu = at_rest / (1 + v / falls_by_half)."""

    law: Literal["wet-grip"]
    at_rest: Annotated[float, Unit("1", gt=0, le=3)]
    falls_by_half: Annotated[float, Unit("m/s", gt=0)]

    # Values for ``tyrefem check``.
    example: ClassVar[dict] = {"at_rest": 0.8, "falls_by_half": "5 m/s"}

    # Arrays of one shape: sliding speed, m/s, contact pressure, Pa, temperature of the tread, degC.
    def mu(self, speed, pressure, temperature):
        return self.at_rest / (1 + speed / self.falls_by_half)
'''
file = Path(tempfile.mkdtemp()) / "wet_grip.py"
file.write_text(FILE, encoding="utf-8")
checked = check_file(file)
print(*checked.lines, sep="\n")
assert checked.failed == 0

# %%

use(file)
quick = {"mesh.size": "14 mm", "mesh.element": "P1", "mechanics.strain": "fem", "mechanics.motion": "linear"}
study = tf.study("nasa-22x5.5-8pr", quick)
laws = {
    "constant": {"law": "constant", "coefficient": 0.8, "source": "estimate: an example"},
    "own": {"law": "wet-grip", "at_rest": 0.8, "falls_by_half": "2 m/s", "source": "estimate: an example"},
}
angles = np.radians([0.5, 3.0, 10.0])
curves = {}
for name, law in laws.items():
    changed = study.replace({"materials.tread": {"base": "nasa-tread", "friction": law}})
    curves[name] = changed.slip_curve(slip_angle=angles).table
figure, axes = plt.subplots(figsize=(7, 3.4), layout="constrained")
for name, table in curves.items():
    axes.plot(np.degrees(angles), -table.F_y_N / table.F_z_N, "o-", label=name)
axes.set(xlabel="slip angle, deg", ylabel="side force over load")
axes.legend()
plt.show()

# %%
# At small angles nearly all of the contact sticks: the law hardly matters. At large ones all of it slides, with the
# rolling speed times the sine of the angle: the side force is that of the law at this speed.

grip = {name: (-table.F_y_N / table.F_z_N).to_numpy() for name, table in curves.items()}
assert abs(grip["own"][0] / grip["constant"][0] - 1) < 0.05
sliding = 20 * 0.44704 * np.sin(angles[-1])
by_hand = 0.8 / (1 + sliding / 2)
print(f"at 10 deg: {grip['own'][-1]:.3f} of the load, the law at {sliding:.2f} m/s: {by_hand:.3f}")
assert np.isclose(grip["own"][-1], by_hand, rtol=0.05)
