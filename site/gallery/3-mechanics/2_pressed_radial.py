"""
A radial tyre on the road
=========================

A 205/55R16, inflated and pressed by finite elements: footprint, stiffness, pressure. ``motion="linear"`` is a quick
look; the default, large motion, is what to trust.
"""

import matplotlib.pyplot as plt
import numpy as np

import tyrefem as tf

study = tf.study("passenger-205-55r16").replace({"mesh.size": "12 mm"})
tyre = study.press(deflection=0.02, motion="linear")
footprint = tyre.footprint
print(f"{footprint.load:.0f} N, {footprint.length * 1e3:.0f} mm long, {tyre.secant_stiffness / 1e3:.0f} N/mm")

# %%
# Pressure over the right half of the tread, along the road.

angles, pressure = footprint.grid.angles, footprint.pressure
along = footprint.grid.places(footprint.displacement, 0.0)[0].reshape(pressure.shape)
near = np.abs(angles) < 0.4
figure, axes = plt.subplots(figsize=(7, 3.5), layout="constrained")
for ring in range(0, pressure.shape[1], max(1, pressure.shape[1] // 5)):
    axes.plot(along[near, ring] * 1e3, pressure[near, ring] / 1e3, label=f"ring {ring}")
axes.set(xlabel="place along the road, mm", ylabel="pressure, kPa")
axes.legend(title="from the middle")
plt.show()

# %%
# The section is half a tyre: pressure times area of the half carries half the load. The stiffness lies in the range
# that is published for passenger tyres of this size, which this quick look overrates a little.

areas = footprint.grid.areas.reshape(pressure.shape) * footprint.grid.sides[:, None]
assert np.isclose((pressure * areas).sum(), footprint.load / 2, rtol=1e-3)
assert 160e3 < tyre.secant_stiffness < 240e3
