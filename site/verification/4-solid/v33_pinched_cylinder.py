r"""
The pinched cylinder
====================

**Problem.** A thin cylinder, R = 300, L = 600, t = 3, E = 3·10⁶, ν = 0.3, with end diaphragms, is pinched by two opposed forces P = 1 in its middle. The
displacement under a force is the sum of Fourier harmonics around the axis, each a solution on the section: the harmonics of tyrefem's footprint.

**Source.** Belytschko et al. (1985), the obstacle course of shell elements: 1.8248·10⁻⁵.
"""

import matplotlib.pyplot as plt
import numpy as np
import skfem
from reference_table import ReferenceTable
from scipy.sparse.linalg import spsolve

from tyrefem.mechanics.footprint.example_tyre import stress_free
from tyrefem.mechanics.footprint.harmonics import Harmonics

radius, t, young = 300.0, 3.0, 3e6
mesh = skfem.MeshQuad.init_tensor(np.array([radius - t / 2, radius + t / 2]), 300 * np.linspace(0, 1, 15) ** 1.7)
mesh = mesh.with_boundaries({"symmetry": lambda x: x[1] < 1e-9})
body = Harmonics(stress_free(mesh, young / 2.6, young / 1.2, fixed=()))
r, z = body.elements.nodes
ends = np.flatnonzero(z > 300 - 1e-9)
held = np.unique(np.concatenate([3 * ends, 3 * ends + 2, body.held]))
free = np.setdiff1d(np.arange(body.elements.n_dofs), held)
middle = 3 * int(np.argmin(abs(r - radius) + z))
load = np.zeros(body.elements.n_dofs)
load[middle] = 0.5  # half of P on the half cylinder
waves = np.arange(0, 81, 2)
parts = []
for n in waves:
    u = spsolve(body.stiffness(n)[free][:, free].tocsc(), load[free])
    parts.append(u[np.searchsorted(free, middle)] * (1 if n == 0 else 2) / np.pi)

# %%
# **Result**

figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
axes.plot(waves, np.cumsum(parts), "o-", markersize=3, label="tyrefem")
axes.axhline(1.8248e-5, color="k", linewidth=0.8, label="published")
axes.set(xlabel="harmonics", ylabel="displacement under the force")
axes.legend()
plt.show()

# %%

table = ReferenceTable("The pinched cylinder", "benchmark", "Belytschko et al. 1985")
table.add("displacement under the force, × 10⁵", sum(parts) * 1e5, 1.8248, percent=2)
table
