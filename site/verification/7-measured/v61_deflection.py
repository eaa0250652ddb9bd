"""
Deflection and footprint of a 205/60R15
=======================================

**Problem.** The same tyre pressed on a flat road by 4 kN at 2.2 bar: deflection and length of the footprint, by finite elements in large motion. Section
and compounds follow from the size by tyrefem's rules; nothing is fitted.

**Source.** Published Magic Formula parameters of one measured 205/60R15; ``studies/measured-205-60r15/summary.csv``.
"""

import matplotlib.pyplot as plt
from reference_table import ReferenceTable

import tyrefem as tf

loads, deflections = [2000, 3000, 4000, 5000, 6000], [10.5, 15.5, 20.3, 25.0, 29.6]  # measured, N and mm
tyre = tf.study("measured-205-60r15", {"mesh.size": "16 mm"}).press(load=4000.0, pressure=2.2e5)

# %%
# **Result**

curve = tyre.curve()
figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
axes.plot(deflections, loads, label="measured")
axes.plot(curve[:, 0] * 1e3, curve[:, 1], "o", label="tyrefem")
axes.set(xlabel="deflection, mm", ylabel="load, N")
axes.legend()
plt.show()

# %%

table = ReferenceTable("Deflection and footprint of a 205/60R15", "measurement", "Magic Formula parameters of one tyre")
table.add("deflection at 4 kN", tyre.footprint.deflection * 1e3, 20.3, "mm", percent=15)
table.add("length of the footprint", tyre.footprint.length * 1e3, 132, "mm", percent=10)
table
