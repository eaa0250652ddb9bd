r"""
Order of accuracy: a manufactured solution
==========================================

**Problem.** The axisymmetric temperature

.. math:: T(r, z) = 40 + 20 \sin(2 r) \cos(3 z)

is made exact by the heat source :math:`q = -\mathrm{div}(k \nabla T)`, on a distorted mesh of quadrilaterals, with a fixed temperature inside, a
film outside, a flux on top and an insulated bottom. How fast does the error fall with the element's size?

**Source.** Theory of finite elements: the error of the temperature is of order 2 for linear and 3 for quadratic elements.
"""

import matplotlib.pyplot as plt
import numpy as np
import skfem
from reference_table import ReferenceTable

from tyrefem.conduction import Conduction, Film, Fixed, Flux, Material

k, h = 0.8, 6.0


def exact(r, z):
    return 40 + 20 * np.sin(2 * r) * np.cos(3 * z)


def slope(r, z):
    return 40 * np.cos(2 * r) * np.cos(3 * z), -60 * np.sin(2 * r) * np.sin(3 * z)


def source(x, t, T):
    return -k * (-13 * (exact(*x) - 40) + slope(*x)[0] / x[0])


def error(n, element):
    mesh = skfem.MeshQuad.init_tensor(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1))
    x, y = mesh.p
    bump = 0.08 * np.sin(np.pi * x) * np.sin(np.pi * y)
    mesh = skfem.MeshQuad(np.stack([0.5 + x + bump, y - bump]), mesh.t)
    mesh = mesh.with_subdomains({"body": lambda x: x[0] > 0}).with_boundaries(
        {
            "inside": lambda x: x[0] < 0.5 + 1e-9,
            "outside": lambda x: x[0] > 1.5 - 1e-9,
            "top": lambda x: x[1] > 1 - 1e-9,
        }
    )
    conditions = {
        "inside": Fixed(lambda x, t: exact(*x)),
        "outside": Film(h, lambda x, t: exact(*x) + k * slope(*x)[0] / h),
        "top": Flux(lambda x, t: k * slope(*x)[1]),
    }
    field = Conduction(mesh, {"body": Material(k, 1.0)}, conditions, {"body": source}, element=element).steady()
    places = np.random.default_rng(1).uniform([0.55, 0.05], [1.45, 0.95], (300, 2))
    return float(np.sqrt(np.mean((field.at(places) - exact(*places.T)) ** 2)))


sizes = np.array([4, 8, 16, 32])
errors = {element: [error(n, element) for n in sizes] for element in ("P1", "P2")}

# %%
# **Result**

figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
for element, each in errors.items():
    axes.loglog(1 / sizes, each, "o-", label=element)
axes.set(xlabel="size of an element, m", ylabel="rms error, K")
axes.legend()
plt.show()

# %%

table = ReferenceTable("Order of accuracy: a manufactured solution", "closed form", "theory of finite elements")
for element, order in (("P1", 2), ("P2", 3)):
    table.add(f"order of {element}", np.log2(errors[element][-2] / errors[element][-1]), order, within=0.15)
table
