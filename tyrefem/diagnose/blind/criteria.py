"""Criteria of a blind test: when a case counts as right, the rates with their goals, and the failures with causes.

A row is a case of ``blind.json``; see `tyrefem.diagnose.blind.blind_case.BlindOutcome`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from tyrefem.diagnose.verdicts.verdict import IDENTIFIED, NO_GAP, PARTLY, UNEXPLAINED

Row = dict[str, Any]
#: Verdicts that name effects.
NAMING = (IDENTIFIED, PARTLY)
#: The place of an uncatalogued cause counts as right within this share of the half meridian.
NEAR = 1.5 / 7
#: Amplitude, in prior standard deviations, from which an effect counts as strong.
STRONG = 1.0


@dataclass(frozen=True)
class Rate:
    """``right`` of ``of`` cases, with a 95 % Wilson interval.

    ``goal``: wanted share; ``at_most``: it is an upper limit. None: no goal.

    >>> rate = Rate(19, 20)
    >>> round(rate.value, 2), [round(x, 2) for x in rate.interval]
    (0.95, [0.76, 0.99])
    """

    right: int
    of: int
    goal: float | None = None
    at_most: bool = False

    @property
    def value(self) -> float:
        """Share of right cases; NaN without cases."""
        return self.right / self.of if self.of else math.nan

    @property
    def interval(self) -> tuple[float, float]:
        """95 % interval (Wilson 1927)."""
        if not self.of:
            return 0.0, 1.0
        n, p, z = self.of, self.value, 1.96
        middle = (p + z * z / (2 * n)) / (1 + z * z / n)
        half = z / (1 + z * z / n) * math.sqrt(p * (1 - p) / n + z * z / (4 * n * n))
        return max(middle - half, 0.0), min(middle + half, 1.0)

    @property
    def wanted(self) -> str:
        """The goal in words; empty without one."""
        if self.goal is None:
            return ""
        return f"{'at most' if self.at_most else 'at least'} {100 * self.goal:g} %"

    def to_dict(self) -> Row:
        """Plain data."""
        low, high = self.interval
        goal = {} if self.goal is None else {"goal": self.goal, "goal_is": "at most" if self.at_most else "at least"}
        return {"right": self.right, "of": self.of, "rate": self.value, "low": low, "high": high, **goal}


def rate(
    rows: Sequence[Row], holds: Callable[[Row], bool], goal: float | None = None, *, at_most: bool = False
) -> Rate:
    """The share of rows that fulfil a criterion."""
    return Rate(sum(1 for row in rows if holds(row)), len(rows), goal, at_most)


def of_kind(rows: Sequence[Row], *kinds: str) -> list[Row]:
    """The rows of some kinds of cases."""
    return [row for row in rows if row["kind"] in kinds]


# -- one case --------------------------------------------------------------------------------------------------------


def names(row: Row) -> set[str]:
    """The effects that a verdict names: "identified" or "partly identified"."""
    return set(row["named"]) if row["verdict"] in NAMING else set()


def acting(row: Row) -> set[str]:
    """The effects of the catalogue that act in the data: the hidden ones, and other speed laws of films."""
    hidden = set() if row["kind"] == "outside" else set(row["hidden"])
    return hidden | set(row.get("other_model", {}).get("film_speed_exponents", {}))


def right(row: Row) -> bool:
    """Whether exactly the hidden effects are named, beside speed laws of films that do differ."""
    hidden = set(row["hidden"])
    return bool(hidden) and row["verdict"] in NAMING and hidden <= names(row) <= acting(row)


def in_set(row: Row) -> bool:
    """Whether all hidden effects are in the reported sets, or named."""
    return set(row["hidden"]) <= set(row["set"]) | names(row)


def wrong(row: Row) -> bool:
    """Whether none of the named effects is hidden."""
    return bool(names(row)) and not names(row) & acting(row)


def false_names(row: Row) -> set[str]:
    """Named effects that do not act in the data."""
    return names(row) - acting(row)


def has_held_out(row: Row) -> bool:
    """Whether any run is held out; without one the root mean square is null."""
    return row["held_out_rms_K"]["before"] is not None


def shrunk(row: Row) -> bool:
    """Whether the gap beyond noise on held-out runs becomes at least three times smaller."""
    noise = row["noise_K"]
    before, after = (max(row["held_out_rms_K"][when] ** 2 - noise**2, 0.0) ** 0.5 for when in ("before", "after"))
    return bool(before >= 3 * after)


# -- rates -----------------------------------------------------------------------------------------------------------


def ordinary_rates(rows: Sequence[Row]) -> dict[str, Rate]:
    """Criterion -> rate, for data of the study's model."""
    single, two, none, outside = (of_kind(rows, kind) for kind in ("one", "two", "none", "outside"))
    able = [row for row in single if row["identifiable"]]
    able_pairs = [row for row in two if row["identifiable"]]
    named = [row for row in rows if row["verdict"] in NAMING]
    strong = [row for row in able if min(map(abs, row["amplitude"].values()), default=1.0) >= STRONG]
    named_right = [row for row in able if right(row)]
    unexplained = [row for row in outside if row["verdict"] == UNEXPLAINED]
    return {
        "one effect: identifiable": rate(single, lambda row: row["identifiable"], 0.6),
        "identifiable: named correctly": rate(able, right, 0.95),
        "identifiable: true effect in the reported set": rate(able, in_set),
        "one effect: wrong name": rate(single, wrong),
        "no effect: no gap": rate(none, lambda row: row["verdict"] == NO_GAP, 0.98),
        "outside the catalogue: confident wrong name": rate(
            outside, lambda row: row["verdict"] in NAMING, 0.05, at_most=True
        ),
        "outside the catalogue: unexplained": rate(outside, lambda row: row["verdict"] == UNEXPLAINED),
        "outside the catalogue, unexplained: place right": rate(
            unexplained, lambda row: abs(row["missing_station_m"] - row["station_m"]) <= NEAR * row["length_m"]
        ),
        "two effects: both named": rate(two, right),
        "two identifiable effects: both named": rate(able_pairs, right),
        "named rightly: held-out rms at most 1.2 times the noise": rate(
            [row for row in named_right if has_held_out(row)],
            lambda row: row["held_out_rms_K"]["after"] <= 1.2 * row["noise_K"],
        ),
        "strong and identifiable: held-out gap shrunk 3 times": rate(
            [row for row in strong if has_held_out(row) and row["held_out_rms_K"]["before"] > 3 * row["noise_K"]],
            shrunk,
        ),
        "verdicts 'identified': right": rate(named, right, 0.9),
    }


