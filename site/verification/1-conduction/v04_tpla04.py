r"""
code_aster TPLA04: a hollow cylinder with a heat source
=======================================================

**Problem.** A hollow cylinder, radii 1 and 2 m, :math:`k = 1` W/m/K, with 100 W/m³ everywhere and both faces at 20 °C:

.. math:: T(r) = 20 - 25 (r^2 - 1) + 75 \ln r / \ln 2

**Source.** code_aster, test case TPLA04. Printed: 28.73 and 32.62 °C, slopes 58.2 and 30.17 W/m². The references below are exact.
"""

import matplotlib.pyplot as plt
import numpy as np
import skfem
from reference_table import ReferenceTable

from tyrefem.conduction import Conduction, Fixed, Material

mesh = (
    skfem.MeshTri.init_tensor(np.linspace(1, 2, 31), np.linspace(0, 0.05, 3))
    .with_subdomains({"wall": lambda x: x[0] > 0})
    .with_boundaries({"inside": lambda x: x[0] < 1 + 1e-9, "outside": lambda x: x[0] > 2 - 1e-9})
)
both = {"inside": Fixed(20.0), "outside": Fixed(20.0)}
field = Conduction(mesh, {"wall": Material(1.0, 2e6)}, both, {"wall": 100.0}, element="P2").steady()


def exact(r):
    return 20 - 25 * (r**2 - 1) + 75 * np.log(r) / np.log(2)


# %%
# **Result**

r = np.linspace(1, 2, 21)
figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
axes.plot(r, exact(r), label="exact")
axes.plot(r, field.at([(radius, 0.02) for radius in r]), "o", label="tyrefem")
axes.set(xlabel="radius, m", ylabel="temperature, degC")
axes.legend()
plt.show()

# %%

table = ReferenceTable(
    "code_aster TPLA04: hollow cylinder with a source", "benchmark", "code_aster TPLA04; closed form"
)
for radius in (1.2, 1.5):
    table.add(f"temperature at {radius} m", field.at((radius, 0.02))[0], exact(radius), "degC", within=1e-4)
per_area = field.flux_through("inside") / (2 * np.pi * 0.05)
table.add("flux through the inner face", per_area, 75 / np.log(2) - 50, "W/m2", percent=1e-3)
table.add("heat lost over heat generated", sum(field.lost.values()) / (100 * np.pi * 3 * 0.05), 1.0, within=1e-9)
table
