r"""
code_aster TPLA07: an orthotropic cylinder between two streams
==============================================================

**Problem.** A hollow cylinder, radii 0.03 and 0.05 m, length 0.4 m, :math:`k_r = 2.89`, :math:`k_z = 40` W/m/K. Films inside (377 W/m²/K
towards :math:`130 + 12.5 z` °C) and outside (339.3 W/m²/K towards :math:`20 + 12.5 z` °C); 500 W/m² leave at z = 0 and enter at z = 0.4 m. The
exact temperature is

.. math:: T(r, z) = -117.4332 \ln r + 12.5 z - 311.7937

**Source.** code_aster, test case TPLA07. Its printed constants (-117.46, -311.87) are slightly off; the references below are the
exact ones.
"""

import matplotlib.pyplot as plt
import numpy as np
import skfem
from reference_table import ReferenceTable

from tyrefem.conduction import Conduction, Film, Flux, Material

mesh = (
    skfem.MeshQuad.init_tensor(np.linspace(0.03, 0.05, 17), np.linspace(0, 0.4, 41))
    .with_subdomains({"wall": lambda x: x[0] > 0})
    .with_boundaries({"inside": lambda x: x[0] < 0.03 + 1e-9, "outside": lambda x: x[0] > 0.05 - 1e-9})
    .with_boundaries({"bottom": lambda x: x[1] < 1e-9, "top": lambda x: x[1] > 0.4 - 1e-9})
)
field = Conduction(
    mesh,
    {"wall": Material(conductivity=(2.89, 40.0), heat_capacity=4e6)},
    {
        "bottom": Flux(-500.0),
        "top": Flux(500.0),
        "inside": Film(h=377.0, sink=lambda x, t: 130 + 12.5 * x[1]),
        "outside": Film(h=339.3, sink=lambda x, t: 20 + 12.5 * x[1]),
    },
    element="P2",
).steady()

# %%
# **Result**

r = np.linspace(0.03, 0.05, 11)
figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
for z in (0.0, 0.2, 0.4):
    axes.plot(r, -117.4332 * np.log(r) + 12.5 * z - 311.7937, label=f"exact, z = {z:g} m")
    axes.plot(r, field.at([(radius, z) for radius in r]), "ko", markersize=3)
axes.set(xlabel="radius, m", ylabel="temperature, degC")
axes.legend()
plt.show()

# %%

table = ReferenceTable("code_aster TPLA07: orthotropic cylinder", "benchmark", "code_aster TPLA07; exact constants")
for radius, exact in ((0.03, 99.993), (0.035, 81.890), (0.04, 66.209), (0.045, 52.378), (0.05, 40.005)):
    table.add(f"temperature at r = {radius} m, z = 0", field.at((radius, 0.0))[0], exact, "degC", within=1.5e-3)
table
