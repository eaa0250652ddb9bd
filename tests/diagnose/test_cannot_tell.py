"""Effects that cannot be told from a cause outside the catalogue are confounded with it, not "unexplained"."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from formula import STATED, case, effect
from hidden import Case
from made_up import confounded

from tyrefem.diagnose.beside.discrepancy import ENERGY, NONE
from tyrefem.diagnose.beside.robustness import Robustness, UnderDiscrepancy
from tyrefem.diagnose.fitting.criterion import LogEvidence
from tyrefem.diagnose.fitting.exhaustive import Exhaustive
from tyrefem.diagnose.fitting.selection import ScoredSet, SelectionProblem
from tyrefem.diagnose.settings import DEFAULT
from tyrefem.diagnose.unknowns.candidates import SetPrior
from tyrefem.diagnose.verdicts.partly import NOT_EXCLUDED, beside_discrepancies
from tyrefem.diagnose.verdicts.verdict import CONFOUNDED, IDENTIFIED, UNEXPLAINED, Judgement, judge, ranked
from tyrefem.diagnose.words.headline import headline
from tyrefem.diagnose.words.sentences import verdict_words

STEP, LATER = effect("step"), effect("later")
T = np.linspace(0.0, 1.0, 60)


def scored_sets(further: float = 0.0) -> list[ScoredSet]:
    """Sets fitted to readings with a step of 2 K; ``further``: K of a course that neither effect has."""

    def law(values: dict[str, float]) -> np.ndarray:
        heat = 0.5 * values.get(STATED.key, 0.0) * T
        return np.asarray(heat + values.get("step", 0.0) * (T > 0.5) + values.get("later", 0.0) * (T > 0.55))

    readings = law({"step": 2.0}) + further * np.sin(12 * T) + np.random.default_rng(1).normal(size=60)
    made = case(law, readings, (STEP, LATER))
    prior = SetPrior((STEP, LATER), 0.5)
    problem = SelectionProblem(made.residuals, made.predictions, (STEP, LATER), prior, LogEvidence())
    return problem.settled(Exhaustive().search(problem))


def judged_against(lead: float, held_out: float = np.nan, further: float = 0.0) -> Judgement:
    """The verdict where heat of unknown origin is ahead by ``lead`` nats."""
    scored = scored_sets(further)
    return judge(ranked(scored, scored[0].score + lead, held_out), lambda members: None)


def test_heat_that_leads_by_little_is_confounded_with_the_effect() -> None:
    judgement = judged_against(0.5)
    assert judgement.best.outside
    assert judgement.best.probability < DEFAULT.named_probability
    assert judgement.verdict == CONFOUNDED
    assert judgement.reasons == ("these sensors and runs cannot tell step from a cause outside the catalogue",)
    assert judged_against(5.0).verdict == UNEXPLAINED
    assert judged_against(-6.0).verdict == IDENTIFIED


def test_heat_leads_alone_where_noise_does_not_explain_the_misfit_of_the_effect() -> None:
    assert judged_against(0.5, further=4.0).verdict == UNEXPLAINED


def models(right: float, best: bool, named: float = 0.6) -> Robustness:
    """Another strain energy leads; ``right``: probability of effects alone; ``best``: whether it needs an effect."""
    energy = UnderDiscrepancy(
        ENERGY, 0.0, "another strain energy along the meridian", 1 - right, {"step": named}, (STEP,) if best else (),
        {}, {},
    )  # fmt: skip
    alone = UnderDiscrepancy(NONE, 0.0, "the model as it is", right, {"step": 0.6}, (STEP,), {}, {})
    return Robustness((energy, alone))


@pytest.mark.parametrize("best", [True, False])
def test_confounded_stays_unless_effects_alone_are_excluded(best: bool) -> None:
    judgement = replace(judged_against(-6.0), verdict=CONFOUNDED, reasons=("these sensors cannot distinguish",))
    kept = beside_discrepancies(judgement, models(0.4, best), DEFAULT)
    assert kept.verdict == CONFOUNDED
    assert kept.reasons[1].startswith("the data ask for another strain energy along the meridian (60 %)")
    assert kept.doubts == ()
    excluded = beside_discrepancies(judgement, models(NOT_EXCLUDED / 2, best), DEFAULT)
    assert excluded.verdict == UNEXPLAINED
    assert "The data ask for another strain energy" in excluded.doubts[0]


def test_words_say_that_the_cause_may_be_outside_the_catalogue(case: Case) -> None:
    d = confounded(case.diagnosis)
    assert verdict_words(d)[0].startswith("An effect is missing")
    hot = d.judgement.best.members[0]
    energy = replace(models(0.4, False).models[0], best=())
    without = replace(d, robustness=Robustness((energy,)))
    words = " ".join(verdict_words(without))
    assert words.startswith("Perhaps an effect is missing, but these sensors and runs cannot show which: hot-road")
    assert "Or the cause is something outside the catalogue: another strain energy along the meridian" in words
    assert "needs no effect beside it (60 % probable)" in " ".join(headline(without))
    beside = replace(d, robustness=Robustness((replace(energy, best=(hot,)),)))
    words = " ".join(verdict_words(beside))
    assert words.startswith("An effect is missing")
    assert "beside it hot-road is the most probable set" in words
