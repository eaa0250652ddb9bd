"""
Wear of the tread
=================

Friction power by ring of the tread, from a tyre that rolls at a small slip angle, and what it wears off.
"""

import math

import matplotlib.pyplot as plt

import tyrefem as tf

study = tf.study("nasa-22x5.5-8pr").replace({"mesh.size": "14 mm", "materials.tread": "rubber-tread-aircraft"})
rolled = study.roll(slip_angle=math.radians(1.0), friction=0.8)
wear = rolled.wear()

z = wear.places[1]
figure, axes = plt.subplots(figsize=(7, 3.3), layout="constrained")
axes.plot(z * 1e3, wear.depth_per_km * 1e6, "o-")  # m per km -> mm per 1000 km
axes.set(xlabel="place across the tread, mm", ylabel="wear, mm per 1000 km")
plt.show()

# %%
# All friction power is shared out over the rings. The card's law is proportional to the energy, so the volume of a
# kilometre is 5 mm3 (from memory of published tests of treads) for each kJ of it.

turns_per_km = 1000 / wear.travel
energy_per_km = rolled.state.friction_power * 2 * math.pi / wear.spin * turns_per_km
assert math.isclose(wear.power.sum(), rolled.state.friction_power, rel_tol=1e-9)
assert math.isclose(wear.volume_per_km, 5e-12 * energy_per_km, rel_tol=0.01)
