r"""
code_aster TPLA01: a hollow cylinder with convection
====================================================

**Problem.** A hollow cylinder, radii 0.30 and 0.35 m, :math:`k = 1` W/m/K. Its bore is at 100 °C. Outside acts a film of
500 W/m²/K towards 17.034444 °C. Steady and axisymmetric:

.. math:: T(r) = 100 - 518.9727 \ln(r/0.3)

**Source.** code_aster, test case TPLA01. Printed: 66.506 and 20.0 °C; 1729.91, 1621.79, 1482.78 W/m².
"""

import matplotlib.pyplot as plt
import numpy as np
import skfem
from reference_table import ReferenceTable

from tyrefem.conduction import Conduction, Film, Fixed, Material

mesh = (
    skfem.MeshQuad.init_tensor(np.linspace(0.3, 0.35, 21), np.linspace(0, 0.01, 3))
    .with_subdomains({"wall": lambda x: x[0] > 0})
    .with_boundaries({"inside": lambda x: x[0] < 0.3 + 1e-9, "outside": lambda x: x[0] > 0.35 - 1e-9})
)
field = Conduction(
    mesh,
    {"wall": Material(conductivity=1.0, heat_capacity=2e6)},
    {"inside": Fixed(100.0), "outside": Film(h=500.0, sink=17.034444)},
    element="P2",
).steady()

# %%
# **Result**

r = np.linspace(0.3, 0.35, 11)
figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
axes.plot(r, 100 - 518.9727 * np.log(r / 0.3), label="exact")
axes.plot(r, field.at([(radius, 0.005) for radius in r]), "o", label="tyrefem")
axes.set(xlabel="radius, m", ylabel="temperature, degC")
axes.legend()
plt.show()

# %%

table = ReferenceTable(
    "code_aster TPLA01: hollow cylinder with convection", "benchmark", "code_aster TPLA01, printed values"
)
for radius, printed in ((0.32, 66.506), (0.35, 20.0)):
    table.add(f"temperature at {radius} m", field.at((radius, 0.004))[0], printed, "degC", within=5e-4)
for radius, printed in ((0.3, 1729.91), (0.32, 1621.79), (0.35, 1482.78)):
    table.add(f"radial flux at {radius} m", field.flux_at([(radius, 0.004)])[0, 0], printed, "W/m2", percent=0.2)
table.add("heat out over heat in", field.flux_through("outside") / -field.flux_through("inside"), 1.0, within=1e-9)
table
