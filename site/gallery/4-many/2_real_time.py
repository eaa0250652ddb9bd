"""
A tyre in real time
===================

One file with a reduced model, numpy alone: temperatures of a tyre in a driving simulator, below a millisecond per
second of tyre time.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import tyrefem as tf
from tyrefem.realtime.certificate import export
from tyrefem.realtime.tyre import Inputs, RealTimeTyre

study = tf.study("nasa-22x5.5-8pr").replace({"mesh.size": "12 mm", "drive.duration": "300 s"})
file = Path(tempfile.mkdtemp(), "tyre.npz")
fixed = {"load": "2700 lbf", "pressure": "83 psi", "ambient": "25 degC", "road_temperature": "25 degC"}
ranges = {"speed": ("5 mph", "30 mph"), **{name: (value, value) for name, value in fixed.items()}}
certificate = export(study, file, ranges=ranges)

# %%
# A drive that the study does not have: slow, fast, slow.

tyre = RealTimeTyre(str(file), clamp=True)  # clamp: an input outside its range moves to the edge
tyre.reset(25.0)
times, outputs = np.arange(0, 300, 2.0), []
for t in times:
    speed = 12.0 if 100 <= t < 200 else 4.0
    tyre.step(2.0, Inputs(speed=speed, load=12010.0, pressure=572265.0, ambient=25.0, road_temperature=25.0))
    outputs.append(dict(zip(tyre.names, tyre.outputs, strict=True)))

figure, axes = plt.subplots(figsize=(7, 3.3), layout="constrained")
for name in ("crown-inner", "crown-outer", "contained-air"):
    axes.plot(times, [each[name] for each in outputs], label=name)
axes.set(xlabel="time, s", ylabel="temperature, degC")
axes.legend()
plt.show()

# %%
# The certificate: largest errors on fresh full simulations, K. Here a check of our own, the study's drive.

tyre.reset(25.0)
tyre.step(300.0, Inputs(speed=20 * 0.44704, load=12010.2, pressure=572265.0, ambient=25.0, road_temperature=25.0))
full = study.run().readings.iloc[-1]
error = max(abs(value - full[name]) for name, value in zip(tyre.names, tyre.outputs, strict=True) if name in full)
print(f"certificate {certificate.worst:.4f} K, this drive {error:.4f} K")
assert error < 0.2
