r"""
Standing waves of a ring
========================

**Problem.** At which angular speed does a wave of :math:`n` lobes stand still on a rolling ring? With bending stiffness :math:`EI`, hoop tension
:math:`N` and an elastic bed :math:`k`

.. math:: \Omega_n^2 \, \rho A R^2 (n^2 - 1)^2 = \left(\frac{E I n^2}{R^2} + N\right)(n^2 - 1)^2 + k n^2 R^2

The smallest over :math:`n` is the critical speed of the ring.

**Source.** The ring on an elastic bed, inextensible; derived again.
"""

import matplotlib.pyplot as plt
from reference_table import ReferenceTable

from tyrefem.mechanics.rolling.example_rings import ElasticRing

ring = ElasticRing(0.01, tension=20.0, bed=500.0)
waves = range(2, 11)
computed, exact = [ring.slowest(n) for n in waves], [ring.critical(n) for n in waves]

# %%
# **Result**

figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
axes.plot(waves, exact, label="exact")
axes.plot(waves, computed, "o", label="tyrefem")
axes.set(xlabel="lobes n", ylabel="angular speed, rad/s")
axes.legend()
plt.show()

# %%

table = ReferenceTable("Standing waves of a ring", "closed form", "ring under tension on an elastic bed")
for n in (2, 5, 10):
    table.add(f"{n} lobes", computed[n - 2], exact[n - 2], "rad/s", percent=0.2)
table.add("critical speed", min(computed), min(exact), "rad/s", percent=0.1)
free = ElasticRing(0.02)
table.add("free ring, 3 lobes", free.slowest(3), free.critical(3), "rad/s", percent=0.2)
table
