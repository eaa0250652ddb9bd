"""How far carcass lines of sizes move under pressure beyond growth: docs/evidence/tables/inflated-shape.csv.

    python benchmarks/inflated_shape.py [SIZE ...]

Without sizes all of `MESHES` are computed and written (about 4 minutes of one processor); named sizes are printed only.
Largest and rms distance of the inflated carcass line, crown to flange, from the nearest line in equilibrium on the same
rim whose crown and width have grown. The measure is that of tests/sizes/test_inflated_shape.py.
"""

from __future__ import annotations

import argparse
import csv
import sys
from pathlib import Path

import numpy as np

from tyrefem.output import atomic_path
from tyrefem.sizes import draw_size

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests" / "sizes"))
from test_inflated_shape import deviations  # noqa: E402

TABLE = ROOT / "docs" / "evidence" / "tables" / "inflated-shape.csv"
#: Size -> mesh size, mm.
MESHES = {
    **dict.fromkeys(("205/60R15", "195/65R15", "255/40R17", "205/55R16", "175/70R13", "315/35R20"), 7),
    **dict.fromkeys(("LT265/70R17", "LT235/85R16", "LT245/75R16", "235/75R17.5"), 8),
    **dict.fromkeys(("295/80R22.5", "11R22.5", "315/70R22.5", "275/70R22.5", "295/60R22.5", "315/60R22.5"), 10),
    **dict.fromkeys(("385/65R22.5", "425/65R22.5", "445/65R22.5", "355/50R22.5", "445/50R22.5"), 10),
    **dict.fromkeys(("22x5.5R12 8PR", "27x7.75R15", "32x8.8R16"), 8),
    **dict.fromkeys(("46x17R20", "1400x530R23"), 10),
    **dict.fromkeys(("22x5.5 8PR", "22x5.5 12PR", "32x8.8-16"), 7),
    **dict.fromkeys(("40x14 24PR", "H44.5x16.5-21", "49x19-20 32PR", "56x16 38PR"), 10),
}
HEADER = (
    "size", "mesh [mm]", "growth of crown radius [mm]", "of half width [mm]", "largest beyond growth [mm]", "rms [mm]",
    "bead pressed by rule [mm]",
)  # fmt: skip


def row(size: str, mesh: float) -> list[str]:
    """One line of the table."""
    away, growth = deviations(size, mesh * 1e-3)
    numbers = draw_size(size).rules.numbers
    pressed = f"{1e3 * numbers['bead_pressed'].value:.2f}" if "bead_pressed" in numbers else ""
    lengths = (*growth[:2], np.abs(away).max(), np.sqrt((away**2).mean()))
    return [size, f"{mesh:g}", *(f"{1e3 * value:.2f}" for value in lengths), pressed]


def main() -> None:
    """All sizes, or those that are named."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("sizes", nargs="*", metavar="SIZE")
    sizes = parser.parse_args().sizes
    rows = []
    for size in sizes or MESHES:
        rows.append(row(size, MESHES.get(size, 10)))
        print(dict(zip(HEADER, rows[-1], strict=True)), flush=True)
    if not sizes:
        with atomic_path(TABLE) as temporary, open(temporary, "w", encoding="utf-8", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([HEADER, *rows])


if __name__ == "__main__":
    main()
