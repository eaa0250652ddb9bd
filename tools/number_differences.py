"""How far two records of `record_numbers.py` are apart."""

from __future__ import annotations

import math
from collections.abc import Mapping

from number_files import Entry, Leaf

#: Keys that measure round-off: they may grow tenfold, no more.
ROUND_OFF = {"imbalance", "residual_J"}
#: Two numbers that differ by less than this, in SI units, are the same: round-off about zero.
ZERO = 1e-15


def difference(key: str, before: Leaf, after: Leaf) -> float:
    """Relative difference of two leaves; infinite where they are of different kinds or names."""
    if isinstance(before, dict) and isinstance(after, dict):
        return _array_difference(before, after)
    if isinstance(before, str | dict) or isinstance(after, str | dict):
        return 0.0 if before == after else math.inf
    if key.rsplit(".", 1)[-1] in ROUND_OFF:
        return 0.0 if abs(after) <= 10 * abs(before) + ZERO else math.inf
    return _relative(before, after, max(abs(before), abs(after)))


def _relative(before: float, after: float, scale: float, allowed: float = ZERO) -> float:
    if before == after or (math.isnan(before) and math.isnan(after)):
        return 0.0
    apart = abs(before - after)
    return 0.0 if apart <= allowed else apart / scale if math.isfinite(apart) else math.inf


def _array_difference(before: dict[str, float], after: dict[str, float]) -> float:
    """Against the array's largest value; where it is of printed digits, one unit of the last of them is none."""
    if before["count"] != after["count"] or before["missing"] != after["missing"] or before.keys() != after.keys():
        return math.inf
    if "sum" not in before:
        return 0.0
    count = before["count"] - before["missing"]
    scale = max(abs(side[end]) for side in (before, after) for end in ("min", "max"))
    unit = max(before.get("unit", 0.0), after.get("unit", 0.0)) * 1.001
    sizes = {"sum": count, "moment": count, "norm": math.sqrt(count), "min": 1.0, "max": 1.0}
    return max(_relative(before[key], after[key], scale * size, max(ZERO, unit) * size) for key, size in sizes.items())


def compare(before: Mapping[str, Entry], after: Mapping[str, Entry], tolerance: float) -> int:
    """Print what differs by entry; 1 where anything is missing or beyond the tolerance, else 0."""
    failed = 0
    for name, entry in before.items():
        if name not in after:
            failed += 1
            print(f"MISSING                {name}")
            continue
        missing = [key for key in entry if key not in after[name]]
        differences = {
            key: difference(key, leaf, after[name][key]) for key, leaf in entry.items() if key in after[name]
        }
        worst = max(differences, key=lambda key: differences[key], default="")
        beyond = [key for key, value in differences.items() if value > tolerance]
        failed += bool(beyond or missing)
        print(f"{'DIFFERS' if beyond or missing else 'same   '}  {differences.get(worst, 0.0):12.3g}  {name}")
        for key in missing[:10]:
            print(f"    missing: {key}")
        for key in sorted(beyond, key=lambda key: -differences[key])[:10]:
            print(f"    {differences[key]:.3g}: {key}: {entry[key]} -> {after[name][key]}")
        if len(beyond) > 10 or len(missing) > 10:
            print(f"    in all {len(beyond)} of {len(entry)} differ, {len(missing)} are missing")
    added = [name for name in after if name not in before]
    print(f"{len(before)} entries, {failed} differ or are missing, {len(added)} new")
    return int(failed > 0)
