"""
A tan delta law of your own
===========================

The report's tan delta falls exponentially with temperature. Thermally activated losses follow Arrhenius' law. A file in
a folder that you name adds it; the study chooses it by its name. How much colder or warmer is the tyre?
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import tyrefem as tf
from tyrefem.contracts import check_file, template
from tyrefem.plugins import use

# The file that ``tyrefem new tan-delta-law arrhenius`` writes: tan d = value exp(activation (1/T - 1/at)).
folder = Path(tempfile.mkdtemp())
(folder / "arrhenius.py").write_text(template("tan-delta-law", "arrhenius"), encoding="utf-8")
checked = check_file(folder / "arrhenius.py")
print(*checked.lines, sep="\n")
assert checked.failed == 0

# %%
# Both laws have the same slope at 25 °C: the activation temperature is the report's rate times the temperature squared.

use(folder)
rate, kelvin = 0.0148, 273.15 + 25
law = {"law": "arrhenius", "value": 0.2, "activation": f"{rate * kelvin**2:.6g} K", "source": "example"}
coarse = {"mesh.size": "6 mm", "mesh.element": "P1"}
study = tf.study("nasa-22x5.5-8pr", coarse)
changed = study.replace({"materials.tread": {"base": "nasa-tread", "loss_tangent": law}})

temperatures = np.linspace(0, 120, 60)
laws = {"exponential": study.materials["tread"].loss_tangent, "arrhenius": changed.materials["tread"].loss_tangent}
figure, axes = plt.subplots(figsize=(7, 3.6), layout="constrained")
for name, tan_delta in laws.items():
    axes.plot(temperatures, tan_delta(temperatures), label=name)
axes.set(xlabel="temperature, °C", ylabel="tan delta of the tread")
axes.legend()
plt.show()

# %%
# At 80 °C Arrhenius' law keeps a seventh more loss, so the tread is a little warmer.

exponential, arrhenius = (tan_delta(80.0) for tan_delta in laws.values())
assert abs(arrhenius / exponential - 1.15) < 0.05
assert np.isclose(laws["arrhenius"](25.0), laws["exponential"](25.0))
warmer = changed.run().peaks["tread"].temperature - study.run().peaks["tread"].temperature
print(f"the tread is {warmer:.1f} K warmer")
assert 0.2 < warmer < 5
