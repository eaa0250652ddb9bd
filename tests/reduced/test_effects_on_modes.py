"""Reduced models of studies with effects, and of tan delta that depends on frequency."""

from __future__ import annotations

import numpy as np
import pytest

from tyrefem import study
from tyrefem.api import Study
from tyrefem.reduced.answers import reduced_answers
from tyrefem.reduced.balance import reduced_balance
from tyrefem.reduced.batch import Batch, steady
from tyrefem.reduced.integration import integrate
from tyrefem.reduced.sampled_source import SampledHeat
from tyrefem.reduced.surrogate import surrogate, temperature_error
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.simulation.run import run
from tyrefem.variants.answers import answers
from tyrefem.variants.plan import plan_of

SHORT = {"mesh.size": "12 mm", "drive.duration": "200 s", "output.every": "20 s"}
SPEEDS = {"drive.speed": ("12 mph", "25 mph")}


@pytest.mark.parametrize(
    "effects",
    [
        # On the heat, and on what surrounds the tyre by its drive alone.
        [{"name": "pressure-rise", "rise": 0.15}, {"name": "gas-mixing", "gain": 2.0}],
        # On a surrounding temperature by time itself, and on the heat with temperature; along the plies.
        [
            {"name": "ambient-drift", "rate": "40 delta_degC/hour"},
            {"name": "loss-temperature-law", "rate": "0.005 1/delta_degC"},
            {"name": "cord-conduction", "gain": 3.0},
        ],
    ],
)
def test_studies_with_effects_are_met(effects: list[dict[str, object]]) -> None:
    tyre = study("nasa-22x5.5-8pr", {**SHORT, "effects": effects})
    trained = surrogate(plan_of(tyre, SPEEDS, sample="sobol", count=12), tolerance=0.02)
    fresh = tyre.replace({"drive.speed": "21.3 mph"})
    reduced, full = trained.answers([fresh])[0].answers, answers(run(fresh))
    plain = answers(run(fresh.replace({"effects": []})))
    assert temperature_error(plain, full) > 0.5
    assert temperature_error(reduced, full) < 0.02
    assert reduced["rolling_resistance_N"] == pytest.approx(full["rolling_resistance_N"], rel=1e-3)


@pytest.fixture(scope="module")
def plain() -> Study:
    return study("nasa-22x5.5-8pr", SHORT)


def test_an_effect_changes_nothing_for_those_beside_it(plain: Study) -> None:
    trained = surrogate(plan_of(plain, SPEEDS, sample="sobol", count=12), tolerance=0.02)
    acted = plain.replace({"effects": [{"name": "loss-speed-exponent", "exponent": 0.3}]})
    # Marched side by side, each has its own windows' sources: tables where the cycle alone heats, calls where not.
    together = reduced_answers(trained.model, [plain, acted, plain], None)
    alone = [reduced_answers(trained.model, [outcome], None)[0] for outcome in (plain, acted)]
    first, second, third = (outcome.answers for outcome in together)
    assert temperature_error(first, third) < 1e-9
    for outcome, other in ((first, alone[0].answers), (second, alone[1].answers)):
        assert temperature_error(outcome, other) < 5e-3
    assert temperature_error(first, second) > 0.5


def test_films_that_follow_a_constant_drive_are_asked_for_once(plain: Study) -> None:
    trained = surrogate(plan_of(plain, SPEEDS, sample="sobol", count=12), tolerance=0.02)
    base = trained.model.base
    for effect, constant in (
        ({"name": "gas-mixing", "gain": 2.0}, True),
        ({"name": "ambient-drift", "rate": "40 delta_degC/hour"}, False),
    ):
        balance = reduced_balance(trained.model, RollingTyre(plain.replace({"effects": [effect]}), base))
        assert steady(balance, 0) is constant
        solution = integrate(Batch(trained.model, [balance]))
        assert solution.windows
        assert all(window.steady is constant for window in solution.windows)
        moments = [Batch(trained.model, [balance]).boundary_data(t) for t in (1.0, 77.0, 150.0)]
        assert all(np.array_equal(outcome.sinks, moments[0].sinks) for outcome in moments) is constant


def test_tan_delta_over_frequency_is_met() -> None:
    passenger = study(
        "passenger-205-55r16",
        {
            "materials.tread": "rubber-tread-passenger-frequency", "mechanics.strain": "given",
            "mesh.size": "8 mm", "mesh.element": "P1", "drive.duration": "200 s", "output.every": "20 s",
        },
    )  # fmt: skip
    trained = surrogate(
        plan_of(passenger, {"drive.speed": ("60 km/h", "110 km/h")}, sample="sobol", count=12), tolerance=0.02
    )
    fresh = passenger.replace({"drive.speed": "93 km/h"})
    reduced, full = trained.answers([fresh])[0].answers, answers(run(fresh))
    assert temperature_error(reduced, full) < 0.02


def test_heat_from_tables_changed_by_effects_is_that_of_each_variant(plain: Study) -> None:
    entries = [
        [],
        [{"name": "heat-shape", "half_waves": 2, "log_factor": 0.3}, {"name": "loss-speed-exponent", "exponent": 0.4}],
        [
            {"name": "missing-heat", "station": "20 mm", "width": "9 mm", "heat": "50 kW/m**3"},
            {"name": "loss-temperature-law", "rate": "0.005 1/delta_degC"},
            {"name": "pressure-rise", "rise": 0.15},
        ],
    ]
    base = RollingTyre(plain)
    tyres = [base, *(RollingTyre(plain.replace({"effects": effects}), base) for effects in entries[1:])]
    trained = surrogate(plan_of(plain, SPEEDS, sample="sobol", count=12), tolerance=0.02)
    balances = [reduced_balance(trained.model, RollingTyre(tyre.study, trained.model.base)) for tyre in tyres]
    a = np.stack([np.stack([balance.start[: trained.model.size]] * 2, axis=1) for balance in balances])
    a[:, 0, 1] *= 1.7
    times = (30.0, 150.0)
    for heat in (SampledHeat(balances)(times, a), SampledHeat(balances)(times, a)):
        for row, balance in enumerate(balances):
            alone = np.column_stack([balance.source(t, a[row, :, column]) for column, t in enumerate(times)])
            np.testing.assert_allclose(heat[row], alone, rtol=1e-5, atol=1e-6 * np.abs(alone).max())
    assert np.abs(heat[1] / heat[0] - 1).max() > 0.1
