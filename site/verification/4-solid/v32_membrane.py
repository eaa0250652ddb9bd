r"""
Tension in an inflated torus
============================

**Problem.** A thin torus, radius of the tube :math:`r`, of its centre line :math:`b`, under pressure :math:`p`. The tension along the meridian at
radius :math:`R` from the axis:

.. math:: N_\varphi = \frac{p\, r}{2} \left(1 + \frac{b}{R}\right)

**Source.** Clark & Dodge 1980, appendix F. The top, where the membrane bends, is left out.
"""

import matplotlib.pyplot as plt
import numpy as np
import skfem
from reference_table import ReferenceTable

from tyrefem.mechanics.solid.body import Body
from tyrefem.mechanics.solid.compounds import neo_hookean
from tyrefem.mechanics.solid.newton import NewtonChoice, equilibrium
from tyrefem.mechanics.solid.parts import RegionMaterial

r, b, h, p, n = 0.1, 0.3, 5e-4, 1e4, 80
flat = skfem.MeshQuad.init_tensor(np.linspace(-0.5, 0.5, 2), np.linspace(0, np.pi, n + 1))
rho, angle = r + h * flat.p[0], flat.p[1]
mesh = skfem.MeshQuad(np.array([b + rho * np.cos(angle), rho * np.sin(angle)]), flat.t)
mesh = mesh.with_subdomains({"rubber": np.arange(n)}).with_boundaries(
    {"contained_air": lambda x: np.hypot(x[0] - b, x[1]) < r - h / 4, "symmetry": lambda x: x[1] < 1e-9}
)
body = Body(mesh, {"rubber": RegionMaterial(neo_hookean(1e9))}, {"symmetry": "z"})
state = body.state(equilibrium(body, p, NewtonChoice(first_step=1.0)).displacement, p)

radius, z = body.rings.points
sine, cosine = z / np.hypot(radius - b, z), (radius - b) / np.hypot(radius - b, z)
rr, zz, _, rz, _, _ = state.stress
along = rr * sine**2 + zz * cosine**2 - 2 * rz * sine * cosine
weights = np.asarray(body.rings.basis.dx)
tension = h * (along * weights).sum(axis=1) / weights.sum(axis=1)
place = radius.mean(axis=1)

# %%
# **Result**

figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
axes.plot(place, p * r / 2 * (1 + b / place), label="exact")
axes.plot(place, tension, ".", label="tyrefem")
axes.set(xlabel="radius from the axis, m", ylabel="tension, N/m")
axes.legend()
plt.show()

# %%

table = ReferenceTable("Tension in an inflated torus", "closed form", "Clark & Dodge 1980, appendix F")
for wanted in (0.21, 0.25, 0.35, 0.39):
    i = int(np.abs(place - wanted).argmin())
    table.add(f"tension at R = {place[i]:.3f} m", tension[i], p * r / 2 * (1 + b / place[i]), "N/m", percent=1)
table
