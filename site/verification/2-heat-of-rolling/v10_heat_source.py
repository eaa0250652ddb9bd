r"""
Heat of a revolution
====================

**Problem.** The NASA report prints its heat source in the units of its time:

.. math:: q = 0.00988 \, \frac{U v \tan\delta}{r_0 - D/3}

with q in cal/cm³/s, U in in-lbf/in³, v in ft/s, lengths in inches. Does the heat source of a study agree, in SI?

**Source.** Clark & Dodge 1980, equation 26. The report rounds its calorie: allowed is 0.1 %.
"""

import matplotlib.pyplot as plt
import numpy as np
import pint
from reference_table import ReferenceTable

import tyrefem as tf
from tyrefem.simulation.rolling_tyre import RollingTyre

constant = {f"materials.{region}.loss_tangent.law": "constant" for region in ("carcass", "tread", "sidewall", "bead")}
study = tf.study("nasa-22x5.5-8pr", {"mesh.size": "6 mm", **constant})
tyre = RollingTyre(study)
u = pint.UnitRegistry()
table = ReferenceTable("Heat of a revolution", "report", "Clark & Dodge 1980, equation 26")
case = tyre.schedule.cases[0][0]
v = u.Quantity(tyre.speed(0.0), "m/s").to("ft/s").magnitude
r = u.Quantity(case.outer_radius - case.deflection / 3, "m").to("inch").magnitude
computed, printed = [], []
for region, name, s, depth, loss in (
    ("I", "carcass under the tread", 0.01, 0.002, 0.10),
    ("II", "tread", 0.01, 0.010, 0.20),
    ("III", "sidewall carcass", 0.08, 0.003, 0.10),
):
    source, x = tyre.sources[region], study.section.place(np.array([s]), np.array([depth])).T
    U = u.Quantity(source.energy_density(x, 0.0)[0], "J/m**3").to("inch*lbf/inch**3").magnitude
    q = u.Quantity(source(x, 0.0, np.array([25.0]))[0], "W/m**3").to("cal/cm**3/s").magnitude
    table.add(f"heat source, {name}", q, 0.00988 * U * v * loss / r, "cal/cm³/s", percent=0.1)
    computed.append(source(x, 0.0, np.array([25.0]))[0] / 1e3)

# %%
# **Result**

figure, axes = plt.subplots(figsize=(6, 3), layout="constrained")
axes.barh([row.quantity.partition(", ")[2] for row in table.rows], computed)
axes.set_xlabel("heat source, kW/m3")
plt.show()

# %%

table
