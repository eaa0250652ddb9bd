"""
A first run
===========

The 22x5.5 aircraft tyre of a NASA report rolls for ten minutes at 20 mph. How hot does it get, and where?
"""

import matplotlib.pyplot as plt

import tyrefem as tf

study = tf.study("nasa-22x5.5-8pr").replace({"mesh.size": "6 mm"})
result = study.run()
result.extremes[["region", "temperature_degC", "time_s"]].round(1)

# %%
# Readings are a pandas table: a column per sensor, degC over seconds.

readings = result.readings.set_index("time_s")
readings[["crown-inner", "crown-outer", "contained-air"]].plot(ylabel="temperature, degC", xlabel="time, s")
plt.show()

# %%
# In free rolling the inner wall is hotter than the outer surface, as NASA TP-2195 reports. All heat is accounted for:
# generated heat is stored or lost.

last = readings.iloc[-1]
assert last["crown-inner"] > last["crown-outer"] + 20
assert result.heat_budget.imbalance < 1e-9
