"""The verdict "unexplained" in words: what explains the deviation in place of effects, and where to look first."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tyrefem.compare.sensors import OUTSIDE_THE_RUBBER
from tyrefem.diagnose.beside.discrepancy import ENERGY, HEAT, NONE
from tyrefem.diagnose.beside.robustness import LEAST_P
from tyrefem.diagnose.data.residual_tables import rms
from tyrefem.diagnose.numbers import percent, run_words
from tyrefem.diagnose.words.corrections import corrected_words
from tyrefem.diagnose.words.discrepancy_record import POSSIBLE
from tyrefem.diagnose.words.effects import LIKELY, possible_words
from tyrefem.diagnose.words.law import one_law_words
from tyrefem.diagnose.words.missing_heat import heat_before_errors, heat_clause, missing_heat_words
from tyrefem.diagnose.words.next_steps import draft_words, rest_clause
from tyrefem.diagnose.words.result_tables import clearest
from tyrefem.diagnose.words.rms import closing_sentence, gap_clause
from tyrefem.diagnose.words.strain_energy import beyond_noise, energy_words

if TYPE_CHECKING:
    from tyrefem.diagnose.beside.robustness import UnderDiscrepancy
    from tyrefem.diagnose.diagnosis import DiagnosisData

#: Another strain energy is reported if it explains more than this share of the deviation.
MOST = 0.5


def three_sentences(d: DiagnosisData) -> tuple[str, str, str]:
    """What is wrong, how sure that is, and what to do next.

    Behind another strain law, which is told first, effects do not explain "the rest".
    """
    other = explaining_words(d)
    cause = f"{other[0].lower()}{other[1:].rstrip('.')}" if other else heat_clause(d, d.missing.clear)
    alone = _effects_alone(d)
    what = "the deviation" if d.better_law is None else "the rest"
    explains = f"explains {what}" if alone is None else "is sure to explain the deviation"
    wrong = f"No effect in the catalogue {explains}; {cause}."
    wrong += "" if other or not (law := one_law_words(d)) else f" {law}"
    likely = possible_words(d, LIKELY)
    if likely and other:
        wrong += f" If that holds, beside it may act: {likely}."
    elif likely and d.robustness is not None:
        wrong += f" Beside {d.robustness.models[0].words} may act: {likely}."
    wrong += f" Or effects alone explain it: {_effects_of(alone)}." if alone is not None else ""
    return wrong, _sure(d, other, alone), _check_first(d, alone)


def _sure(d: DiagnosisData, other: str, alone: UnderDiscrepancy | None) -> str:
    """How sure the cause outside the catalogue is: a doubt, or its probability; and the rms."""
    if d.judgement.doubts:
        return f"{d.judgement.doubts[0].rstrip('.')}; {gap_clause(d)}."
    if other and alone is not None and d.robustness is not None:
        leading = d.robustness.models[0]
        chances = f"{percent(leading.probability)} probable, effects alone {percent(alone.probability)}"
        cause = f"{leading.words[0].upper()}{leading.words[1:]}"
        return f"{cause}: {chances}, of all that was tried beside effects; {gap_clause(d)}."
    chance = percent(d.judgement.best.probability)
    return f"A cause outside the catalogue is {chance} probable against every set of effects tried; {gap_clause(d)}."


def _check_first(d: DiagnosisData, alone: UnderDiscrepancy | None) -> str:
    """Where the deviation is clearest, and how to go on if sensor and drive are right."""
    row = clearest(d)
    rest = rest_clause(d) or "write the cause as an effect (docs/effects.md) and diagnose again"
    if alone is not None:
        rest = f"find out whether {' and '.join(member.key for member in alone.best)} acted, or {rest}"
    place = f"{row['sensor']} in {run_words(str(row['run']))}"
    return (
        f"Check {place} first, where measured - computed is {row['mean_K']:+z.1f} K {phase_words(str(row['phase']))}: "
        f"{'' if row['sensor'] in OUTSIDE_THE_RUBBER else 'its place, '}its channel and the drive; if they are right, "
        f"{rest}."
    )


def paragraph(d: DiagnosisData) -> tuple[str, ...]:
    """What explains the deviation in place of effects, its places and its law, and how to go on."""
    closing = closing_sentence(d)
    if d.better_law is not None and d.better_law.alone:
        return ("With this strain law no effect is missing.", *corrected_words(d), closing)
    named = " and ".join(member.key for member in d.best.members)
    partly = (f"These effects explain part of the deviation: {named}.",) if named else ()
    entries = {change.unknown.key for change in d.changes if change.missing}
    many = f"{len(entries)} entries" if len(entries) > 1 else "an entry"
    describe = "describe" if len(entries) > 1 else "describes"
    alone = _effects_alone(d)
    explains, instead = "explains", list[str]()
    if alone is not None:
        explains = "is sure to explain"
        instead = [f"Or effects alone explain it ({percent(alone.probability)} probable): {_effects_of(alone)}."]
    described = f"The amended study has {many} of missing heat, which {describe} the deviation without a cause."
    heat, *laws = missing_heat_words(d)
    return (
        f"No effect in the catalogue {explains} the deviation.",
        *d.judgement.doubts,
        heat,
        *(sentence for sentence in (explaining_words(d), _beside_it(d)) if sentence),
        *instead,
        *laws,
        *partly,
        *([described] if entries else []),
        closing,
        *_next_steps(d),
    )


def _next_steps(d: DiagnosisData) -> tuple[str, ...]:
    """What to do if no effect explains the deviation: where it is clearest, and how to go on."""
    row = clearest(d)
    return (
        f"Next: check {row['sensor']} in {run_words(str(row['run']))}, where the deviation is clearest "
        f"({row['mean_K']:+z.1f} K on average {phase_words(str(row['phase']))}): its "
        f"{'' if row['sensor'] in OUTSIDE_THE_RUBBER else 'place and '}channel, the run's drive, and the stated "
        "uncertainties.",
        "A cause outside the catalogue can be written as an effect (docs/effects.md) and diagnosed again.",
        *draft_words(d),
    )


def phase_words(phase: str) -> str:
    """A stretch of time of a history in words.

    >>> phase_words("plateau")
    'on the plateau'
    """
    return {"heating": "while it heats", "plateau": "on the plateau", "cooling": "while it cools"}[phase]


def explaining_words(d: DiagnosisData) -> str:
    """The discrepancy that explains the deviation without a named effect, as a sentence; empty if none does.

    The effects that are likely beside it are told with it: errors of 0.5 K by themselves explain no deviation of 5 K.
    Another strain energy is also told if it explains most of the deviation, but noise does not explain the rest. Errors
    of the readings are not told where heat of unknown origin explains the data better: they fit any smooth deviation,
    and the heat has a place.
    """
    leading = d.robustness.models[0] if d.robustness else None
    if leading is None or heat_before_errors(d):
        return ""
    if leading.name == NONE or leading.p_value < LEAST_P:
        return _energy_explains(d)
    if leading.name == HEAT:
        # Place and amount of the heat stand in its own sentences.
        return ""
    fit = leading.fits.get(())
    shares = energy_words(d, fit) if leading.name == ENERGY and fit is not None else ""
    words = f"{leading.words[0].upper()}{leading.words[1:]}"
    likely = " + ".join(sorted(each.key for each in leading.best if leading.named.get(each.key, 0.0) >= LIKELY))
    together = f" together with {likely}" if likely else ""
    return f"{words} would explain it{together}{f': {shares}' if shares else ''}."


def _energy_explains(d: DiagnosisData) -> str:
    """The share of the deviation that another strain energy explains, if it is most of it; else empty."""
    assert d.robustness is not None
    fit = next((model.fits.get(()) for model in d.robustness.models if model.name == ENERGY), None)
    if fit is None:
        return ""
    before, after = d.rms(after=False, held_out=False), rms(d.gap, fit.computed, d.gap.fitted)
    share = 1 - beyond_noise(after, d.noise) / max(beyond_noise(before, d.noise), 1e-12)
    shares = energy_words(d, fit)
    if share < MOST or not shares:
        return ""
    return (
        f"Another strain energy along the meridian explains {100 * share:.0f} % of it (rms {before:.1f} to "
        f"{after:.1f} K in the fitted runs), not all: {shares}."
    )


def _beside_it(d: DiagnosisData) -> str:
    """Effects that may act beside what explains the deviation, as a sentence; else empty."""
    shown = possible_words(d)
    if not shown:
        return ""
    may = f"If that holds, these effects may act beside it: {shown}"
    if heat_before_errors(d) and d.robustness is not None:
        may = f"Beside {d.robustness.models[0].words} these effects may act: {shown}"
    return f"{may}. It is not sure, so none is named."


def _effects_alone(d: DiagnosisData) -> UnderDiscrepancy | None:
    """Effects without anything else wrong, where another model leads but the data do not exclude them; else None.

    They have at least `POSSIBLE` probability among the models, and noise explains what their best set leaves.
    """
    models = d.robustness.models[1:] if d.robustness is not None else ()
    alone = next((model for model in models if model.name == NONE), None)
    if alone is None or not alone.best or alone.probability < POSSIBLE or alone.p_value < LEAST_P:
        return None
    return alone


def _effects_of(model: UnderDiscrepancy) -> str:
    """The effects that act beside a model with at least even odds, else its most probable one, with probabilities."""
    likely = {key: share for key, share in model.named.items() if share >= LIKELY}
    first = dict(sorted(model.named.items(), key=lambda item: -item[1])[:1])
    return ", ".join(f"{key} ({percent(share)})" for key, share in (likely or first).items())
