"""The law of missing heat at one place: how it scales over the runs and over time, by evidence over a small grammar.

q = A exp(sum of exponent x term) x switch, the terms logarithms of speed, load, pressure, deflection and temperature
over their references.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.diagnose.heat.evidence import log_mean_exp, mean_time, shares
from tyrefem.diagnose.law.evidence import LawData, LawFit, fitted_law
from tyrefem.diagnose.law.scatter import SeriesScatter
from tyrefem.diagnose.law.terms import (
    NO_SWITCH,
    REST,
    SPEED,
    DriveVariables,
    LawTerms,
    Switch,
    structures,
    switches,
)

Array = NDArray[np.float64]
#: A switch whose response differs by less than this share from that of no switch is none.
SAME = 0.02
#: Switches of kinds that are this far below the best are not fitted with further terms, nats.
FAR = 8.0
#: Laws within this of the best are reported as alternatives, nats.
NEAR = 4.6
#: The runs tell an exponent if its posterior sd is below this share of the prior sd.
NARROWED = 0.5


@dataclass(frozen=True)
class Exponent:
    """An exponent of a law, or a rate of temperature (1/K).

    ``mean``, ``sd``: if it takes part, in the best law with it. ``probability``: that it takes part. ``narrowed``:
    whether the runs narrow its prior. ``reference``: value of the variable at which the law has its amplitude, SI.
    """

    name: str
    mean: float
    sd: float
    probability: float
    narrowed: bool
    reference: float


@dataclass(frozen=True, eq=False)
class PlaceLaw(Brief):
    """The most probable law of the heat at one place, with what the runs cannot tell.

    Parameters
    ----------
    fit : the best law. amplitude, sd : at the references, W/m3, W/m2 or 1.
    exponents : of all terms that vary, those of the best law first. hardly, together : see `LawTerms`.
    switch_probabilities : by kind. time, time_sd : of the switch, s; NaN without one.
    alternatives : other laws within `NEAR`, with ln evidence below the best. log_evidence : of the data, all laws.
    terms : see `LawTerms`. inflation : of the readings' variance for the choice, see `place_law`.
    """

    fit: LawFit
    amplitude: float
    sd: float
    exponents: tuple[Exponent, ...]
    switch_probabilities: Mapping[str, float]
    time: float
    time_sd: float
    alternatives: tuple[tuple[LawFit, float], ...]
    log_evidence: float
    terms: LawTerms
    inflation: float = 1.0

    @property
    def clear(self) -> bool:
        """Whether the amplitude differs from zero by more than two standard deviations."""
        return abs(self.amplitude) > 2 * self.sd

    @property
    def hardly(self) -> tuple[str, ...]:
        """Variables that hardly vary over the runs."""
        return self.terms.hardly

    @property
    def together(self) -> tuple[tuple[str, str], ...]:
        """Pairs of variables that vary together over the runs."""
        return self.terms.together

    @property
    def exponent(self) -> dict[str, Exponent]:
        """Term -> exponent, of the best law only."""
        return {entry.name: entry for entry in self.exponents if entry.name in self.fit.terms}

    def strength(self) -> Array:
        """(n,) at fine times, with its amplitude."""
        return self.amplitude * self.fit.strength(dict(self.terms.features))

    def as_it_acts(self, data: LawData, variables: DriveVariables, *, inside: bool) -> PlaceLaw:
        """The same law with switch, if it has one, and amplitude by other data, those about a point where it acts.

        The wider of both intervals counts: another point adds no readings. This law if its amplitude is not clear
        there.
        """
        data, features, law = data.over(self.inflation), dict(self.terms.features), self
        if not math.isnan(self.time):
            of_kind = [each for each in switches(variables, inside=inside) if each.kind == self.fit.switch.kind]
            gains = _over_times(data, features, self.fit, of_kind)
            time, time_sd = mean_time([switch.time for switch in of_kind], gains)
            fit = replace(self.fit, switch=of_kind[int(gains.argmax())])
            law = replace(self, fit=fit, time=time, time_sd=max(time_sd, self.time_sd))
        amplitude, sd = _amplitude(data, features, law.fit)
        new = replace(law, amplitude=amplitude, sd=max(sd, self.sd))
        return new if new.clear else self


def place_law(
    data: LawData, variables: DriveVariables, terms: LawTerms, *, inside: bool, scatter: SeriesScatter | None = None
) -> PlaceLaw:
    """The law of the heat at one place.

    With ``scatter``, readings that are alike in time count less: terms and switch are chosen with all evidence over the
    inflation of the exponents' variance, and the exponents' intervals are widened.
    """
    law = _chosen_law(data, variables, terms, inside=inside)
    if scatter is None:
        return law
    inflation = scatter.inflation(law.fit, law.amplitude, terms, data.hats)
    chosen = law if inflation <= 1 else _chosen_law(data.over(inflation), variables, terms, inside=inside)
    fit = fitted_law(data, terms, chosen.fit.terms, chosen.fit.switch, chosen.fit.mean)
    features = dict(terms.features)
    fit = scatter.widened(fit, data.amplitude(fit.strength(features))[0], terms, data.hats)
    amplitude, sd = _amplitude(data, features, fit)
    fitted = dict(zip(fit.terms, zip(fit.mean, fit.sd, strict=True), strict=True))
    exponents = tuple(
        entry if entry.name not in fitted else replace(
            entry, mean=float(fitted[entry.name][0]), sd=float(fitted[entry.name][1]),
            narrowed=bool(fitted[entry.name][1] < NARROWED * terms.prior(entry.name)[1]),
        )
        for entry in chosen.exponents
    )  # fmt: skip
    return replace(
        chosen, fit=fit, amplitude=amplitude, sd=sd, exponents=exponents, log_evidence=law.log_evidence, terms=terms,
        inflation=max(inflation, 1.0),
    )  # fmt: skip


def _chosen_law(data: LawData, variables: DriveVariables, terms: LawTerms, *, inside: bool) -> PlaceLaw:
    """The most probable law.

    1. Laws of all terms without a switch are fitted.
    2. Every switch is tried with the exponents of the best of them and with none; kinds far below the best are left.
    3. For the others all laws are fitted with the best time of their kind; times of a kind share its prior.
    """
    features = dict(terms.features)
    options = structures(terms)
    possible = _telling(data, switches(variables, inside=inside))
    plain = next(switch for switch in possible if switch.kind == NO_SWITCH)
    first = [fitted_law(data, terms, names, plain) for names in options]
    best = max(first, key=lambda fit: fit.log_evidence + math.log(options[fit.terms]))
    by_kind: dict[str, list[Switch]] = {}
    for switch in possible:
        by_kind.setdefault(switch.kind, []).append(switch)
    priors = _kind_priors(by_kind)
    shapes = (np.ones(len(variables.times)), best.strength(features))
    scored: list[tuple[float, LawFit]] = []
    shown = {kind: _gains(data, each, shapes) for kind, each in by_kind.items()}
    top = max(float(gains.max()) for gains in shown.values())
    for kind, each in by_kind.items():
        if kind != NO_SWITCH and shown[kind].max() < top - FAR:
            continue
        chosen = each[int(shown[kind].max(axis=0).argmax())]
        fits = first if kind == NO_SWITCH else [
            _fitted(data, terms, names, chosen, best) for names in options if _switchable(kind, names)
        ]  # fmt: skip
        for fit in fits:
            spread = _time_share(data, features, fit, each)
            prior = math.log(options[fit.terms]) + math.log(priors[kind])
            scored.append((fit.log_evidence + prior + spread, fit))
    scored.sort(key=lambda entry: -entry[0])
    top, chosen_fit = scored[0]
    of_kind = by_kind[chosen_fit.switch.kind]
    time, time_sd = mean_time([switch.time for switch in of_kind], _over_times(data, features, chosen_fit, of_kind))
    logs = {number: score for number, (score, _) in enumerate(scored)}
    chances = shares(logs)
    kinds: dict[str, float] = {}
    for number, chance in chances.items():
        kind = scored[number][1].switch.kind
        kinds[kind] = min(kinds.get(kind, 0.0) + chance, 1.0)
    amplitude, sd = _amplitude(data, features, chosen_fit)
    exponents = _exponents(terms, scored, chances, chosen_fit)
    near = tuple((fit, top - score) for score, fit in scored[1:] if top - score < NEAR)
    whole = top + math.log(sum(math.exp(score - top) for score, _ in scored))
    return PlaceLaw(
        chosen_fit, amplitude, sd, exponents, dict(sorted(kinds.items(), key=lambda item: -item[1])), time, time_sd,
        near, data.base + whole, terms,
    )  # fmt: skip


def _fitted(data: LawData, terms: LawTerms, names: Sequence[str], switch: Switch, like: LawFit) -> LawFit:
    known = dict(zip(like.terms, like.mean, strict=True))
    start = np.array([known.get(name, terms.prior(name)[0]) for name in names])
    return fitted_law(data, terms, names, switch, start)


def _switchable(kind: str, names: Sequence[str]) -> bool:
    """A power of speed acts while the tyre rolls anyway, so it needs no such switch; at rest it has no meaning."""
    return not (kind == REST and SPEED in names)


def _telling(data: LawData, tried: Sequence[Switch]) -> list[Switch]:
    """The switches that readings can tell from none, and none."""
    plain, _ = data.statistics(tried[0].on)
    kept = [tried[0]]
    for switch in tried[1:]:
        here, _ = data.statistics(switch.on)
        rest, _ = data.statistics(tried[0].on - switch.on)
        if min(here, rest) >= SAME**2 * plain:
            kept.append(switch)
    return kept


def _kind_priors(by_kind: Mapping[str, Sequence[Switch]]) -> dict[str, float]:
    """Half for no switch; the kinds share the other half."""
    others = len(by_kind) - 1
    return {kind: (0.5 if others else 1.0) if kind == NO_SWITCH else 0.5 / others for kind in by_kind}


def _gains(data: LawData, tried: Sequence[Switch], shapes: Sequence[Array]) -> Array:
    """(n_shapes, n_switches) gains of switched shapes."""
    on = np.array([switch.on for switch in tried])
    return np.array([data.gains(on * shape) for shape in shapes])


def _over_times(data: LawData, features: Mapping[str, Array], fit: LawFit, of_kind: Sequence[Switch]) -> Array:
    return data.gains(np.array([replace(fit, switch=switch).strength(dict(features)) for switch in of_kind]))


def _time_share(data: LawData, features: Mapping[str, Array], fit: LawFit, of_kind: Sequence[Switch]) -> float:
    """ln of the mean over the times of a kind, below the best time."""
    if len(of_kind) < 2:
        return 0.0
    gains = _over_times(data, features, fit, of_kind)
    return log_mean_exp(gains) - data.gain(fit.strength(dict(features)))


def _amplitude(data: LawData, features: Mapping[str, Array], fit: LawFit) -> tuple[float, float]:
    """Amplitude at the references and its standard deviation, with that of the exponents."""
    strength = fit.strength(dict(features))
    mean, sd = data.amplitude(strength)
    slopes = []
    for number, spread in enumerate(fit.sd):
        step = np.zeros(len(fit.mean))
        step[number] = 0.1 * spread
        moved = data.amplitude(fit.strength(dict(features), fit.mean + step))[0]
        slopes.append((moved - mean) / (0.1 * spread))
    slope = np.array(slopes)
    return mean, math.sqrt(sd**2 + float(slope @ fit.covariance @ slope) if len(slope) else sd**2)


def _exponents(
    terms: LawTerms, scored: Sequence[tuple[float, LawFit]], chances: Mapping[int, float], chosen: LawFit
) -> tuple[Exponent, ...]:
    """The exponents of all terms, those of the best law first."""
    result = []
    for name in terms.features:
        holding = [number for number, (_, fit) in enumerate(scored) if name in fit.terms]
        if not holding:
            continue
        number = next((n for n in holding if scored[n][1] is chosen), holding[0])
        fit = scored[number][1]
        at = fit.terms.index(name)
        sd = float(fit.sd[at])
        chance = sum(chances[n] for n in holding)
        narrowed = sd < NARROWED * terms.prior(name)[1]
        result.append(Exponent(name, float(fit.mean[at]), sd, chance, narrowed, terms.references[name]))
    return tuple(sorted(result, key=lambda entry: (entry.name not in chosen.terms, -entry.probability)))
