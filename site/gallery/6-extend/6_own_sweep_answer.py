"""
A sweep answer of your own
==========================

Which number moves which result, and in which direction? A file adds an answer to every sweep: rank correlations of the
varied numbers with the answers.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt

import tyrefem as tf
from tyrefem.contracts import check_file
from tyrefem.plugins import use

FILE = '''
from typing import ClassVar

from tyrefem.cards import Card
from tyrefem.sweep.sample_answer import SampleAnswer


class RanksTable(Card):
    """The table [ranks] of a sweep file."""

    answers: list[str] = ["hottest_degC", "rolling_resistance_coefficient"]


class Ranks(SampleAnswer):
    """Spearman's rank correlations of numbers and answers."""

    key: ClassVar[str] = "ranks"
    heading: ClassVar[str] = "Rank correlations"
    table: ClassVar[type[Card]] = RanksTable

    def rows(self, variants):
        numbers = [name for name in variants if name.endswith("]")]
        table = variants[[*numbers, *self.settings.answers]].corr(method="spearman")
        return table.loc[numbers, self.settings.answers].rename_axis("number").reset_index()

    def sentences(self, rows):
        first = self.settings.answers[0]
        leading = rows.loc[rows[first].abs().idxmax()]
        return [f"{first} goes most with {leading.number}: rank correlation {leading[first]:+.2f}."]
'''
file = Path(tempfile.mkdtemp()) / "ranks.py"
file.write_text(FILE, encoding="utf-8")
checked = check_file(file)
print(*checked.lines, sep="\n")
assert checked.failed == 0

# %%

use(file)
study = tf.study("nasa-22x5.5-8pr", {"mesh.size": "12 mm", "drive.duration": "300 s"})
design = study.sweep(
    {"drive.speed": ("10 mph", "30 mph"), "drive.pressure": ("70 psi", "110 psi")},
    sample="sobol", count=16, ranks={}, reduced="never",
)  # fmt: skip
ranks = design.answers["ranks"].table.set_index("number")
print(design.words[-1])

ranks.plot.barh(figsize=(7, 3), xlabel="rank correlation", ylabel="")
plt.tight_layout()
plt.show()

# %%
# More revolutions per second, more heat; more pressure, less deflection and less heat. The coefficient of rolling
# resistance falls with the pressure as well, and less with the speed: a warmer tyre loses less.

assert ranks.hottest_degC["drive.speed [mph]"] > 0.7
assert ranks.hottest_degC["drive.pressure [psi]"] < -0.2
assert ranks.rolling_resistance_coefficient["drive.pressure [psi]"] < -0.8
