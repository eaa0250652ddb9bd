r"""
A slab cools in air
===================

**Problem.** A slab of 20 mm rubber, insulated on one face, gives heat to air of 25 °C by a film :math:`h` on the other. If
:math:`h = k z \tan(z) / L`, the temperature keeps its shape and decays:

.. math:: T(x, t) = 25 + 60 \cos(z x / L) \exp(-z^2 a t / L^2), \quad a = k / C

**Source.** Carslaw & Jaeger, *Conduction of heat in solids* (1959), the first term of the series for a slab with radiation into a medium.
"""

import matplotlib.pyplot as plt
import numpy as np
import skfem
from reference_table import ReferenceTable

from tyrefem.conduction import Conduction, Film, Material

L, k, C, z = 0.02, 0.25, 2e6, np.pi / 4
mesh = (
    skfem.MeshQuad.init_tensor(np.linspace(0, L, 11), [0, 0.01])
    .with_subdomains({"slab": lambda x: x[0] > 0})
    .with_boundaries({"face": lambda x: x[0] > 0.9999 * L})
)
film = Film(h=k * z * np.tan(z) / L, sink=25.0)
slab = Conduction(mesh, {"slab": Material(k, C)}, {"face": film}, axisymmetric=False, element="P2")


def exact(x, t):
    return 25.0 + 60.0 * np.cos(z * x / L) * np.exp(-(z**2) * k / C * t / L**2)


start = exact(slab.operators.points[0], 0.0)
history = slab.transient(np.linspace(0, 3600, 13), start, tolerance=0.001)

# %%
# **Result**

x = np.linspace(0, L, 9)
computed = history.at([(place, 0.005) for place in x])
figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
for i in (0, 4, 8, 12):
    axes.plot(x * 1e3, exact(x, history.times[i]), label=f"exact, {history.times[i] / 60:g} min")
    axes.plot(x * 1e3, computed[i], "ko", markersize=3)
axes.set(xlabel="place, mm", ylabel="temperature, degC")
axes.legend()
plt.show()

# %%

table = ReferenceTable("A slab cools in air", "closed form", "Carslaw & Jaeger 1959")
for i in (4, 12):
    for j, place in ((0, "insulated face"), (8, "cooled face")):
        table.add(
            f"{place}, {history.times[i]:.0f} s", computed[i, j], exact(x[j], history.times[i]), "degC", within=0.005
        )
table.add("heat balance, share", history.budget.imbalance, 0.0, within=1e-9)
table