def structural_rates(rows: Sequence[Row]) -> dict[str, Rate]:
    """Criterion -> rate, for data of another model; the goals are those of the blind benchmark with other models.

    Effects are identifiable if they could be named beside the strain energy, gauges and films, which are unknown.
    """
    able = [row for row in of_kind(rows, "one", "two") if row["identifiable"]]
    alone = [row for row in of_kind(rows, "one", "two") if row.get("identifiable_alone", row["identifiable"])]
    none, outside = of_kind(rows, "none"), of_kind(rows, "outside")
    rates = {
        "identifiable: all hidden effects in the reported set": rate(able, in_set, 0.95),
        "identifiable: all hidden effects named or partly identified": rate(
            able, lambda row: set(row["hidden"]) <= names(row), 0.7
        ),
        "identifiable: some hidden effect named": rate(able, lambda row: bool(set(row["hidden"]) & names(row))),
        "identifiable alone: in the reported set": rate(alone, in_set),
        "identifiable alone: named or partly identified": rate(alone, lambda row: set(row["hidden"]) <= names(row)),
        "all cases: confident wrong name": rate(rows, lambda row: bool(false_names(row)), 0.02, at_most=True),
        "nothing hidden: no effect named": rate(none, lambda row: not false_names(row), 0.97),
        "nothing hidden: nothing named, not even a film": rate(none, lambda row: not names(row)),
        "outside the catalogue: no effect named": rate(outside, lambda row: not false_names(row)),
    }
    for kind, words in (("one", "one effect"), ("two", "two effects")):
        cases = [row for row in able if row["kind"] == kind]
        rates[f"{words}, identifiable: in the reported set"] = rate(cases, in_set)
        rates[f"{words}, identifiable: all named"] = rate(cases, lambda row: set(row["hidden"]) <= names(row))
        rates[f"{words}: confident wrong name"] = rate(of_kind(rows, kind), lambda row: bool(false_names(row)))
    for law, words in ((False, "energy by modes"), (True, "another strain law")):
        cases = [row for row in rows if bool(row["other_model"]["strain_law"]) == law]
        inside = [row for row in able if bool(row["other_model"]["strain_law"]) == law]
        rates[f"{words}, identifiable: in the reported set"] = rate(inside, in_set)
        rates[f"{words}, identifiable: all named"] = rate(inside, lambda row: set(row["hidden"]) <= names(row))
        rates[f"{words}: confident wrong name"] = rate(cases, lambda row: bool(false_names(row)))
    return rates


