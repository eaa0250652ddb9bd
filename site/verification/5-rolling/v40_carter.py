r"""
Carter: a rolling cylinder that drives
======================================

**Problem.** An elastic cylinder rolls on an alike plane and carries a tangential force :math:`Q < \mu P`. Part of its contact sticks, the rest slips:

.. math:: \xi = \frac{\mu a}{R} \left(1 - \sqrt{1 - Q/(\mu P)}\right), \qquad \frac{\text{stick}}{\text{contact}} = \sqrt{1 - Q/(\mu P)}

**Source.** Carter (1926). The creep :math:`\xi` is given, the force is computed: tyrefem's friction of rolling on 401 points of a half plane.
"""

import matplotlib.pyplot as plt
import numpy as np
from reference_table import ReferenceTable

from tyrefem.mechanics.rolling.example_bodies import half_plane
from tyrefem.mechanics.rolling.friction import Control, RollingContact

count, radius, friction = 401, 50.0, 0.3
step = 2.4 / count
x = (np.arange(count) - (count - 1) / 2) * step
load, arms = np.pi / (4 * radius), np.zeros((count, 3))
arms[:, 0] = 1.0
sought = Control(-np.ones(count), np.zeros((count, 2)), arms, load)
body = half_plane(count, step, 1.0)

table = ReferenceTable("Carter: a rolling cylinder that drives", "closed form", "Carter 1926")
figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
for share in (0.25, 0.5, 0.75, 0.9):
    slips = np.zeros((count, 2))
    slips[:, 0] = friction / radius * (1 - np.sqrt(1 - share)) * step
    contact = RollingContact(body, x**2 / (2 * radius), slips, np.full(count, friction), [sought])
    answer = contact.solve(values=[1 / radius])
    traction = -answer.forces[:, 1] / step
    table.add(f"Q/(µP), creep for {share:g}", traction.sum() * step / (friction * load), share, percent=0.5)
    stick = (answer.states == 1).sum() / (answer.states > 0).sum()
    table.add(f"stick over contact, creep for {share:g}", stick, np.sqrt(1 - share), within=0.01)
    axes.plot(x, traction / (friction * 2 * load / np.pi), label=f"Q/(µP) = {share:g}")

# %%
# **Result**: traction along the contact; it rises along µp where the surface slips.

axes.set(xlabel="place over the half width of the contact", ylabel="traction over µ times the largest pressure")
axes.legend()
plt.show()

# %%

table
