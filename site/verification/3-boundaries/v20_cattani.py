r"""
Cattani's table of road films
=============================

**Problem.** The mean film between tread and road over the time of contact, for speeds from 10 to 150 km/h and footprints of several lengths:

.. math:: H_c = \sqrt{\lambda C v / FL}

**Source.** Cattani, Cattani & Magrini, *Tyre–Road Heat Transfer Coefficient Equation Proposal*, Appl. Sci. 13 (2023) 11996, table 2; its numbers are
in ``studies/cattani-road``.
"""

import matplotlib.pyplot as plt
import pandas as pd
from reference_table import ReferenceTable

from tyrefem import library
from tyrefem.boundaries.road_film import triangular_film

printed = pd.read_csv(library.shipped() / "studies/cattani-road/table-2.csv", comment="#", index_col=0)
computed = printed.copy()
for column in printed:
    length = float(column.split("_")[1])
    computed[column] = [triangular_film(speed / 3.6, length, 0.25, 2e6) for speed in printed.index]

# %%
# **Result**

figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
axes.plot(printed.index, printed, "k.")
axes.plot(computed.index, computed, linewidth=0.8)
axes.set(xlabel="speed, km/h", ylabel="film, W/m2/K (points: printed)")
plt.show()

# %%
# All values of the table; the printed ones have six decimals of 10⁴ W/m²/K.

difference = (computed - printed).abs()
table = ReferenceTable("Cattani's table of road films", "report", "Cattani et al. 2023, table 2")
table.add(f"largest difference of {printed.size} values", difference.max().max(), 0.0, "W/m²/K", within=0.0051)
for column in list(printed)[::2]:
    table.add(
        f"150 km/h, {column.split('_')[1]} m",
        computed.loc[150, column],
        printed.loc[150, column],
        "W/m²/K",
        within=0.0051,
    )
table
