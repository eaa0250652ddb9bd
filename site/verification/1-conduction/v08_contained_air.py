r"""
Contained air lags the wall
===========================

**Problem.** The wall of a tyre warms at :math:`c = 0.1` K/s. The contained air, a body of one temperature with heat capacity :math:`C_g`,
takes heat from it by a film: with :math:`\beta = h A / C_g`

.. math:: T_g = 25 + c t - \frac{c}{\beta} \left(1 - e^{-\beta t}\right)

**Source.** Clark & Dodge, *Heat generation in aircraft tires* (NASA, 1980), appendix G, equation G3.
"""

import matplotlib.pyplot as plt
import numpy as np
import skfem
from reference_table import ReferenceTable

from tyrefem.conduction import Conduction, Film, Fixed, Material, Reservoir

c, h, capacity = 0.1, 4.18, 20.0
mesh = (
    skfem.MeshTri.init_tensor(np.linspace(0.2, 0.21, 4), np.linspace(0, 0.1, 6))
    .with_subdomains({"wall": lambda x: x[0] > 0})
    .with_boundaries({"inside": lambda x: x[0] < 0.2 + 1e-9, "outside": lambda x: x[0] > 0.21 - 1e-9})
)
ramp = Fixed(lambda x, t: 25 + c * t)
wall = Conduction(
    mesh,
    {"wall": Material(50.0, 4e6)},
    {"inside": [Film(h, "air"), ramp], "outside": ramp},
    reservoirs={"air": Reservoir(capacity, initial=25.0)},
)
history = wall.transient(np.linspace(0, 600, 61), 25.0, 1e-4)
beta = h * 2 * np.pi * 0.2 * 0.1 / capacity
exact = 25 + c * history.times - c / beta * (1 - np.exp(-beta * history.times))

# %%
# **Result**

figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
axes.plot(history.times, 25 + c * history.times, label="wall")
axes.plot(history.times, exact, label="air, exact")
axes.plot(history.times[::6], history.reservoirs["air"][::6], "ko", label="air, tyrefem")
axes.set(xlabel="time, s", ylabel="temperature, degC")
axes.legend()
plt.show()

# %%

table = ReferenceTable("Contained air lags the wall", "closed form", "Clark & Dodge 1980, equation G3")
for i in (10, 30, 60):
    table.add(f"air after {history.times[i]:.0f} s", history.reservoirs["air"][i], exact[i], "degC", within=1e-4)
table.add("heat balance, share", history.budget.imbalance, 0.0, within=1e-9)
table
