r"""
The brush model
===============

**Problem.** Separate bristles under a parabolic pressure, at a slip angle. With :math:`s = C \tan\alpha / (3 \mu F_z)`

.. math:: \frac{F_y}{\mu F_z} = 3 s - 3 s^2 + s^3, \qquad \frac{M_z}{\mu F_z a} = s (1 - s)^3

**Source.** Pacejka, *Tyre and vehicle dynamics*; the limit of a stiff carcass and a soft tread.
"""

import matplotlib.pyplot as plt
import numpy as np
from reference_table import ReferenceTable

from tyrefem.mechanics.rolling.example_bodies import bristles
from tyrefem.mechanics.rolling.friction import RollingContact

count, normal, tangential, friction = 801, 1e-3, 2e-3, 0.3
step = 2.2 / count
x = (np.arange(count) - (count - 1) / 2) * step
gaps = (x**2 - 1) / 2
most = friction * (np.maximum(-gaps, 0) / normal).sum()
table = ReferenceTable("The brush model", "closed form", "brush model, parabolic pressure")
slips, forces, moments = np.array([0.1, 0.3, 0.5, 0.7, 0.9]), [], []
for s in slips:
    rigid = np.zeros((count, 2))
    rigid[:, 1] = 3 * most * s * tangential * step**2 / 2
    side = (
        -RollingContact(bristles(count, normal, tangential), gaps, rigid, np.full(count, friction)).solve().forces[:, 2]
    )
    forces.append(side.sum() / most)
    moments.append(-(x * side).sum() / most)
    table.add(f"F/(µ Fz), s = {s:g}", forces[-1], 3 * s - 3 * s**2 + s**3, percent=0.5)
    table.add(f"Mz/(µ Fz a), s = {s:g}", moments[-1], s * (1 - s) ** 3, percent=1)

# %%
# **Result**

fine = np.linspace(0, 1, 100)
figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
axes.plot(fine, 3 * fine - 3 * fine**2 + fine**3, label="side force")
axes.plot(fine, 5 * fine * (1 - fine) ** 3, label="5 x aligning moment")
axes.plot(slips, forces, "ko", label="tyrefem")
axes.plot(slips, 5 * np.array(moments), "ko")
axes.set(xlabel="s, slip over the slip of full sliding")
axes.legend()
plt.show()

# %%

table
