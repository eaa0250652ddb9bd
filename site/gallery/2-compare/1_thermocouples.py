"""
Thermocouples compared
======================

Three measured runs of six thermocouples: how far is the model off, and is that more than the uncertainty? The tables
of this study are synthetic: the model with noise and displaced sensors made them.
"""

import matplotlib.pyplot as plt
import pandas as pd

import tyrefem as tf

study = tf.study("example-validation").replace({"mesh.size": "8 mm"})
comparison = study.compare()
rows = comparison.table[comparison.table.phase == "all"]
rows[["run", "sensor", "bias_K", "rms_K", "u_val_K", "verdict"]].round(2).head(6)

# %%
# The band is twice the validation uncertainty of ASME V&V 20.

map_of_bias = pd.pivot_table(rows, index="sensor", columns="run", values="bias_K")
uncertainty = pd.pivot_table(rows, index="sensor", columns="run", values="u_val_K")
figure, axes = plt.subplots(figsize=(8, 3.5), layout="constrained")
for number, run in enumerate(map_of_bias):
    places = [place + 0.2 * (number - 1) for place in range(len(map_of_bias))]
    axes.errorbar(places, map_of_bias[run], 2 * uncertainty[run], fmt="o", capsize=3, label=run)
axes.set_xticks(range(len(map_of_bias)), map_of_bias.index)
axes.axhline(0, color="grey", linewidth=0.8)
axes.set_ylabel("computed - measured, K")
axes.legend()
plt.show()

# %%
# Nothing was hidden in these tables: at most one row in twenty may lie beyond the band by chance.

beyond = rows.bias_K.abs() > 2 * rows.u_val_K
assert beyond.mean() < 0.2
