"""What a layout can tell, before any data."""

from __future__ import annotations

import numpy as np
import pytest
from hidden import RIVALS, Case

from tyrefem.diagnose.candidates import SetPrior
from tyrefem.diagnose.evaluations import Evaluations
from tyrefem.diagnose.forward_model import ForwardModel
from tyrefem.diagnose.isolability import (
    MARGIN,
    Isolability,
    competitors_of,
    isolability,
    layout_sensitivities,
    margins,
    planned,
)
from tyrefem.diagnose.linear_model import LinearModel
from tyrefem.diagnose.sensitivities import Sensitivities


@pytest.fixture(scope="module")
def known(case: Case) -> Sensitivities:
    """The study's planned runs, with the responses that the diagnosis of the same study found."""
    study = case.study
    sensors = [one.sensor for one in case.diagnosis.gap.runs[0].sensors]
    model = ForwardModel(study, planned(study, sensors))
    return layout_sensitivities(Evaluations(model), case.diagnosis.gap.responses)


@pytest.fixture(scope="module")
def found(case: Case, known: Sensitivities) -> Isolability:
    return isolability(case.study, known=known)


def test_every_candidate_has_a_row_and_nothing_else(found: Isolability) -> None:
    assert {name.split(" (")[0] for name in found.table["effect"]} == RIVALS
    assert [run for runs in found.runs for run in runs if run == "fast"] == [], "the held-out run is not planned on"


def test_to_be_told_from_all_takes_at_least_what_being_seen_takes(found: Isolability) -> None:
    assert (found.smallest >= found.seen).all()
    assert np.isfinite(found.seen).any()


def test_the_margin_is_reached_at_the_smallest_amplitude_and_not_well_below(
    case: Case, known: Sensitivities, found: Isolability
) -> None:
    design = known.design(known.fitted)
    linear = LinearModel(design, np.zeros(len(design.jacobian)))
    prior = SetPrior(found.candidates, case.study.card.diagnosis.effects_expected)
    number = [one.name for one in found.candidates].index("hot-road")
    road = found.candidates[number]
    column = linear.jacobian[:, design.place[road.amplitudes[0]]]
    sets = competitors_of((road,), found.candidates)

    def lead(amplitude: float) -> float:
        return min(margins(linear, amplitude * column, (road,), sets, prior))

    assert lead(found.smallest[number]) >= MARGIN > lead(0.7 * found.smallest[number])


def test_twice_the_noise_needs_a_stronger_effect(case: Case, known: Sensitivities, found: Isolability) -> None:
    study = case.study
    sensors = [one.sensor for one in case.diagnosis.gap.runs[0].sensors]
    louder = study.replace({f"sensors.{name}.noise": "1.5 delta_degC" for name in study.sensors})
    model = ForwardModel(louder, planned(louder, sensors))
    again = layout_sensitivities(Evaluations(model), case.diagnosis.gap.responses)
    assert (isolability(louder, known=again).seen >= found.seen).all()
    assert (isolability(louder, known=again).seen > found.seen).any()
