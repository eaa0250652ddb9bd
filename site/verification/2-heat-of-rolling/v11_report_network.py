"""
The NASA report's own network
=============================

**Problem.** The report computes temperatures with a finite-difference network of 33 elements. The 22x5.5 8PR rolls ten minutes at 20 mph under
2700 lbf, from 25 °C, with the report's density of air.

**Source.** An independent re-implementation of the report's network (Clark & Dodge 1980, appendix I); its values, to a kelvin. The network is coarse:
agreement within 10 K is expected, away from the tread's surface, where its road film acts through 4 mm of rubber. :doc:`Evidence
</docs/evidence/physics>` explains the difference there.
"""

import matplotlib.pyplot as plt
from reference_table import ReferenceTable

import tyrefem as tf

network = {"crown-inner": 83, "crown-middle": 70, "shoulder-inner": 69, "sidewall-inner": 46, "sidewall-outer": 38}
result = tf.study("nasa-22x5.5-8pr", {"mesh.size": "5 mm", "boundaries.contained_air.law": "report"}).run()
last = result.readings.iloc[-1]

# %%
# **Result**

figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
axes.plot(list(network.values()), list(network), "s", label="network of the report")
axes.plot([last[name] for name in network], list(network), "o", label="tyrefem")
axes.set_xlabel("after ten minutes, degC")
axes.legend()
plt.show()

# %%

table = ReferenceTable(
    "The NASA report's own network", "other formulation", "33 elements of Clark & Dodge 1980, appendix I"
)
for name, temperature in network.items():
    table.add(name, last[name], temperature, "degC", within=10)
table
