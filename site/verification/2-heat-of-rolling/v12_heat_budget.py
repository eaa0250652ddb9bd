"""
The heat budget of every shipped aircraft tyre
==============================================

**Problem.** Heat that the rubber loses per revolution, and heat of sliding, must be stored, or leave through road, air, contained air and rim. Does
the sum close?

**Source.** Conservation of energy.
"""

import matplotlib.pyplot as plt
from reference_table import ReferenceTable

import tyrefem as tf

table = ReferenceTable("The heat budget of every shipped aircraft tyre", "balance", "conservation of energy")
shares = {}
for name in ("nasa-22x5.5-8pr", "nasa-22x5.5-12pr", "nasa-taxi-takeoff", "nasa-brake-yaw-skid"):
    result = tf.study(name, {"mesh.size": "8 mm"}).run()
    budget = result.heat_budget.table
    generated = budget.energy_J[budget.kind.isin(["generated", "sliding"])].sum()
    spent = budget.energy_J[budget.kind.isin(["stored", "lost"])].sum()
    table.add(f"{name}: heat stored and lost over heat generated", spent / generated, 1.0, within=1e-9)
    shares[name] = budget[budget.kind == "lost"].set_index("name").energy_J / generated

# %%
# **Result**: where the heat of each run goes; the rest is stored.

figure, axes = plt.subplots(figsize=(7, 3.5), layout="constrained")
left = dict.fromkeys(shares, 0.0)
for place in shares["nasa-22x5.5-8pr"].index:
    widths = [each.get(place, 0.0) for each in shares.values()]
    axes.barh(list(shares), widths, left=list(left.values()), label=place)
    left = {name: left[name] + width for name, width in zip(shares, widths, strict=True)}
axes.set(xlabel="share of the heat lost through", xlim=(0, 1))
axes.legend(fontsize="small")
plt.show()

# %%

table
