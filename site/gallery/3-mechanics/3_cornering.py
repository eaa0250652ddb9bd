"""
Forces of a cornering tyre
==========================

Side force and aligning moment over the slip angle, by steady rolling with Coulomb friction.
"""

import matplotlib.pyplot as plt
import numpy as np

import tyrefem as tf

angles = np.radians([0.0, 1.0, 3.0, 6.0, 12.0])
study = tf.study("nasa-22x5.5-8pr").replace({"mesh.size": "14 mm"})
curve = study.slip_curve(slip_angle=angles, friction=0.8)
table = curve.table

figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.3), layout="constrained")
left.plot(np.degrees(angles), -table.F_y_N / 1e3, "o-")
left.set(xlabel="slip angle, deg", ylabel="side force, kN")
right.plot(np.degrees(angles), table.M_z_Nm, "o-", color="tab:red")
right.set(xlabel="slip angle, deg", ylabel="aligning moment, N m")
plt.show()

# %%
# Side force never exceeds friction times load. What the axle gives, friction takes: their powers agree.

assert (-table.F_y_N < 0.8 * table.F_z_N).all()
assert np.allclose(table.friction_power_W[1:], table.axle_power_W[1:], rtol=0.01)
