r"""
A belt on an elastic bed
========================

**Problem.** The belt of a tyre that corners, as a string under tension :math:`S`, or as a beam of stiffness :math:`EI`, on an elastic bed :math:`c`.
With the contact's half length :math:`a`, :math:`\sigma = \sqrt{S/c}` and :math:`\ell = (4 E I/c)^{1/4}`, the cornering stiffness is

.. math:: C = 2 c (a + \sigma)^2 \text{ (string)}, \qquad C = 2 c (a + \ell)^2 \text{ (beam)}

**Source.** Pacejka's string model; the beam model after Fiala. Equations derived again.
"""

import matplotlib.pyplot as plt
import numpy as np
from reference_table import ReferenceTable

from tyrefem.mechanics.rolling.example_bodies import beam, string
from tyrefem.mechanics.rolling.friction import RollingContact

bed, angle = 3.0, 1e-3


def side_forces(count, make, stiffness):
    """Places, and side force of every point that rolls with a small slip angle without sliding."""
    step = 3.0 / count
    x = (np.arange(count) - (count - 1) / 2) * step
    rigid = np.zeros((count, 2))
    rigid[:, 1] = angle * step
    gaps = np.where(np.abs(x) < 1, -1.0, 1.0)
    contact = RollingContact(make(count, step, stiffness, bed, 1e-3), gaps, rigid, np.full(count, 1e9))
    return x, -contact.solve().forces[:, 2]


table = ReferenceTable("A belt on an elastic bed", "closed form", "string and beam on an elastic bed")
sigma, length = np.sqrt(2.0 / bed), (4 * 0.05 / bed) ** 0.25
x, of_string = side_forces(601, string, 2.0)
table.add("string, cornering stiffness", of_string.sum() / angle, 2 * bed * (1 + sigma) ** 2, percent=0.2)
table.add(
    "string, aligning stiffness", -(x * of_string).sum() / angle, 2 * bed * (sigma * (sigma + 1) + 1 / 3), percent=0.5
)
x, of_beam = side_forces(601, beam, 0.05)
table.add("beam, cornering stiffness", of_beam.sum() / angle, 2 * bed * (1 + length) ** 2, percent=0.5)
exact = bed * (2 / 3 + 2 * length + 2 * length**2 + length**3)
table.add("beam, aligning stiffness", -(x * of_beam).sum() / angle, exact, percent=1)

# %%
# **Result**: side force along the contact, summed from the front; both belts jump at its ends.

figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
axes.plot(x, np.cumsum(of_string[::-1])[::-1] / angle, label="string")
axes.plot(x, np.cumsum(of_beam[::-1])[::-1] / angle, label="beam")
axes.set(xlabel="place over the half length", ylabel="side force from the front on, per slip angle")
axes.legend()
plt.show()

# %%

table