# -- failures --------------------------------------------------------------------------------------------------------


def failures(rows: Sequence[Row]) -> list[Row]:
    """Every case that misses a goal: what was hidden, what the diagnosis says, and why."""
    listed = []
    for row in rows:
        complaints = faults(row)
        if complaints:
            listed.append(
                {
                    "number": row["number"],
                    "kind": row["kind"],
                    "hidden": row["hidden"],
                    "amplitude": row["amplitude"],
                    "fault": "; ".join(complaints),
                    "verdict": row["verdict"],
                    "named": row["named"],
                    "leading": row.get("leading", []),
                    "why": why(row),
                    **({"other_model": row["other_model"]} if "other_model" in row else {}),
                }
            )
    return listed


def faults(row: Row) -> list[str]:
    """What is wrong with the diagnosis of a case; empty if it is right."""
    if row["verdict"] == "failed":
        return [f"the diagnosis failed: {row.get('reason', 'unknown reason')}"]
    complaints = []
    able = row["kind"] in ("one", "two") and row["identifiable"]
    if able and not in_set(row):
        complaints.append("a hidden effect is not in the reported set")
    elif able and not set(row["hidden"]) <= names(row):
        complaints.append("a hidden effect is not named")
    if false_names(row):
        complaints.append(f"named, but not hidden: {', '.join(sorted(false_names(row)))}")
    if row["kind"] == "none" and "other_model" not in row and row["verdict"] not in (NO_GAP, *NAMING):
        complaints.append("nothing is hidden, and the verdict is not 'no gap'")
    return complaints


def why(row: Row) -> str:
    """The diagnosis's own reasons, with the misfit that remains."""
    after, noise = row.get("rms_K", {}).get("after"), row.get("noise_K")
    misfit = "" if after is None or not noise else f"rms {after:.2f} K after the fit, noise {noise:.2f} K; "
    reasons = [*row.get("doubts", []), *row.get("reasons", [])]
    return misfit + " ".join(reasons) if reasons else misfit + f"best set: {row['best']}"


def by_effect(rows: Sequence[Row]) -> list[Row]:
    """One row per effect (all variants): cases, identifiable, named, and the results of the missed cases."""
    effects: dict[str, Row] = {}
    for row in of_kind(rows, "one"):
        name = row["hidden"][0].split(" (")[0]
        counts = effects.setdefault(name, {"effect": name, "cases": 0, "identifiable": 0, "named": 0, "else": []})
        counts["cases"] += 1
        counts["identifiable"] += bool(row["identifiable"])
        counts["named"] += right(row)
        if row["identifiable"] and not right(row):
            counts["else"].append(f"{row['verdict']}: {row['best']}")
    return sorted(effects.values(), key=lambda row: row["effect"])


def lines(rates: Mapping[str, Rate]) -> list[str]:
    """The rates as lines of text, with the goals beside them."""
    texts = []
    for name, each in rates.items():
        low, high = each.interval
        share = f"{100 * each.value:5.1f} % ({100 * low:.0f} to {100 * high:.0f})" if each.of else "    -"
        wanted = f"  wanted: {each.wanted}" if each.wanted else ""
        texts.append(f"{name:60s} {each.right:4d} of {each.of:4d}  {share}{wanted}")
    return texts
