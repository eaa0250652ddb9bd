"""Effects that keep a state of their own through a run."""

from __future__ import annotations

import json
import pickle
from pathlib import Path

import numpy as np
import pytest
from suitable import COARSE

import tyrefem as tf
from tyrefem.conduction.fixed_steps import fixed_step_solution
from tyrefem.conduction.sensitivity import stage_times
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.errors import InputError, PluginWarning
from tyrefem.plugins import registry
from tyrefem.reduced.balance import reduced_balance
from tyrefem.reduced.model import NotReducibleError, ReducedModel
from tyrefem.simulation.rolling_tyre import RollingTyre

POWER, MASS, TO_RIM, TO_AIR, SPECIFIC_HEAT = 800.0, 6.0, 3.0, 5.0, 460.0
ROLLING, END = 200.0, 240.0
DISC = {"name": "brake-disc", "power": f"{POWER} W", "mass": f"{MASS} kg", "to_rim": f"{TO_RIM} W/K"}
#: A rim that takes up heat and gives none to anything.
ADIABATIC = {"law": "lumped", "mass": "9 kg", "cooling": "0 W/K", "film": "0 W/m**2/K"}
RIM_HEAT = 9 * 962.32

OWN = '''
from typing import Annotated, ClassVar

import numpy as np

from tyrefem.effects import Effect, EffectState, Prior


class Soot(Effect):
    """Soot settles on the tread, faster where it is warm, and takes up sunlight."""

    name: ClassVar[str] = "soot"
    family: ClassVar[str] = "boundary"
    sentence: ClassVar[str] = "Soot settles on the tread."
    source: ClassVar[str] = "estimate: a made-up effect of a test"
    surfaces: ClassVar[tuple[str, ...]] = ("outside_air",)
    states: ClassVar = {
        "soot": EffectState("g/m**2", "soot at five places", scale=0.1),
        "clock": EffectState("s", "time that has passed"),
    }

    shine: Annotated[float, Prior("W/m**2", "flux at 1 g/m2", 50.0, 0.0, 1e4)] = 0.0

    def initial_states(self, tyre):
        return {"soot": np.zeros(5), "clock": 7.0}

    def state_rates(self, tyre, t, state, temperatures):
        settles = 1e-4 * np.arange(1, 6) * (temperatures.surface("road") - 20.0)
        return {"soot": settles - state["soot"] / 300.0, "clock": 1.0}

    def flux(self, tyre, surface, x, t):
        return self.shine * float(np.mean(tyre.state(self, "soot", t)))
'''


def braked(*effects: dict, **changes: object) -> tf.Study:
    """A coarse study on an adiabatic lumped rim: 200 s of rolling, 40 s at rest."""
    settings = {**COARSE, "boundaries.rim": ADIABATIC, "numerics.tolerance": "0.01 delta_degC", **changes}
    return tf.study("example-validation").replace({**settings, "effects": list(effects)})


def warming(t: np.ndarray) -> np.ndarray:
    """The disc's exact temperature above the rim's: rises to power / (G + UA), then decays."""
    loss = TO_RIM + TO_AIR
    tau = MASS * SPECIFIC_HEAT / loss
    rising = POWER / loss * (1 - np.exp(-np.minimum(t, ROLLING) / tau))
    return rising * np.exp(-np.maximum(t - ROLLING, 0.0) / tau)


@pytest.fixture(scope="module")
def result() -> tf.Result:
    """A braked run."""
    return braked(DISC).run()


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A user's folder with the effect above."""
    (tmp_path / "soot.py").write_text(OWN)
    monkeypatch.setenv("TYREFEM_EFFECTS", str(tmp_path))
    return tmp_path


def test_the_disc_follows_its_exact_solution_across_the_phases(result) -> None:
    state = result.states["brake-disc disc"]
    assert state.unit == "delta_degC"
    assert state.values == pytest.approx(warming(result.times), abs=0.01)
    assert state.values[-1] < state.values.max() - 1.0


def test_braking_heats_disc_rim_and_air_and_nothing_else(result) -> None:
    """power x time = heat in the disc + heat that the rim took up + heat that the air carried away."""
    t = np.linspace(0.0, END, 200001)
    theta = warming(t)
    area = float(np.sum((theta[1:] + theta[:-1]) / 2 * np.diff(t)))
    rim = RIM_HEAT * (result.readings["rim"].iloc[-1] - 25.0)
    assert rim == pytest.approx(TO_RIM * area, rel=1e-5)
    disc = MASS * SPECIFIC_HEAT * result.states["brake-disc disc"].values[-1]
    assert disc + rim + TO_AIR * area == pytest.approx(POWER * ROLLING, rel=1e-5)
    assert result.heat_budget.imbalance < 1e-9


def test_a_finer_tolerance_brings_the_state_nearer_to_the_exact_one() -> None:
    errors = []
    for tolerance in ("0.3 delta_degC", "0.003 delta_degC"):
        run = braked(DISC, **{"numerics.tolerance": tolerance}).run()
        errors.append(float(np.abs(run.states["brake-disc disc"].values - warming(run.times)).max()))
    assert errors[0] < 0.3
    assert errors[1] < 0.003
    assert errors[1] < errors[0] / 10


def test_the_result_shows_states_and_keeps_them_when_pickled(result, tmp_path: Path) -> None:
    again = pickle.loads(pickle.dumps(result))
    assert again.states["brake-disc disc"].values.tobytes() == result.states["brake-disc disc"].values.tobytes()
    (effect,) = again.study.effects
    assert again.tyre.state(effect, "disc", 200.0) == result.tyre.state(effect, "disc", 200.0)
    assert again.tyre.acting.rim_power(200.0) == pytest.approx(TO_RIM * warming(np.array(200.0)), abs=0.05)
    assert "brake-disc disc" in repr(result)
    result.save(tmp_path / "out")
    (entry,) = json.loads((tmp_path / "out" / "summary.json").read_text())["states"].values()
    assert entry["unit"] == "delta_degC"
    assert entry["max"] == pytest.approx(warming(np.array(200.0)), abs=0.01)


