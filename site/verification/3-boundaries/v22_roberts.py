"""
Rubber slides on wood
=====================

**Problem.** Pads of rubber slide over a wooden track; a thermocouple sees the rise behind the pad. All heat flows into the track, as into a half-space.

**Source.** Roberts' measured rises on chalked wood (his table 2, printed again in ``studies/roberts-sliding``). One row is left out: the clean pad
sticks and slips, and the paper itself found far less heat there.
"""

import matplotlib.pyplot as plt
from reference_table import ReferenceTable

from tyrefem.boundaries.friction_names import wood_rows

rows = [row for row in wood_rows() if row.name != "22x15"]
table = ReferenceTable("Rubber slides on wood", "measurement", "Roberts, table 2: measured rises")
for row in rows:
    table.add(row.name, row.predicted, row.observed, "K", percent=100 / 6)

# %%
# **Result**

figure, axes = plt.subplots(figsize=(6, 3.8), layout="constrained")
axes.errorbar(
    [row.observed for row in rows], [row.predicted for row in rows], xerr=[row.uncertainty for row in rows], fmt="o"
)
most = 1.1 * max(row.observed for row in rows)
axes.plot([0, most], [0, most], color="grey", linewidth=0.8)
axes.set(xlabel="measured rise, K", ylabel="predicted rise, K")
plt.show()

# %%

table
