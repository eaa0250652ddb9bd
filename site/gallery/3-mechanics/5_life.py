"""
Where cracks grow first
=======================

Small flaws grow in the strain cycle of a revolution. Which place fails first, and how much shorter does a hot tyre
last? The numbers are for comparing: no measured life stands behind them.
"""

import matplotlib.pyplot as plt
import numpy as np

import tyrefem as tf

coarse = {"mesh.size": "14 mm", "mechanics.strain": "fem", "mechanics.motion": "linear"}
study = tf.study("nasa-22x5.5-8pr").replace(coarse)
cold, hot = study.life(temperature=60.0), study.life(temperature=110.0)
for place in cold.places[:3]:
    print(f"{place.km:6.0f} km: {place.reason}")

# %%

temperatures = [60.0, 85.0, 110.0]
lives = [study.life(temperature=degrees).places[0].km for degrees in temperatures]
figure, axes = plt.subplots(figsize=(6, 3.3), layout="constrained")
axes.semilogy(temperatures, lives, "o-")
axes.set(xlabel="temperature everywhere, degC", ylabel="shortest life, km")
plt.show()

# %%
# Fifty kelvins shorten the life of the carcass by the factor of its card, exp(-50 b).

carcass = cold.members("carcass")
rate = study.materials["carcass"].fatigue.temperature_rate
assert np.allclose(hot.km[carcass] / cold.km[carcass], np.exp(-50 * rate))
