"""
Natural frequencies
===================

The natural frequencies of an inflated tyre check its mass and stiffness without any contact. Those of a 205/60R15 are
measured: published data of its belt, rim held, 2.2 bar. Nothing of the model is fitted to them.
"""

import matplotlib.pyplot as plt

import tyrefem as tf

measured = {"lateral": 41.47, "yaw and camber": 53.46, "wind-up": 67.73, "fore-aft and vertical": 76.63}  # Hz

study = tf.study("measured-205-60r15").replace({"mesh.size": "12 mm"})
modes = study.natural_frequencies([0, 1], pressure=2.2e5)
computed = {name: modes.frequency(name) for name in measured}

figure, axes = plt.subplots(figsize=(7, 3.5), layout="constrained")
places = range(len(measured))
axes.bar([place - 0.2 for place in places], measured.values(), 0.4, label="measured")
axes.bar([place + 0.2 for place in places], computed.values(), 0.4, label="computed")
axes.set_xticks(places, measured)
axes.set_ylabel("frequency, Hz")
axes.legend()
plt.show()

# %%
# The order of the modes is right, and every one is too low: rubber is stiffer at these frequencies and small amplitudes
# than in the slow tests of the cards.

assert sorted(computed, key=computed.get)[0] == "lateral"
for name, frequency in computed.items():
    print(f"{name:22s} {frequency:5.1f} Hz, {100 * (frequency / measured[name] - 1):+.0f} %")
    assert 0.7 < frequency / measured[name] < 1.1
