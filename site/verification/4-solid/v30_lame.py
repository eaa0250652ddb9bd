r"""
A thick cylinder of nearly incompressible rubber
================================================

**Problem.** A cylinder, radii 1 and 2 m, held along its axis, under a small inner pressure :math:`p`. With shear modulus G and Poisson's ratio
:math:`\nu`, and the outer radius :math:`b`,

.. math:: u_r = \frac{p}{2 G} \, \frac{r (1 - 2 \nu) + b^2/r}{b^2 - 1}

Elements that lock become far too stiff as :math:`\nu` goes to 1/2.

**Source.** Lamé's solution, plane strain.
"""

import matplotlib.pyplot as plt
import numpy as np
import skfem
from reference_table import ReferenceTable

from tyrefem.mechanics.solid.body import Body
from tyrefem.mechanics.solid.compounds import neo_hookean
from tyrefem.mechanics.solid.newton import NewtonChoice, equilibrium
from tyrefem.mechanics.solid.parts import RegionMaterial

shear, pressure = 1e6, 1.0


def displacement(bulk, n=4):
    """Radii, and computed and exact displacement over the pressure."""
    mesh = skfem.MeshQuad.init_tensor(np.linspace(1, 2, n + 1), np.linspace(0, 0.5, 3))
    mesh = mesh.with_subdomains({"rubber": lambda x: x[0] > 0}).with_boundaries(
        {"contained_air": lambda x: x[0] < 1 + 1e-9, "ends": lambda x: (x[1] < 1e-9) | (x[1] > 0.5 - 1e-9)}
    )
    body = Body(mesh, {"rubber": RegionMaterial(neo_hookean(shear, bulk))}, {"ends": "z"})
    r, nu = body.rings.nodes[0], (3 * bulk - 2 * shear) / (6 * bulk + 2 * shear)
    exact = pressure / (2 * shear) * (r * (1 - 2 * nu) + 4 / r) / 3
    return r, equilibrium(body, pressure, NewtonChoice(first_step=1.0)).displacement[0], exact, nu


table = ReferenceTable("A thick cylinder of nearly incompressible rubber", "closed form", "Lamé, plane strain")
figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
for bulk in (4.67e6, 1e8, 5e10):
    r, computed, exact, nu = displacement(bulk)
    inner = r.argmin()
    table.add(f"displacement of the bore, ν = {nu:.5f}", computed[inner] * 1e6, exact[inner] * 1e6, "µm", percent=0.1)
    order = np.argsort(r)
    axes.plot(r[order], exact[order] * 1e6, label=f"exact, ν = {nu:.5f}")
    axes.plot(r, computed * 1e6, "k.", markersize=4)

# %%
# **Result** with four elements through the wall.

axes.set(xlabel="radius, m", ylabel="displacement, µm")
axes.legend()
plt.show()

# %%

table
