"""
Change the load
===============

More load at the same pressure flexes the tyre more. Every key of a study changes by its dotted name.
"""

from itertools import pairwise

import matplotlib.pyplot as plt

import tyrefem as tf

loads = [2000, 2700, 3400, 4100]  # lbf
study = tf.study("nasa-22x5.5-8pr").replace({"mesh.size": "6 mm"})
results = [study.replace({"drive.load": f"{load} lbf"}).run() for load in loads]

shoulder = [result.readings["shoulder-inner"].iloc[-1] for result in results]
resistance = [result.rolling_resistance.force for result in results]

figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.5), layout="constrained")
left.plot(loads, shoulder, "o-")
left.set(xlabel="load, lbf", ylabel="inner shoulder after 10 min, degC")
right.plot(loads, resistance, "o-", color="tab:red")
right.set(xlabel="load, lbf", ylabel="rolling resistance, N")
plt.show()

# %%
# The NASA report states that more deflection raises the shoulder's temperature. Rolling resistance is the heat of a
# metre: power over speed.

assert shoulder == sorted(shoulder)
assert all(after > before + 10 for before, after in pairwise(shoulder))
for result, force in zip(results, resistance, strict=True):
    table = result.heat_budget.table
    power = table[table.kind == "generated"].power_W.sum()
    assert abs(power / (20 * 0.44704) - force) < 0.01 * force
