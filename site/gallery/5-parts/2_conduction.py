"""
Heat conduction on any mesh
===========================

The conduction solver knows nothing of tyres: any mesh of scikit-fem with named regions and edges. A bar that conducts
ten times better along than across, hot on the left, cooled by air on top.
"""

import matplotlib.pyplot as plt
import numpy as np
import skfem

from tyrefem.conduction import Conduction, Film, Fixed, Material

L, H, k, h, air = 0.1, 0.004, 20.0, 30.0, 20.0
mesh = (
    skfem.MeshQuad.init_tensor(np.linspace(0, L, 41), np.linspace(0, H, 5))
    .with_subdomains({"bar": lambda x: x[0] > 0})
    .with_boundaries({"hot": lambda x: x[0] < 1e-9, "top": lambda x: x[1] > H - 1e-9})
)
bar = Conduction(
    mesh,
    {"bar": Material(conductivity=(k, k / 10), heat_capacity=2e6)},
    {"hot": Fixed(100.0), "top": Film(h, sink=air)},
    axisymmetric=False,
    element="P2",
)
steady = bar.steady()
history = bar.transient([0, 60, 300, 900], initial=20.0, tolerance=0.01)

x = np.linspace(0, L, 60)
figure, axes = plt.subplots(figsize=(7, 3.5), layout="constrained")
for i, t in enumerate(history.times[1:], 1):
    axes.plot(x * 1e3, history.at([(place, H / 2) for place in x])[i], label=f"{t:.0f} s")
axes.plot(x * 1e3, steady.at([(place, H / 2) for place in x]), "k", label="steady")
axes.set(xlabel="place, mm", ylabel="temperature, degC")
axes.legend()
plt.show()

# %%
# A thin bar is the fin of every textbook: cosh(m (L - x)) / cosh(m L), m = sqrt(h / (k H)). What leaves at the top came
# in on the left.

m = np.sqrt(h / (k * H))
fin = air + (100 - air) * np.cosh(m * (L - x)) / np.cosh(m * L)
assert np.abs(steady.at([(place, H / 2) for place in x]) - fin).max() < 1.0
assert np.isclose(steady.flux_through("top"), -steady.flux_through("hot"), rtol=1e-9)
