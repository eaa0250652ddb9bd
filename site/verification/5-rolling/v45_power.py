"""
Power of a tyre that corners and brakes
=======================================

**Problem.** The axle's power, torque times angular speed and forces times velocity, must be the power of friction in the contact: nothing else takes energy
where the rubber has no loss.

**Source.** Conservation of energy, in steady rolling with Coulomb friction of a plain tyre at 20 m/s and 3 kN.
"""

import math

import matplotlib.pyplot as plt
from reference_table import ReferenceTable

from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.example_tyre import PlainTyre
from tyrefem.mechanics.footprint.road import Road
from tyrefem.mechanics.rolling.rolling_motion import RollingMotion
from tyrefem.mechanics.rolling.steady_rolling import RollingLoads, SteadyRolling

table = ReferenceTable("Power of a tyre that corners and brakes", "balance", "conservation of energy")
pressing = Pressing(PlainTyre().state(along=6), Road(math.inf))
results = {}
for angle, torque, camber in ((2, 0, 0), (8, 0, 0), (2, -400, 0), (4, 0, -4)):
    tyre = SteadyRolling(pressing, math.radians(camber), 1.0)
    loads = RollingLoads(load=3000.0, torque=torque)
    rolled = tyre.roll(RollingMotion(math.radians(angle), speed=20.0), loads, 60, guess=(0.02, 0.314))
    name = f"slip angle {angle}°, torque {torque} N m, camber {camber}°"
    table.add(f"friction power, {name}", rolled.friction_power, rolled.lost_power, "W", percent=1)
    results[name] = rolled

# %%
# **Result**: friction power by case.

figure, axes = plt.subplots(figsize=(7, 3), layout="constrained")
axes.barh(list(results), [rolled.friction_power / 1e3 for rolled in results.values()])
axes.set_xlabel("friction power, kW")
plt.show()

# %%

table
