"""
A hidden effect found
=====================

Thermocouples read more than the study says. Which physical effect does the study lack? Here we know: the tables were
made with a road 15 K warmer, and with noise. The diagnosis does not know.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import tyrefem as tf
from tyrefem.effects import catalogue

quick = {"mesh.size": "14 mm", "output.every": "60 s", "boundaries.road.coefficient": "2500 W/m**2/K"}
study = tf.study("nasa-22x5.5-8pr").replace(quick)
truth = study.replace({"effects": [{"name": "hot-road", "warmer_by": "15 delta_degC"}]})

loads, noise, tables = {"light": "2700 lbf", "heavy": "4000 lbf"}, np.random.default_rng(1), []
for run, load in loads.items():
    readings = truth.replace({"drive.load": load}).run().readings.set_index("time_s").drop(columns="contained-air")
    readings += noise.normal(0, 0.5, readings.shape)
    tables.append(readings.add_suffix(" [degC]").rename_axis("time [s]").assign(run=run))
table = str(Path(tempfile.mkdtemp(), "measured.csv"))
pd.concat(tables).to_csv(table)

# %%
# The diagnosis fits every candidate with all uncertain numbers of the study, and weighs how well it explains the data.
# Few candidates here, so that this page takes seconds; by default the whole catalogue takes part.

candidates = {"hot-road", "radiation", "outside-film-speed", "leak"}
measured = [{"table": table, "run": run, "drive": {"load": load}} for run, load in loads.items()]
study = study.replace({"measured": measured, "diagnosis.exclude": sorted(set(catalogue()) - candidates)})
diagnosis = study.diagnose(largest=1, looks=1, verdict_only=True)
named = pd.Series(diagnosis.judgement.named)
named.clip(lower=1e-30).sort_values().plot.barh(logx=True, xlabel="probability that it is missing", figsize=(7, 2.8))
plt.tight_layout()
plt.show()

# %%
# It names the hidden road, and how much warmer it is.

best = diagnosis.best.members[0]
amplitude = diagnosis.best.posterior.mean[-1]
assert diagnosis.verdict == "identified"
assert best.name == "hot-road"
assert abs(amplitude - 15) < 3
