"""
Natural frequencies of a 205/60R15
==================================

**Problem.** The inflated tyre (2.2 bar), its rim held, without load: frequencies of the belt as a rigid ring, and the tyre's mass. Section and compounds
follow from the size by tyrefem's rules; nothing is fitted.

**Source.** Published MF-Swift parameters of one measured 205/60R15; ``studies/measured-205-60r15/structure.csv``. The allowed deviation is wide: it says
what the rules of a size are good for. Rubber is stiffer at these frequencies than in the slow tests of the cards. :doc:`Measured tyres </docs/measured>`
"""

import matplotlib.pyplot as plt
from reference_table import ReferenceTable

import tyrefem as tf

measured = {"lateral": 41.47, "yaw and camber": 53.46, "wind-up": 67.73, "fore-aft and vertical": 76.63}
modes = tf.study("measured-205-60r15", {"mesh.size": "12 mm"}).natural_frequencies([0, 1], pressure=2.2e5)

# %%
# **Result**

figure, axes = plt.subplots(figsize=(5, 4), layout="constrained")
axes.plot([35, 80], [35, 80], color="grey", linewidth=0.8)
for name, frequency in measured.items():
    axes.plot(frequency, modes.frequency(name), "o", label=name)
axes.set(xlabel="measured, Hz", ylabel="computed, Hz", aspect="equal")
axes.legend()
plt.show()

# %%

table = ReferenceTable("Natural frequencies of a 205/60R15", "measurement", "MF-Swift parameters of one tyre")
for name, frequency in measured.items():
    table.add(name, modes.frequency(name), frequency, "Hz", percent=30)
table.add("mass", modes.mass, 9.3, "kg", percent=5)
table
