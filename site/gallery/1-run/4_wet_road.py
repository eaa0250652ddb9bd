"""
Water on the road
=================

Rain improves the contact with the road, and evaporation cools the wet tread between two contacts. An *effect* lays this
over a study; `tyrefem list effects` names all of them.
"""

import matplotlib.pyplot as plt

import tyrefem as tf

dry = tf.study("nasa-22x5.5-8pr").replace({"mesh.size": "6 mm", "boundaries.road.coefficient": "2500 W/m**2/K"})
wet = dry.replace({"effects": [{"name": "wet-road", "film_gain": 1.0}]})  # 1: water doubles the film of the road
readings = {name: study.run().readings.set_index("time_s") for name, study in {"dry": dry, "wet": wet}.items()}

figure, axes = plt.subplots(figsize=(7, 3.5), layout="constrained")
for name, style in (("dry", "-"), ("wet", "--")):
    readings[name]["crown-outer"].plot(ax=axes, style=f"C0{style}", label=f"tread, {name}")
    readings[name]["crown-inner"].plot(ax=axes, style=f"C1{style}", label=f"inner wall, {name}")
axes.set(xlabel="time, s", ylabel="temperature, degC")
axes.legend()
plt.show()

# %%
# The surface follows the road within some kelvin, so water takes little more from it; the inner wall, behind 13 mm of
# rubber, feels less. Evaporation is 2.8 times convection by the Lewis relation, (L/c_p) dw/dT.

cooler = (readings["dry"] - readings["wet"]).iloc[-1]
assert 1 < cooler["crown-outer"] < 2
assert 0 < cooler["crown-inner"] < cooler["crown-outer"] / 2
assert abs(2.45e6 / 1005 * 1.16e-3 - 2.8) < 0.05