def test_an_interrupted_run_keeps_the_states_of_its_part() -> None:
    def stop(t: float) -> None:
        if t > 100:
            raise KeyboardInterrupt

    part = braked(DISC).run(progress=stop, partial=True)
    assert part.history.interrupted
    assert len(part.times) > 2
    assert part.states["brake-disc disc"].values == pytest.approx(warming(part.times), abs=0.01)


def test_a_run_without_states_has_none(result) -> None:
    plain = braked().run()
    assert plain.states == {}
    assert "states" not in result.__class__._facts(plain)


def test_two_effects_of_a_user_and_of_the_package_keep_their_states_at_once(folder: Path, result) -> None:
    soot = {"name": "soot", "shine": "500 W/m**2"}
    both, alone = braked(DISC, soot).run(), braked(soot).run()
    assert set(both.states) == {"brake-disc disc", "soot soot", "soot clock"}
    assert both.states["brake-disc disc"].values == pytest.approx(warming(both.times), abs=0.01)
    assert both.states["soot clock"].values == pytest.approx(7.0 + both.times, abs=0.01)
    places = both.states["soot soot"].values
    assert places.shape == (len(both.times), 5)
    # The five rates are as 1 : 2 : 3 : 4 : 5, and so are the states.
    assert places[-1] / places[-1, 0] == pytest.approx(np.arange(1, 6), rel=1e-4)
    # The rim is adiabatic: the disc does not reach the tread.
    assert places == pytest.approx(alone.states["soot soot"].values, abs=0.01 * 0.1)
    # And the flux that the soot takes up is in the heat budget: shine x mean soot x area.
    absorbed = -alone.heat_budget.powers["lost", "soot on the outside air"]
    area = absorbed[-1] / (500.0 * alone.states["soot soot"].values[-1].mean())
    assert absorbed == pytest.approx(500.0 * area * alone.states["soot soot"].values.mean(axis=1), abs=1e-3 * area)


def test_the_fixed_steps_of_a_fit_take_states_along(result) -> None:
    tyre = RollingTyre(result.study)
    times = stage_times([0.0, ROLLING, END])
    _, lumped = fixed_step_solution(tyre.problem, times, tyre.drive.initial)
    assert lumped[::2, -1] == pytest.approx(warming(times[::2]), abs=0.1)


def test_reduced_models_refuse_states() -> None:
    tyre = RollingTyre(braked(DISC))
    model = ReducedModel(tyre, np.ones((tyre.problem.operators.size, 1)), {}, np.zeros((0, 0)))
    with pytest.raises(NotReducibleError, match="a reduced model cannot follow effects with states: 'brake-disc'"):
        reduced_balance(model, tyre)


def test_a_diagnosis_names_an_effect_with_a_state(tmp_path: Path) -> None:
    """A disc that goes on warming the rim at rest is told from a brake that only heats while the wheel turns."""
    rim = {"law": "lumped", "mass": "9 kg", "cooling": "2 W/K", "air": "0.5 W/K"}
    phases = {"drive.phases.rolling.duration": "300 s", "drive.phases.cooling.duration": "400 s"}
    study = tf.study("example-validation").replace({**COARSE, **phases, "boundaries.rim": rim, "diagnosis": {}})
    readings = study.replace({"output.every": "10 s", "effects": [DISC | {"power": "1500 W"}]}).run().readings
    noise = np.random.default_rng(1).normal(0.0, 0.2, readings.shape)
    noise[:, 0] = 0.0
    table = (readings + noise).rename(columns=lambda name: "time [s]" if name == "time_s" else f"{name} [degC]")
    table.to_csv(tmp_path / "measured.csv", index=False)
    quick = DiagnosisSettings(mesh_size="12 mm", largest=1, looks=1, heat_widths=(3.0,), discrepancy_sizes=(1.0,))
    diagnosis = study.diagnose(tmp_path / "measured.csv", settings=quick, rerun=False, verdict_only=True)
    assert diagnosis.verdict == "identified"
    names = {effect.name for effect in diagnosis.study.effects}
    assert "brake-disc" in names
    assert not names & {"brake-power", "brake-heat", "gas-mixing", "bead-contact-resistance"}


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("def state_rates", "def rates", "declares states .soot, clock., but no 'state_rates'"),
        ("scale=0.1", "scale=0.0", "state 'soot' needs a positive scale"),
    ],
)
def test_a_class_that_forgot_something_is_refused(folder: Path, old: str, new: str, words: str) -> None:
    (folder / "soot.py").write_text(OWN.replace(old, new))
    with pytest.warns(PluginWarning, match=words):
        registry()
    with pytest.raises(InputError, match=words):
        braked({"name": "soot", "shine": "500 W/m**2"})


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('"clock": 1.0}', "}", "must return a mapping with soot, clock"),
        ('"clock": 1.0}', '"clock": float("nan")}', "'clock' must be finite"),
        ('"clock": 1.0}', '"clock": np.ones(2)}', "'clock'. must be a finite number in s/s, not an array of shape"),
        ('"soot", t)', '"snow", t)', "has no state 'snow'"),
    ],
)
def test_a_wrong_rate_or_name_is_one_clear_error(folder: Path, old: str, new: str, words: str) -> None:
    (folder / "soot.py").write_text(OWN.replace(old, new))
    with pytest.raises(InputError, match=words):
        braked({"name": "soot", "shine": "500 W/m**2"}).run()
