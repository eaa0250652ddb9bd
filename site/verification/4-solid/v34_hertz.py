r"""
Hertz: a roller on a flat road
==============================

**Problem.** A solid roller of incompressible rubber (radius 1 m, G = 1 MPa, plane strain) is pressed 8 mm on a road by the harmonics of tyrefem's
footprint. With the load :math:`F'` per width and :math:`E^* = 4 G`

.. math:: a = \sqrt{\frac{4 F' R}{\pi E^*}}, \qquad p_0 = \frac{2 F'}{\pi a}, \qquad p(x) = p_0 \sqrt{1 - x^2/a^2}

**Source.** Hertz; Johnson, *Contact mechanics* (1985).
"""

import matplotlib.pyplot as plt
import numpy as np
import skfem
from reference_table import ReferenceTable

from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.example_tyre import stress_free

shear, width = 1e6, 0.02
radii = np.concatenate([np.linspace(0.25, 0.7, 7), 1 - 0.3 * np.linspace(1, 0, 15)[1:] ** 1.8])
mesh = skfem.MeshQuad.init_tensor(radii, np.array([0.0, width])).with_boundaries(
    {
        "rim": lambda x: x[0] < 0.251,
        "road": lambda x: x[0] > 0.9999,
        "symmetry": lambda x: (x[1] < 1e-9) | (x[1] > width - 1e-9),
    }
)
footprint = Pressing(stress_free(mesh, shear, 1e4 * shear)).at_deflection(0.008, 400)

per_width = footprint.load / (2 * width)
a = np.sqrt(4 * per_width / (np.pi * 4 * shear))
p0 = 2 * per_width / (np.pi * a)
pressure, x = footprint.pressure[:, 1], footprint.grid.angles

# %%
# **Result**

figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
fine = np.linspace(0, a, 200)
axes.plot(fine * 1e3, p0 * np.sqrt(1 - (fine / a) ** 2) / 1e3, label="Hertz")
axes.plot(x[x < 1.2 * a] * 1e3, pressure[x < 1.2 * a] / 1e3, "o", markersize=4, label="tyrefem, 400 harmonics")
axes.set(xlabel="place, mm", ylabel="pressure, kPa")
axes.legend()
plt.show()

# %%

table = ReferenceTable("Hertz: a roller on a flat road", "closed form", "Hertz; Johnson 1985")
table.add("half length", footprint.length / 2 * 1e3, a * 1e3, "mm", percent=3)
table.add("pressure in the middle", pressure[0] / 1e3, p0 / 1e3, "kPa", percent=1.5)
i = int(np.abs(x - 0.6 * a).argmin())
table.add("pressure near 0.6 a", pressure[i] / 1e3, p0 * np.sqrt(1 - (x[i] / a) ** 2) / 1e3, "kPa", percent=2)
table
