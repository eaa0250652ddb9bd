"""
Can the sensors tell?
=====================

Before any test: which effects could these sensors and runs tell apart, if one were missing? No data are needed, only
the drives of the runs.
"""

import matplotlib.pyplot as plt

import tyrefem as tf
from tyrefem.diagnose.layout.isolability import isolability
from tyrefem.effects import catalogue

candidates = {"hot-road", "wet-road", "sun", "radiation", "leak"}
quick = {"mesh.size": "14 mm", "output.every": "60 s", "diagnosis.exclude": sorted(set(catalogue()) - candidates)}
layout = isolability(tf.study("hidden-effect").replace(quick))
table = layout.table.set_index("effect")
table.iloc[:, :4].round(3)

# %%
# The smallest amplitude that would be identified, over the effect's usual size: below one, the layout can tell.

share = layout.smallest / layout.scale
figure, axes = plt.subplots(figsize=(7, 2.8), layout="constrained")
axes.barh(table.index, share)
axes.axvline(1, color="k", linewidth=0.8)
axes.set_xlabel("smallest identifiable over usual size")
plt.show()

# %%
# Sun on the sidewall hides longest behind noise and uncertain films. An effect of twice the size is told from noise by
# four times the evidence: the separation goes with the square of the amplitude.

assert table.identifiable_at_usual.all()
assert share.max() < 1
