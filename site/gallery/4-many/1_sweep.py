"""
A design study with its Pareto front
====================================

Cord angle and pressure of an aircraft tyre: which designs are both cool and easy to roll?
"""

import matplotlib.pyplot as plt

import tyrefem as tf

study = tf.study("nasa-22x5.5-8pr").replace({"mesh.size": "12 mm", "drive.duration": "300 s"})
design = study.sweep(
    {"section.cord_angle": ("31 deg", "39 deg"), "drive.pressure": ("70 psi", "110 psi")},
    sample="sobol", count=16, pareto={"rolling_resistance_coefficient": "min", "hottest_degC": "min"}, reduced="never",
)  # fmt: skip
for sentence in design.words[-3:]:
    print(sentence)

# %%

table, front = design.table, design.pareto.sort_values("hottest_degC")
figure, axes = plt.subplots(figsize=(7, 3.5), layout="constrained")
shown = axes.scatter(table.hottest_degC, table.rolling_resistance_coefficient, c=table["drive.pressure [psi]"])
axes.plot(front.hottest_degC, front.rolling_resistance_coefficient, "k--", linewidth=0.8)
axes.set(xlabel="hottest, degC", ylabel="rolling resistance coefficient")
figure.colorbar(shown, label="pressure, psi")
plt.show()

# %%
# No variant is better than one of the front in both. Lower pressure means more deflection and more heat, as the NASA
# report says.

for _, design_on_front in front.iterrows():
    cooler = table.hottest_degC < design_on_front.hottest_degC
    easier = table.rolling_resistance_coefficient < design_on_front.rolling_resistance_coefficient
    assert not (cooler & easier).any()
assert table["drive.pressure [psi]"].corr(table.hottest_degC) < -0.5
