r"""
NAFEMS T3: a bar heated in a sine
=================================

**Problem.** A bar of length :math:`L = 0.1` m starts at 0 °C. One end stays at 0 °C, the other follows
:math:`100 \sin(\pi t / 40)` °C. Its material: :math:`k = 35` W/m/K, :math:`\rho = 7200` kg/m³, :math:`c = 440.5` J/kg/K. Wanted is the
temperature 0.08 m from the cold end after 32 s.

**Source.** NAFEMS, *The standard NAFEMS benchmarks* (1990), test T3: 36.60 °C. The series solution gives 36.603 °C.
"""

import matplotlib.pyplot as plt
import numpy as np
import skfem
from reference_table import ReferenceTable

from tyrefem.conduction import Conduction, Fixed, Material

L, k, C = 0.1, 35.0, 7200 * 440.5
mesh = (
    skfem.MeshTri.init_tensor(np.linspace(0, L, 21), np.linspace(0, 0.01, 3))
    .with_subdomains({"bar": lambda x: x[0] > 0})
    .with_boundaries({"cold": lambda x: x[0] < 1e-9, "driven": lambda x: x[0] > L - 1e-9})
)
problem = Conduction(
    mesh,
    {"bar": Material(conductivity=k, heat_capacity=C)},
    {"cold": Fixed(0.0), "driven": Fixed(lambda x, t: 100 * np.sin(np.pi * t / 40))},
    axisymmetric=False,
    element="P2",
)
history = problem.transient(np.linspace(0, 32, 33), initial=0.0, tolerance=0.001)
places = [(x, 0.005) for x in (0.02, 0.05, 0.08, 0.1)]
temperatures = history.at(places)

# %%
# **Result**

figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
axes.plot(history.times, temperatures, label=[f"{x:g} m" for x, _ in places])
axes.plot(32, 36.603, "ko", label="reference")
axes.set(xlabel="time, s", ylabel="temperature, degC")
axes.legend()
plt.show()

# %%

table = ReferenceTable("NAFEMS T3: a bar heated in a sine", "benchmark", "NAFEMS T3 (36.60 °C); series solution")
table.add("temperature at 0.08 m, 32 s", temperatures[-1, 2], 36.603, "degC", within=0.01)
table.add("heat balance: generated - stored - lost, share", history.budget.imbalance, 0.0, within=1e-9)
table
