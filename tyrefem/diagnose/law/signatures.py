"""What the effects of the catalogue and simple mechanisms would do, beside the law of the missing heat."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.diagnose.data.residuals import Residuals
from tyrefem.diagnose.heat.courses import constant
from tyrefem.diagnose.heat.evidence import ProjectedData
from tyrefem.diagnose.heat.sources import Place
from tyrefem.diagnose.law.evidence import LawData, fitted_law, law_strength, plain_switch
from tyrefem.diagnose.law.places import HEAT, LOSS
from tyrefem.diagnose.law.search import HeatLaw
from tyrefem.diagnose.law.terms import DEFLECTION, LOAD, PRESSURE, SPEED, LawTerms
from tyrefem.diagnose.unknowns.candidates import Candidate

Array = NDArray[np.float64]
#: Mechanisms of heat inside and in surfaces: words -> exponents. Terms that hardly vary over the runs do not count.
MECHANISMS: Mapping[str, Mapping[str, float]] = {
    "a heat that does not depend on the drive (lamp, brake, reaction)": {},
    "hysteresis at a strain in proportion to the deflection": {SPEED: 1.0, DEFLECTION: 2.0},
    "hysteresis whose loss falls with strain (Payne)": {SPEED: 1.0, DEFLECTION: 1.0},
    "viscous loss, in proportion to the strain rate": {SPEED: 2.0, DEFLECTION: 2.0},
    "friction of a sliding contact": {SPEED: 1.0, LOAD: 1.0},
    "air friction": {SPEED: 3.0},
}
#: The same for a share of the model's own heat, which has speed and strain energy in it.
SHARES: Mapping[str, Mapping[str, float]] = {
    "the same share in all runs (loss tangent, strain energy)": {},
    "a share that falls with the deflection": {DEFLECTION: -1.0},
    "a share in proportion to the deflection (negative: a loss that falls with strain, Payne)": {DEFLECTION: 1.0},
    "a loss in proportion to the frequency (viscous)": {SPEED: 1.0},
}
#: Effects whose responses are this small beside noise are left out of the table (nats at one prior sd).
LEAST = 0.5


@dataclass(frozen=True)
class LawSignature(Brief):
    """What an effect or a mechanism would do.

    Parameters
    ----------
    name : of the effect, or the mechanism in words. effect : whether it is of the catalogue.
    likeness : share of the law's response that it can make up, 0 to 1, base numbers and sensors being free; of a
        mechanism exp(-``below``).
    below : of a mechanism, ln evidence of its exponents below the best law; NaN for an effect.
    station, where : place at which heat of unknown origin resembles it best; NaN and "" for a mechanism.
    exponents : variable -> exponent of that heat over the runs.
    """

    name: str
    effect: bool
    likeness: float
    below: float
    station: float
    where: str
    exponents: Mapping[str, float]

    def _title(self) -> str:
        return f"{self.name}: {self.likeness:.2f}"


def law_signatures(residuals: Residuals, heat: HeatLaw, candidates: Sequence[Candidate]) -> tuple[LawSignature, ...]:
    """Effects and mechanisms, most alike first.

    An effect's response to one prior sd (a sensitivity about x = 0) takes the place of the data: its place, and its
    exponents of speed, load and pressure there, are those of the heat that resembles it. The likeness is the squared
    cosine of the two responses in the metric P of `ProjectedData`.
    """
    law, best = heat.law, heat.ranking[0]
    columns, data = best.columns @ (heat.variables.hats @ law.strength()), heat.data
    origin = residuals.linear(residuals.fitted)
    rows = []
    seen = [candidate for candidate in candidates if not candidate.runs]
    for candidate in seen:
        unknowns = (*candidate.amplitudes, *candidate.presence)
        J = origin.jacobian[:, origin.design.columns(unknowns)] * np.array([each.sd for each in unknowns])
        if float(np.trace(J.T @ data.times(J))) / 2 > LEAST:
            station, where, exponents = _of_response(J[:, 0], heat)
            rows.append(
                LawSignature(candidate.key, True, _likeness(columns, J, data), math.nan, station, where, exponents)
            )
    return tuple(sorted((*rows, *_mechanisms(heat)), key=lambda row: -row.likeness))


def _likeness(response: Array, J: Array, data: ProjectedData) -> float:
    """Share of a response (n,) that columns J (n, k) can make up, in the metric P."""
    turned = data.times(J)
    overlap = turned.T @ response
    made_up = float(overlap @ np.linalg.lstsq(J.T @ turned, overlap, rcond=1e-10)[0])
    return min(max(made_up / float(response @ data.times(response)), 0.0), 1.0)


def _of_response(response: Array, heat: HeatLaw) -> tuple[float, str, dict[str, float]]:
    """Place and exponents of the constant heat that resembles a response (n,) best."""
    basis = heat.basis
    noiseless = replace(basis.data, data=response)
    always = constant(basis.coarse).strength

    def explained(place: Place) -> float:
        column = place.columns @ always
        turned = noiseless.times(column)
        return float(turned @ response) ** 2 / max(float(turned @ column), 1e-30)

    place = max((place for place, _ in basis.tried), key=explained)
    coarse = replace(heat.variables, grid=basis.coarse)
    statistics = noiseless.with_sources(place.columns)
    # A response as clear as the law's tells its exponents; a faint one would leave them at the prior.
    scale = math.sqrt(
        max(abs(float(basis.data.data @ basis.data.times(basis.data.data))), 1.0)
        / max(float(response @ noiseless.times(response)), 1e-30)
    )
    of_place = LawData(statistics.gram, statistics.overlap * scale, place.sd, coarse.hats)
    terms: LawTerms = heat.law.terms
    names = [name for name in (SPEED, LOAD, PRESSURE) if name in terms.features]
    names = [name for name in names if (LOAD, name) not in terms.together and (SPEED, name) not in terms.together]
    fit = fitted_law(of_place, terms, names, plain_switch(len(coarse.times)))
    return place.station, place.where, dict(zip(names, map(float, fit.mean), strict=True))


def _mechanisms(heat: HeatLaw) -> list[LawSignature]:
    """Mechanisms with given exponents at the law's place and with its switch, by evidence beside the best law."""
    table = MECHANISMS if heat.place.kind == HEAT else SHARES if heat.place.kind == LOSS else {}
    law, best = heat.law, heat.ranking[0]
    statistics = heat.data.with_sources(best.columns)
    data = LawData(statistics.gram, statistics.overlap, best.place.sd, heat.variables.hats)
    rows = []
    for words, exponents in table.items():
        known = {name: value for name, value in exponents.items() if name in law.terms.features}
        features = [law.terms.features[name] for name in known]
        gain = data.gain(law_strength(features, np.array(list(known.values())), law.fit.switch))
        below = max(law.fit.log_evidence - gain, 0.0)
        rows.append(LawSignature(words, False, math.exp(-below), below, math.nan, "", dict(exponents)))
    return rows
