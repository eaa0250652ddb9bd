"""
A section from a size
=====================

What stands on the tyre's wall gives a section: every number by a named rule, the carcass in equilibrium under pressure.
"""

import matplotlib.pyplot as plt
import numpy as np

import tyrefem as tf

sections = {size: tf.section_from_size(size) for size in ("205/60R15", "295/80R22.5", "22x5.5 8PR")}

figure, axes = plt.subplots(1, 3, figsize=(9, 3.3), sharey=True, layout="constrained")
for place, (size, section) in zip(axes, sections.items(), strict=True):
    s = np.linspace(0, 0.999 * section.line.length, 300)
    for depth in (0 * s, section.total_thickness(s)):
        r, z = section.place(s, depth).T
        place.plot(np.r_[-z[::-1], z] * 1e3, np.r_[r[::-1], r] * 1e3, "C0")
    place.set(title=size, xlabel="mm", aspect="equal")
plt.show()

# %%
# The outer diameter is the rim's plus twice the height: width times aspect ratio, as the size says.

width, aspect, rim = 0.205, 0.60, 15 * 0.0254
assert np.isclose(sections["205/60R15"].outer_diameter, rim + 2 * width * aspect, atol=1e-3)
width, aspect, rim = 0.295, 0.80, 22.5 * 0.0254
assert np.isclose(sections["295/80R22.5"].outer_diameter, rim + 2 * width * aspect, atol=1e-3)
