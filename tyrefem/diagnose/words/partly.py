"""Partly identified effects in words: their amounts whatever else is wrong, and what else is."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tyrefem.diagnose.beside.discrepancy import ENERGY, HEAT, NONE, READINGS
from tyrefem.diagnose.beside.robustness import LEAST_P
from tyrefem.diagnose.data.residual_tables import rms
from tyrefem.diagnose.numbers import amount, at_least, extent, parameter_name, percent
from tyrefem.diagnose.unknowns.energy_shapes import SHAPE, courses
from tyrefem.diagnose.verdicts.verdict import PARTLY
from tyrefem.diagnose.words.discrepancy_record import POSSIBLE, possible_effects
from tyrefem.diagnose.words.heat import NOT_CLEAR, heat_words, station_words

if TYPE_CHECKING:
    from tyrefem.diagnose.beside.robustness import UnderDiscrepancy
    from tyrefem.diagnose.diagnosis import DiagnosisData
    from tyrefem.diagnose.fitting.fits import FittedSet
    from tyrefem.diagnose.unknowns.candidates import Candidate

Array = NDArray[np.float64]
#: A share of the heat is stated if it differs from zero by more than this many standard deviations.
CLEAR = 2.0
#: From this ratio on heats are written as "2.5 times the heat".
TIMES = 2.5
#: Another strain energy is reported if it explains more than this share of the deviation.
MOST = 0.5
#: Effects that may act stand in the first sentence from this probability on.
LIKELY = 0.5


def ranges(d: DiagnosisData, member: Candidate) -> list[str]:
    """The range of each parameter of an effect over the discrepancy models."""
    robust = d.robustness
    if robust is None:
        return []
    clauses = []
    for unknown in member.unknowns:
        if not unknown.fixed and any(unknown.key in model.values for model in robust.models):
            low, high = (unknown.value(x) for x in robust.interval(unknown))
            # The sentence of an effect with an opposite tells the sign.
            if unknown in member.amplitudes[:1] and member.effect.opposite and low * high > 0:
                least, most = sorted((abs(low), abs(high)))
                clauses.append(f"by {extent(least, most, unknown.unit).replace('+', '')}")
            else:
                clauses.append(f"{parameter_name(unknown)}: {extent(low, high, unknown.unit)}")
    return clauses


def least_words(d: DiagnosisData) -> str:
    """The smallest probability of the effects over the discrepancy models: "at least 97 %"."""
    return at_least(least_probable(d))


def least_probable(d: DiagnosisData) -> float:
    """The smallest probability of the effects over the discrepancy models."""
    robust = d.robustness
    assert robust is not None
    return min(robust.least(member.key) for member in d.best.members)


def tried_words(d: DiagnosisData) -> str:
    """What else may be wrong, as it was tried."""
    robust = d.robustness
    assert robust is not None
    tried = (
        "; ".join(model.words for model in robust.counted if model.name != NONE) or "nothing else that the data allow"
    )
    left_out = [model.words for model in (*robust.models, *robust.laws) if model not in robust.counted]
    them = "them" if len(left_out) > 1 else "it"
    tried += f" (not counted, as the data exclude {them}: {'; '.join(left_out)})" if left_out else ""
    return f"{tried} (not tried: strain law {', '.join(robust.untried)})" if robust.untried else tried


def besides_words(d: DiagnosisData) -> str:
    """What else is wrong, by the most probable discrepancy model; without the last full stop."""
    robust = d.robustness
    assert robust is not None
    leading = robust.models[0]
    if leading.name == NONE:
        return "besides it nothing else is clear"
    if leading.name == ENERGY and (shares := energy_words(d, d.best)):
        return f"besides it {shares}"
    if leading.name != HEAT:
        return f"besides it the data speak for {leading.words}"
    words = heat_words(d)
    return "besides it heat is missing at no clear place" if words == NOT_CLEAR else f"besides it: {words}"


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


def heat_before_errors(d: DiagnosisData) -> bool:
    """Whether errors of the readings are the most probable model, and clear heat has a larger evidence than they."""
    robust, heat = d.robustness, d.missing.over_time
    if robust is None or heat is None or not heat.clear or robust.models[0].name != READINGS:
        return False
    return d.missing.log_evidence > robust.log_evidence + math.log(max(robust.models[0].probability, 1e-300))


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


def or_outside_words(d: DiagnosisData) -> str:
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


def effects_alone(d: DiagnosisData) -> UnderDiscrepancy | None:
    """Effects without anything else wrong, where another model leads but the data do not exclude them; else None.

    They have at least `POSSIBLE` probability among the models, and noise explains what their best set leaves.
    """
    models = d.robustness.models[1:] if d.robustness is not None else ()
    alone = next((model for model in models if model.name == NONE), None)
    if alone is None or not alone.best or alone.probability < POSSIBLE or alone.p_value < LEAST_P:
        return None
    return alone


def effects_of(model: UnderDiscrepancy) -> str:
    """The effects that act beside a model with at least even odds, else its most probable one, with probabilities."""
    likely = {key: share for key, share in model.named.items() if share >= LIKELY}
    first = dict(sorted(model.named.items(), key=lambda item: -item[1])[:1])
    return ", ".join(f"{key} ({percent(share)})" for key, share in (likely or first).items())


def beyond_noise(rms_of_all: float, noise: float) -> float:
    """sqrt(rms^2 - noise^2), K, of a deviation; 0 if it is no larger than the noise."""
    return math.sqrt(max(rms_of_all**2 - noise**2, 0.0))


def beside_it_words(d: DiagnosisData) -> str:
    """Effects that may act beside what explains the deviation, or beside named effects, as a sentence; else empty."""
    shown = ", ".join(f"{key} ({percent(share)})" for key, share in possible_effects(d).items())
    if not shown:
        return ""
    if d.verdict == PARTLY:
        return f"Perhaps these act, too: {shown}. They are not sure enough to be named."
    may = f"If that holds, these effects may act beside it: {shown}"
    if heat_before_errors(d) and d.robustness is not None:
        may = f"Beside {d.robustness.models[0].words} these effects may act: {shown}"
    return f"{may}. It is not sure, so none is named."


def energy_words(d: DiagnosisData, fit: FittedSet) -> str:
    """Where the tyre makes more and less heat than the model, as shares of the model's heat; empty if none is clear.

    ``fit``: beside another strain energy.
    """
    share, sd, s = energy_shares(d, fit)
    ratio = share / np.maximum(sd, 1e-12)
    clauses = []
    for sign, words in ((1.0, "more"), (-1.0, "less")):
        at = int(np.argmax(sign * ratio))
        if sign * ratio[at] > CLEAR:
            if share[at] > TIMES - 1:
                size = f"{amount(1 + float(share[at]), float(sd[at]), '1').lstrip('+')} times the heat"
            else:
                size = f"{amount(100 * abs(float(share[at])), 100 * float(sd[at]), '%').lstrip('+')} {words} heat"
            clauses.append((abs(float(ratio[at])), f"{size} {station_words(d, float(s[at]))}"))
    clauses.sort(key=lambda clause: -clause[0])
    if not clauses:
        return ""
    # "Times the heat" needs no "than".
    compared = "than the model" if "times the heat" not in clauses[-1][1] else "of the model"
    return f"the tyre makes {' and '.join(text for _, text in clauses)} {compared}"


def energy_shares(d: DiagnosisData, fit: FittedSet) -> tuple[Array, Array, Array]:
    """Missing share of the heat along the meridian (n,), its standard deviation, and the stations (m).

    The share is that of the model's own heat: exp(sum of the half waves) - 1.
    """
    length = d.original.section.line.length
    s = np.linspace(0.0, length, 41)
    kept = [unknown for unknown in fit.unknowns if unknown.effect == SHAPE]
    at = [fit.unknowns.index(unknown) for unknown in kept]
    waves = courses(s / length, kept)
    log_factor = waves @ fit.posterior.mean[at]
    sd = np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", waves, fit.posterior.covariance[np.ix_(at, at)], waves), 0.0))
    factor = np.exp(log_factor)
    return np.asarray(factor - 1), np.asarray(sd * factor), s
