"""A wrong strain law in words: which law explains more, where the tyre makes more and less heat, and how sure."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from tyrefem.diagnose.numbers import percent
from tyrefem.diagnose.words.heat import station_words
from tyrefem.diagnose.words.strain_energy import beyond_noise

if TYPE_CHECKING:
    from tyrefem.diagnose.beside.law_trials import BetterLaw
    from tyrefem.diagnose.diagnosis import DiagnosisData

#: Stretches of the meridian with less than this share of the largest heat are not mentioned.
LITTLE = 0.1
#: A ratio of heats within this of one is not mentioned; above the larger one it is "2.5 times the heat".
EQUAL, TIMES = 0.15, 2.0


def law_sentences(d: DiagnosisData) -> tuple[str, ...]:
    """What another strain law explains, where it differs, and how sure; empty if the study's law stands."""
    if d.better_law is None:
        return ()
    return (f"{law_clause(d)}.", f"{law_places(d)}.", f"{law_sure(d.better_law)}.")


def law_in_short(d: DiagnosisData) -> str:
    """The better law, the share of the deviation that it takes away, and where it differs, in one sentence."""
    better = d.better_law
    assert better is not None
    held_out, trial = bool(d.gap.held_out), better.trial
    before, after = d.rms(after=False, held_out=held_out), trial.held_out_rms if held_out else trial.rms
    runs = "held-out" if held_out else "fitted"
    places = [
        f"{times_words(ratio)} {station_words(d, s).split(' (', maxsplit=1)[0]}"
        for s, ratio in largest_ratios(better, d)
    ]
    differs = f"; it makes {' and '.join(places)}" if places else ""
    return (
        f"The strain energy of the model is off: the strain law {trial.law} in place of {better.stated} takes "
        f"{100 * explained_share(d):.0f} % of the deviation away ({runs} runs: {before:.1f} to {after:.1f} K rms)"
        f"{differs}."
    )


def law_clause(d: DiagnosisData) -> str:
    """The better law, and how much of the deviation it takes away; without the last full stop."""
    better = d.better_law
    assert better is not None
    trial = better.trial
    parts = []
    for held_out, after, name in ((False, trial.rms, "fitted"), (True, trial.held_out_rms, "held-out")):
        if math.isfinite(after):
            parts.append(f"{d.rms(after=False, held_out=held_out):.1f} to {after:.1f} K in the {name} runs")
    share = explained_share(d)
    of_gap = f", {100 * share:.0f} % of the deviation" if share > 0 else ""
    return (
        f"The strain energy of the model is off: with the strain law {trial.law} in place of {better.stated}, and the "
        f"tyre's heat as it was, rms falls from {' and from '.join(parts)}{of_gap}"
    )


def law_places(d: DiagnosisData) -> str:
    """Where the tyre makes more and less heat than by the study's law; without the last full stop."""
    better = d.better_law
    assert better is not None
    clauses = [f"{times_words(ratio)} {station_words(d, s)}" for s, ratio in largest_ratios(better, d)]
    if not clauses:
        return f"The heat by {better.trial.law} has nearly the same course along the meridian"
    return f"By {better.trial.law} the tyre makes {' and '.join(clauses)}"


def largest_ratios(better: BetterLaw, d: DiagnosisData) -> list[tuple[float, float]]:
    """(station in m, ratio of the heats) where the better law has the most and the least heat beside the stated one."""
    ratio = better.trial.ratio
    length = d.original.section.line.length
    s = (np.arange(len(ratio)) + 0.5) / len(ratio) * length
    heated = np.maximum(better.trial.heat, better.trial.stated_heat)
    places = np.flatnonzero(heated >= LITTLE * heated.max())
    chosen = (places[np.argmin(ratio[places])], places[np.argmax(ratio[places])])
    return [(float(s[at]), float(ratio[at])) for at in dict.fromkeys(chosen) if abs(ratio[at] - 1) > EQUAL]


def times_words(ratio: float) -> str:
    """A ratio of heats in words.

    >>> times_words(0.4), times_words(1.3), times_words(3.2)
    ('60 % less heat', '30 % more heat', '3.2 times the heat')
    """
    if ratio > 10:
        return "more than ten times the heat"
    if ratio > TIMES:
        return f"{ratio:.1f} times the heat"
    return f"{100 * abs(ratio - 1):.0f} % {'more' if ratio > 1 else 'less'} heat"


def law_sure(better: BetterLaw) -> str:
    """How sure the better law is; without the last full stop."""
    chance = percent(1 / (1 + math.exp(-better.log_odds)))
    held_out = ""
    if better.held_out_lead >= 0:
        held_out = ", and it predicts the held-out runs better"
    elif better.held_out_lead < 0:
        held_out = (
            f"; noise explains the held-out runs by {better.trial.law}, but not the fitted runs by {better.stated}"
        )
    return f"Of the two laws the data prefer {better.trial.law} ({chance}, whatever effects act){held_out}"


def explained_share(d: DiagnosisData) -> float:
    """Share of the deviation, beyond noise, that the better law takes away before anything is fitted.

    sqrt(rms^2 - noise^2) counts, of the held-out runs if there are any.
    """
    assert d.better_law is not None
    trial, held_out = d.better_law.trial, bool(d.gap.held_out)
    by_law = trial.held_out_rms if held_out else trial.rms
    before, after = (beyond_noise(each, d.noise) for each in (d.rms(after=False, held_out=held_out), by_law))
    return 1 - after / before if before > 0 else 0.0
