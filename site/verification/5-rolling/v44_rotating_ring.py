r"""
Waves of a rotating ring
========================

**Problem.** On a ring that turns with :math:`\Omega`, a natural frequency splits into a forward and a backward wave, seen in the frame of the ring:

.. math:: \omega = \frac{2 n \Omega}{n^2 + 1} \pm \sqrt{\omega_0^2 + \left(\frac{n (n^2 - 1) \Omega}{n^2 + 1}\right)^2}

**Source.** Bryan (1890), *On the beats in the vibrations of a revolving cylinder or bell*.
"""

from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np
from reference_table import ReferenceTable

from tyrefem.mechanics.rolling.example_rings import ElasticRing


def turning(spin):
    """The ring with the tension of its rotation."""
    ring = ElasticRing(0.02)
    return replace(ring, tension=ring.line_density * (spin * ring.radius) ** 2)


table = ReferenceTable("Waves of a rotating ring", "closed form", "Bryan 1890")
for n in (2, 3):
    names = ("backward", "forward")
    for name, ours, exact in zip(names, turning(3.0).splitting(n, 3.0), turning(3.0).rotating(n, 3.0), strict=True):
        table.add(f"{n} lobes, {name}, 3 rad/s", abs(ours), abs(exact), "rad/s", percent=0.2)

# %%
# **Result**

spins = np.linspace(0.01, 4, 5)
fine = np.linspace(0.01, 4, 40)
figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
axes.plot(fine, np.abs([turning(spin).rotating(2, spin) for spin in fine]), "C0")
axes.plot(spins, np.abs([turning(spin).splitting(2, spin) for spin in spins]), "ko")
axes.set(xlabel="spin, rad/s", ylabel="frequency of two lobes, rad/s")
plt.show()

# %%

table
