"""The choice of several experiments: costs, repetitions, sensors that tell the same, limits of numbers."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from tyrefem.diagnose.unknowns.unknown import Unknown
from tyrefem.diagnose.words.set_posteriors import SetPosterior
from tyrefem.inputs.plan_choice import PlanChoice
from tyrefem.inputs.study import study
from tyrefem.plan.batch import LEAST_GAIN, greedy_batch
from tyrefem.plan.beliefs import Beliefs
from tyrefem.plan.drives import CandidateDrive
from tyrefem.plan.information import information
from tyrefem.plan.places import CandidatePlace
from tyrefem.plan.readings import PlannedReadings

pytestmark = pytest.mark.fast
#: A base number that every set has.
LOAD = Unknown("drive.load", 0.1)
PLACES = (CandidatePlace("left", "thermocouple left"), CandidatePlace("right", "thermocouple right"))
DRIVES = (
    CandidateDrive({"speed": "10 mph"}, 600.0, 1.0),
    CandidateDrive({"speed": "20 mph"}, 600.0, 1.0),
    CandidateDrive({"speed": "30 mph"}, 600.0, 1.0),
)
#: Distance of the two sets at each drive by the installed sensor, and by each further sensor.
INSTALLED, FURTHER = (0.0, 1.0, 1.5), {"left": 2.0, "right": 2.0}


def readings() -> PlannedReadings:
    """Two sets; a common number moves the installed sensor by ten noises per unit."""
    sets = tuple(SetPosterior((), 0.5, (LOAD,), np.zeros(1), np.array([[0.01]])) for _ in range(2))
    grams = {}
    for number, distance in enumerate(INSTALLED):
        # Rows of [slope, change by set 1, change by set 2]; the second row does not see the load.
        A = np.array([[10.0, 0.0, 0.0], [0.0, 0.0, distance]])
        grams[number, "installed"] = A.T @ A
        for name, apart in FURTHER.items():
            A = np.array([[0.0, 0.0, apart if distance else 0.0]])
            grams[number, name] = A.T @ A
    beliefs = Beliefs(study("nasa-22x5.5-8pr"), sets, {"installed": 0.5}, verdict="confounded")
    return PlannedReadings(beliefs, ("installed",), (LOAD,), {"left": [], "right": []}, grams)


def gain(drives: tuple[int, ...], added: tuple[str, ...] = ()) -> float:
    return information(readings().expected(drives, added), 20_000).gain


def test_the_run_that_separates_most_is_first() -> None:
    search = greedy_batch(readings(), DRIVES, (), PlanChoice(runs_most=1))
    assert [entry.drive for entry in search.chosen] == [2]
    assert len(search.compared) == len(DRIVES)


def test_a_drive_that_changes_nothing_gains_nothing() -> None:
    assert gain((0,)) == pytest.approx(0.0, abs=1e-12)
    search = greedy_batch(readings(), DRIVES[:1], (), PlanChoice())
    assert search.chosen == ()


def test_the_second_of_two_equal_sensors_gains_less() -> None:
    alone, first, both = gain((2,)), gain((2,), ("left",)), gain((2,), ("left", "right"))
    assert first - alone > both - first > 0.0


def test_the_second_of_two_equal_runs_gains_less() -> None:
    assert gain((2,)) > gain((2, 2)) - gain((2,)) > 0.0


def test_cheaper_experiments_come_first() -> None:
    cheap = (DRIVES[1], replace(DRIVES[2], cost=20.0))
    # The second drive separates more, but not twenty times more.
    search = greedy_batch(_of_drives((1, 2)), cheap, (), PlanChoice(runs_most=1))
    assert [entry.drive for entry in search.chosen] == [0]
    same = (DRIVES[1], DRIVES[2])
    search = greedy_batch(_of_drives((1, 2)), same, (), PlanChoice(runs_most=1))
    assert [entry.drive for entry in search.chosen] == [1]


def _of_drives(numbers: tuple[int, ...]) -> PlannedReadings:
    every = readings()
    grams = {(place, name): every.grams[number, name] for place, number in enumerate(numbers) for name in _NAMES}
    return replace(every, grams=grams)


_NAMES = ("installed", *FURTHER)


def test_a_dear_sensor_is_left_out() -> None:
    dear = greedy_batch(readings(), DRIVES, PLACES, PlanChoice(sensor_cost=50.0, runs_most=2))
    assert dear.chosen[0].sensor is None
    cheap = greedy_batch(readings(), DRIVES, PLACES, PlanChoice(sensor_cost=0.01, runs_most=2))
    assert cheap.chosen[0].sensor in FURTHER


def test_numbers_of_runs_and_sensors_are_kept() -> None:
    choice = PlanChoice(runs_most=2, sensors_most=1, sensor_cost=0.01)
    batch = greedy_batch(readings(), DRIVES, PLACES, choice).chosen[-1].batch
    assert len(batch.drives) <= 2
    assert len(batch.sensors) <= 1
    totals = [entry.information.gain for entry in greedy_batch(readings(), DRIVES, PLACES, choice).chosen]
    assert all(later > earlier for earlier, later in pairwise(totals))


def test_every_step_gains_enough() -> None:
    search = greedy_batch(readings(), DRIVES, PLACES, PlanChoice(runs_most=20, sensors_most=2))
    assert min(entry.gain for entry in search.chosen) >= LEAST_GAIN
    assert len(search.chosen) < 20


def test_one_set_needs_no_experiment() -> None:
    every = readings()
    alone = replace(every.beliefs, sets=(replace(every.beliefs.sets[0], probability=1.0),))
    assert greedy_batch(replace(every, beliefs=alone), DRIVES, PLACES, PlanChoice()).chosen == ()


def test_a_cheap_sensor_that_tells_nearly_nothing_does_not_end_the_plan() -> None:
    """Per cost it is far ahead of a further run, which tells much."""
    every, faint = readings(), np.array([[0.0, 0.0, 0.1]])
    grams = every.grams | {(number, name): faint.T @ faint for number in range(len(DRIVES)) for name in FURTHER}
    choice = PlanChoice(sensor_cost=1e-3, runs_most=3, sensors_most=2)
    chosen = greedy_batch(replace(every, grams=grams), DRIVES, PLACES, choice).chosen
    assert [entry.drive for entry in chosen] == [2, 2, 2]
