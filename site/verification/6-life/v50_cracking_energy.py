r"""
Cracking energy on its critical plane
=====================================

**Problem.** A small crack can release only part of the strain energy :math:`W`: the cracking energy :math:`W_c` of its plane. tyrefem searches the plane
on which it is largest, over a half sphere. Simple states have answers in closed form.

**Source.** Mars (2002), cracking energy density: a uniaxial pull has all of :math:`W`, across the pull; an equibiaxial stretch half of it; a uniaxial
compression 3/8, on planes of 45°.
"""

import matplotlib.pyplot as plt
import numpy as np
from reference_table import ReferenceTable

from tyrefem.fatigue.cracking_energy import CrackingEnergy, products, six
from tyrefem.fatigue.planes import critical_planes

G, steps = 1.5e6, 400


def cycle(stretches, pressure):
    """Cracking energy of a cycle from rest through principal stretches (steps, 3) and back, neo-Hookean."""
    strain = np.log(stretches)[:, :, None] * np.eye(3)
    stress = G * ((stretches**2)[:, :, None] - pressure[:, None, None]) * np.eye(3)
    return CrackingEnergy(*(six(np.concatenate([part, part[-2::-1]]))[None] for part in (stress, strain)))


def share(end, powers, pressure):
    """Stretches, and the largest cracking energy over W on the way, with the last normal."""
    s = np.linspace(1, end, steps)
    energies = cycle(np.stack([s**p for p in powers], axis=1), pressure(s))
    normal = critical_planes(lambda n: energies.extremes(products(n))[0], 1)[0]
    peak = float(energies.on(products(normal)[:, None]).peak[0, 0])
    W = G / 2 * (sum(end ** (2 * p) for p in powers) - 3)
    return peak / W, normal[0]


cases = {
    "pull": ((1, -0.5, -0.5), lambda s: 1 / s),
    "equibiaxial": ((1, 1, -2), lambda s: s**-4),
}
table = ReferenceTable("Cracking energy on its critical plane", "closed form", "Mars 2002")
pull, normal = share(1.3, *cases["pull"])
table.add("uniaxial pull: W_c/W", pull, 1.0, within=1e-3)
table.add(
    "uniaxial pull: angle of the normal from the axis", np.degrees(np.arccos(abs(normal[0]))), 0.0, "deg", within=0.5
)
compression, normal = share(0.8, *cases["pull"])
table.add("uniaxial compression: W_c/W", compression, 0.375, within=1e-3)
table.add("uniaxial compression: angle", np.degrees(np.arccos(abs(normal[0]))), 45.0, "deg", within=0.5)
biaxial, _ = share(1.4, *cases["equibiaxial"])
table.add("equibiaxial: W_c/W", biaxial, 0.5, within=1e-3)

# %%
# **Result**

ends = np.linspace(1.05, 1.6, 6)
figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
for name, case in cases.items():
    axes.plot(ends, [share(end, *case)[0] for end in ends], "o-", label=name)
axes.set(xlabel="stretch", ylabel="cracking energy over strain energy", ylim=(0, 1.1))
axes.legend()
plt.show()

# %%

table
