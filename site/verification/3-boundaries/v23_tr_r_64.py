r"""
Load and deflection of an aircraft tyre
=======================================

**Problem.** How far does the 22x5.5 deflect under its load? NASA TR R-64 has, for type VII aircraft tyres, :math:`u = D/w` and :math:`C_z = 0.02`:

.. math:: \frac{F}{(p + 0.08\, p_r) \, w \sqrt{w d}} = 0.96\, u + 0.216\, u^2/C_z \;(u \le 10\, C_z/3), \qquad 2.4\, (u - C_z) \;(u > 10\, C_z/3)

tyrefem's other model, finite elements of the inflated tyre in large motion, reads nothing of the report.

**Source.** NASA TR R-64 (Smiley & Horne 1958), static; quoted from memory.
"""

import matplotlib.pyplot as plt
import numpy as np
from reference_table import ReferenceTable

import tyrefem as tf

w, d, rated = 5.5 * 0.0254, 22 * 0.0254, 156 * 6894.757
pressure, load = 83 * 6894.757, 2700 * 4.4482216


def force(deflection):
    u = deflection / w
    shape = np.where(u <= 0.2 / 3, 0.96 * u + 0.216 * u**2 / 0.02, 2.4 * (u - 0.02))
    return shape * (pressure + 0.08 * rated) * w * np.sqrt(w * d)


study = tf.study("nasa-22x5.5-8pr", {"mesh.size": "12 mm"})
tyre = study.press(load=load, pressure=pressure)

# %%
# **Result**

D = np.linspace(0, 0.035, 50)
curve = tyre.curve()
figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
axes.plot(D * 1e3, force(D) / 1e3, label="TR R-64")
axes.plot(curve[:, 0] * 1e3, curve[:, 1] / 1e3, "o", label="finite elements")
axes.set(xlabel="deflection, mm", ylabel="load, kN")
axes.legend()
plt.show()

# %%

exact = np.interp(load, force(D), D) * 1e3
table = ReferenceTable("Load and deflection of an aircraft tyre", "report", "NASA TR R-64, from memory")
table.add("deflection by finite elements", tyre.footprint.deflection * 1e3, exact, "mm", percent=6)
table
