"""
The laser rig
=============

A laser heats the tread of a whole tyre; infrared cameras and a thermocouple watch. Such a test gives conductivity and
heat capacity of every layer. Here it is simulated, from the card of a rig as in Allouis et al. (2016).
"""

import matplotlib.pyplot as plt

from tyrefem import rig

tests = rig.simulate("trtlab", every=10.0, seed=1)
high, low = tests.runs["high"], tests.runs["low"]

figure, axes = plt.subplots(figsize=(7, 3.5), layout="constrained")
for name in high.temperatures:
    axes.plot(high.times, high.temperatures[name], label=name)
axes.set(xlabel="time, s", ylabel="temperature, degC")
axes.legend()
plt.show()

# %%
# The rise goes with the power, 0.8 W over 0.5 W; natural convection strengthens with temperature and takes a little.

idle = high.times <= 60
rises = [(run.temperatures.max() - run.temperatures[idle].mean()).iloc[0] for run in (high, low)]
powers = [tests.card.runs[name].power for name in ("high", "low")]
assert 0.9 * powers[0] / powers[1] < rises[0] / rises[1] < powers[0] / powers[1]
