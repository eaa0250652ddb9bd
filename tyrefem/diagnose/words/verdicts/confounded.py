"""The verdict "confounded" in words: effects of which the data cannot tell which act."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from tyrefem.diagnose.beside.discrepancy import NONE
from tyrefem.diagnose.numbers import percent
from tyrefem.diagnose.unknowns.candidates import Candidate
from tyrefem.diagnose.verdicts.verdict import RankedSet, certain_members
from tyrefem.diagnose.words.effects import effect_clause, effect_sentence, effect_words, joined
from tyrefem.diagnose.words.next_steps import next_words
from tyrefem.diagnose.words.result_tables import better_held_out, competing_sets, inclusion_probability
from tyrefem.diagnose.words.rms import closed_clause, closing_sentence
from tyrefem.diagnose.words.support import alone_words, stated_words, support_words

if TYPE_CHECKING:
    from tyrefem.diagnose.diagnosis import DiagnosisData

#: Largest number of sets of effects in a first sentence, and in the paragraph.
SETS, SETS_OF_PARAGRAPH = 3, 4
#: Companions of a certain effect are shown from this probability on, and so many of them.
LEAST_SHOWN, MOST_SHOWN = 0.05, 3


def three_sentences(d: DiagnosisData) -> tuple[str, str, str]:
    """What is wrong, how sure that is, and what to do next."""
    best, certain = d.judgement.best, certain_members(d.judgement, d.gap.settings)
    step = next_words(d) or "Measure at more places or in other runs, or state what you know of these effects."
    if not d.next_experiment or step.startswith("No tested"):
        step = f"{step} Exclude what you know to be absent (exclude in [diagnosis]), then diagnose again."
    if d.judgement.doubts and not best.members:
        better = better_held_out(d)
        wrong = "Perhaps an effect is missing" + ("." if better is None else f": {_set_words(better)}.")
        return wrong, f"{d.judgement.doubts[0].rstrip('.')} (fitted runs alone: {percent(best.probability)}).", step
    if d.judgement.doubts or d.best.at_bound:
        doubt = d.judgement.doubts[0] if d.judgement.doubts else "Its best value lies beyond a physical bound."
        clause = joined([effect_clause(d, member) for member in best.members])
        sure = f"{doubt.rstrip('.')} (fitted runs alone: {percent(inclusion_probability(d, best))})."
        return f"Something is missing, perhaps this: {clause}", sure, step
    if certain:
        least = min(d.judgement.named[member.key] for member in certain)
        stated = stated_words(d, certain, least, percent(least))
        sure = " ".join((f"{stated}; {closed_clause(d)}.{_besides(d, certain)}", *alone_words(d, further=True)))
        return joined([effect_clause(d, member) for member in certain]), f"{sure} {_or_outside(d)}".rstrip(), step
    sets = competing_sets(d)
    described = ", or ".join(_set_words(entry) for entry in sets[:SETS])
    rest = len(sets) - SETS
    more = "" if rest < 1 else ", or a less probable set" if rest == 1 else f", or one of {rest} less probable sets"
    shares = ", ".join(f"{entry.key} {percent(inclusion_probability(d, entry))}" for entry in sets[:SETS])
    wrong = f"{_missing(d)}, but these sensors and runs cannot show which: {described}{more}."
    both = sum(inclusion_probability(d, entry) for entry in sets[:SETS]) > 1.0
    together = " (several may act together)" if both else ""
    sure = f"Each acts with this probability: {shares}{together}; {closed_clause(d)}."
    return wrong, f"{sure} {_or_outside(d)}".rstrip(), step


def paragraph(d: DiagnosisData) -> tuple[str, ...]:
    """The sets of effects that remain, the doubts, what else may be wrong, and what would tell the sets apart."""
    best, certain = d.judgement.best, certain_members(d.judgement, d.gap.settings)
    clauses = " And: ".join(effect_words(d, member) for member in (certain or best.members))
    if d.judgement.doubts and best.members:
        chance = percent(inclusion_probability(d, best))
        first = f"The fitted runs alone speak for {best.key} ({chance}), but this is not certain: {clauses}."
    elif d.judgement.doubts:
        first = f"The fitted runs alone need no effect ({percent(best.probability)}), but this is not certain."
    elif certain:
        first = f"{clauses}: {percent(min(d.judgement.named[member.key] for member in certain))} probable."
        first += "" if d.best.at_bound else _besides(d, certain)
    else:
        sets = competing_sets(d)
        names = ["a cause outside the catalogue" if entry.outside else entry.key for entry in sets[:SETS_OF_PARAGRAPH]]
        shown = [
            f"{name} ({percent(inclusion_probability(d, entry))})" for name, entry in zip(names, sets, strict=False)
        ]
        more = len(sets) - len(shown)
        shown += [f"one of {more} less probable sets" if more > 1 else "a less probable set"] if more else []
        first = f"{_missing(d)}, but these sensors and runs cannot show which: {', or '.join(shown)}."
        if best.members:
            first += f" Most probable: {clauses}."
    if d.best.at_bound:
        first += " Its best value lies beyond a physical bound, so it is not certain."
    further = [sentence for sentence in (_or_outside(d), next_words(d)) if sentence]
    return (first, *d.judgement.doubts, *support_words(d), *further, closing_sentence(d))


def _missing(d: DiagnosisData) -> str:
    """Whether an effect is missing: only "perhaps" if a discrepancy that needs no effect is the most probable.

    Or if no effect at all is among the sets that are left.
    """
    none = any(not entry.members and not entry.outside for entry in competing_sets(d))
    leading = d.robustness.models[0] if d.robustness is not None else None
    perhaps = none or d.judgement.best.outside or (leading is not None and leading.name != NONE and not leading.best)
    return "Perhaps an effect is missing" if perhaps else "An effect is missing"


def _besides(d: DiagnosisData, certain: Sequence[Candidate]) -> str:
    """What may act besides the certain effects, each with its probability."""
    keys = [member.key for member in certain]
    alone = sum(
        entry.probability for entry in d.judgement.ranking if {member.key for member in entry.members} == set(keys)
    )
    others = [
        f"{key} ({percent(chance)})"
        for key, chance in d.judgement.named.items()
        if key not in keys and chance > LEAST_SHOWN
    ]
    it = "it acts" if len(keys) == 1 else "they act"
    first = f" These sensors and runs cannot show whether {it} alone (probability {percent(alone)})"
    return f"{first} or with {', or '.join(others[:MOST_SHOWN])}." if others else f"{first}."


def _or_outside(d: DiagnosisData) -> str:
    """What may be wrong in place of confounded effects, or besides them, as a sentence; empty if nothing leads."""
    leading = d.robustness.models[0] if d.robustness is not None else None
    if leading is None or leading.name == NONE:
        return ""
    chance = percent(leading.probability)
    if not leading.best:
        return (
            f"Or the cause is something outside the catalogue: {leading.words}, which needs no effect beside it "
            f"({chance} probable)."
        )
    keys = " + ".join(member.key for member in leading.best)
    return f"The data also speak for {leading.words} ({chance} probable); beside it {keys} is the most probable set."


def _set_words(entry: RankedSet) -> str:
    """A set of effects in words, with the signs of its fit: "the road is colder than stated (hot-road)"."""
    if entry.outside or not entry.members:
        return "a cause outside the catalogue" if entry.outside else "no effect at all"
    sentences = []
    for member in entry.members:
        sentence = member.effect.sentence if entry.fit is None else effect_sentence(member, entry.fit)
        sentence = sentence.rstrip(".")
        sentences.append(f"{sentence[0].lower()}{sentence[1:]} ({member.key})")
    return " and ".join(sentences)
