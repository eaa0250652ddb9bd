"""
Heat of braking
===============

An aircraft tyre yaws, brakes and skids with its wheel locked. Sliding friction heats tread and road together.
"""

import matplotlib.pyplot as plt

import tyrefem as tf

result = tf.study("nasa-brake-yaw-skid").replace({"mesh.size": "6 mm"}).run()
sliding = result.sliding.series.set_index("time_s")
result.sliding.table.T

# %%
# Locked, the tread slides at full speed over one place: its edge reaches the temperature at which rubber decomposes.

figure, axes = plt.subplots(figsize=(7, 3.5), layout="constrained")
for phase in result.phases:
    axes.axvspan(phase.start, phase.end, alpha=0.1)
    axes.text(phase.start, 20, phase.name, rotation=90, fontsize="small", va="bottom")
result.readings.set_index("time_s").iloc[:, :-1].plot(ax=axes, xlabel="time, s", ylabel="temperature, degC")
plt.show()

# %%
# All heat is accounted for: hysteresis and the tread's share of friction are stored or lost.

budget = result.heat_budget.table
came = budget.energy_J[budget.kind.isin(["generated", "sliding"])].sum()
went = budget.energy_J[budget.kind.isin(["stored", "lost"])].sum()
assert abs(went / came - 1) < 1e-9
