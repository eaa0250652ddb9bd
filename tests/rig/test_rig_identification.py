"""Identification: on 3D data, on what the evidence chooses, and on tests that cannot determine what is asked."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from cases import measured, properties, truth

from tyrefem.heating_test import identification as identification_module
from tyrefem.heating_test.fit import Fitter
from tyrefem.heating_test.grid import Fineness
from tyrefem.heating_test.layer_study import _misfits
from tyrefem.heating_test.parameters import at, parameters_of
from tyrefem.heating_test.readings import matched
from tyrefem.heating_test.twin import Twin
from tyrefem.rig import Identification, RigCard, identify, load, simulate

COARSE, MIDDLE = Fineness(2, 5, 2), Fineness(3, 7, 3)


def rig(*, runs: tuple[str, ...] = ("high",), **phases: float) -> RigCard:
    card, _ = load("trtlab")
    return card.model_copy(
        update={
            "runs": {name: card.runs[name] for name in runs},
            "phases": card.phases.model_copy(update=phases),
        }
    )


def of_itself(card: RigCard, values: dict[str, float] | None = None, **options: Any) -> Identification:
    """Readings of the model itself on the same coarse mesh, identified."""
    wanted = [name for name in card.sensors if name not in options.get("without", ())]
    done = simulate(card, every=10.0, seed=7, values=values, fineness=COARSE)
    tests = [matched(card, run, wanted, options.pop("without", ())) for run in done.runs.values()]
    return identify(card, tests=tests, fineness=COARSE, **options)


def test_curved_patch_in_3d_is_identified() -> None:
    """Hexahedra, BDF2, another air, misplaced spot: one power, every property inside its interval and within 10 %."""
    card = rig(heating=500.0, cooling=150.0)
    real = replace(truth(0, card, linear=False), lines=(0.0, 2.5, 5.0, 8.0, 16.0))
    runs = measured(0, card, real)
    identification = identify(
        card, tests=[matched(card, run, list(card.sensors)) for run in runs], linear=False, fineness=MIDDLE
    )
    for name, value in properties(card, real).items():
        estimate = identification.by_name[name]
        assert estimate.verdict == "determined", name
        assert estimate.holds(value), name
        assert estimate.value == pytest.approx(value, rel=0.10), name
    assert identification.by_name["spot_across"].holds(real.spot_offset)
    for block in identification.fit.blocks:
        assert np.sqrt(np.mean(block.residual**2)) < 1.3 * card.sensors[block.series.sensor].noise
    assert sum(block.series.counts.sum() for block in identification.fit.blocks) == 3 * 143


def test_evidence_finds_what_is_linear_and_leaves_the_rest() -> None:
    """The tread's conductivity falls by 0.2 % per kelvin: chosen, alone, with its value."""
    card = rig(heating=150.0, cooling=0.0)
    identification = of_itself(card, {"tread.conductivity_slope": -2e-3, "tread.conductivity": 0.28})
    assert identification.selection.chosen == ("tread.conductivity_slope",)
    assert identification.by_name["tread.conductivity_slope"].holds(-2e-3)
    assert identification.by_name["tread.conductivity"].holds(0.28)
    assert identification.selection.log_evidence[identification.selection.chosen] > 3
    assert any("Linear in temperature: conductivity of tread" in words for words in identification.words)


def test_a_short_test_without_inner_view_says_what_it_cannot_determine() -> None:
    card = rig(heating=60.0, cooling=0.0)
    identification = of_itself(card, without=("inner", "interface"), linear=False)
    unknown = {estimate.name for estimate in identification.properties if estimate.verdict == "not determined"}
    assert {"carcass.conductivity", "carcass.specific_heat"} <= unknown
    assert sum(words.startswith("NOT DETERMINED") for words in identification.words) == len(unknown)
    report = " ".join(identification.words)
    assert "No sensor measures the inner face." in report
    assert "The test is short: the readings have 60 s" in report
    for name in unknown:
        estimate = identification.by_name[name]
        assert estimate.holds(estimate.prior_value)
        assert estimate.high / estimate.low > 1.5
    # A misfit may widen an interval beyond the card's: no share of it is left then.
    wide = tuple(replace(each, share_left=1.6) if each.name in unknown else each for each in identification.estimates)
    report = " ".join(replace(identification, estimates=wide).words)
    assert "less certain than on the card" in report
    assert "160%" not in report


def test_unknown_absorbed_power_is_unknown_scale() -> None:
    """Scaling power, k, c and films together changes no temperature: a doubtful absorptance shows in every property."""
    card = rig(heating=150.0, cooling=0.0)
    sure = of_itself(card, linear=False)
    laser = card.laser.model_copy(update={"absorptance_sd": 0.1})
    around = card.surroundings.model_copy(update={"convection_sd": 0.5})
    doubtful = of_itself(card.model_copy(update={"laser": laser, "surroundings": around}), linear=False)
    for name in ("tread.conductivity", "tread.specific_heat"):
        assert doubtful.by_name[name].relative_sd > 1.5 * sure.by_name[name].relative_sd
    names = [estimate.name for estimate in doubtful.estimates]
    pair = names.index("tread.conductivity"), names.index("absorptance")
    assert doubtful.correlation[pair] > 0.9


def late(card: RigCard, seconds: float) -> Identification:
    """Readings of a laser that is switched on later than the card says, identified with the card."""
    (name,) = card.runs
    return of_itself(card, {f"{name}.clock": seconds}, linear=False)


def test_a_late_clock_is_no_property_of_the_tyre() -> None:
    """A clock that is off makes every property doubtful, first of all words; with a standard deviation it is fitted."""
    wrong = late(rig(heating=150.0, cooling=0.0), 10.0)
    assert {estimate.verdict for estimate in wrong.properties} <= {"doubtful", "not determined"}
    assert "doubtful" in {estimate.verdict for estimate in wrong.properties}
    assert wrong.words[0].startswith("DOUBTFUL: the model does not describe the readings of outer")
    assert "clock_sd" in wrong.words[1]
    assert not any("determine all" in words for words in wrong.words)
    right = late(rig(heating=150.0, cooling=0.0, clock_sd=5.0), 10.0)
    assert right.by_name["high.clock"].value == pytest.approx(10.0, abs=0.1)
    for name, value in (("tread.conductivity", 0.25), ("tread.specific_heat", 1700.0)):
        assert right.by_name[name].holds(value)
    assert not any("DOUBTFUL" in words for words in right.words)


def test_a_spot_larger_than_the_card_says_is_doubtful() -> None:
    """11 mm for 10 mm: the fit gives wrong properties with small intervals, and must not call them determined."""
    card = rig(heating=500.0, cooling=150.0)
    wide = card.model_copy(update={"laser": card.laser.model_copy(update={"spot_diameter": 11e-3})})
    done = simulate(wide, every=10.0, seed=7, fineness=COARSE)
    tests = [matched(card, run, list(card.sensors)) for run in done.runs.values()]
    identification = identify(card, tests=tests, fineness=COARSE, linear=False)
    assert not identification.by_name["tread.specific_heat"].holds(1700.0)
    assert {estimate.verdict for estimate in identification.properties} <= {"doubtful", "not determined"}
    assert "spot diameter" in identification.words[0]
    assert not any("determine all" in words for words in identification.words)


def test_an_uncertain_emissivity_of_the_cameras_is_fitted() -> None:
    """Cameras that read 5 % less rise, by their emissivity setting: with its deviation the intervals hold the truth."""
    card = rig(heating=150.0, cooling=0.0)
    values = {"outer.gain": 0.95, "inner.gain": 0.95}
    sensors = {
        name: sensor.model_copy(update={"gain_sd": 0.05}) if sensor.instrument == "camera" else sensor
        for name, sensor in card.sensors.items()
    }
    fitted = of_itself(card.model_copy(update={"sensors": sensors}), values, linear=False)
    for name, value in (("tread.conductivity", 0.25), ("tread.specific_heat", 1700.0)):
        assert fitted.by_name[name].holds(value), name
    assert fitted.by_name["outer.gain"].holds(0.95)
    # The sensitivity of the gain is that of whole readings.
    name = "outer.gain"
    place, every = fitted.fit.parameters.names.index(name), fitted.fit.parameters
    clock, run = fitted.tests[0].clock, fitted.tests[0].run
    twin = Twin(fitted.card, tuple(fitted.card.sensors), COARSE)
    moved = [twin.readings(every.values(at(fitted.fit.x, place, step)), run, clock) for step in (0.1, -0.1)]
    fields = twin.fields(every.values(fitted.fit.x), run, clock)
    slopes = twin.slopes(every, fitted.fit.x, run, clock, fields, moved[0])[:, :, place]
    np.testing.assert_allclose(slopes, (moved[0] - moved[1]) / 0.2, rtol=0.01, atol=1e-3)


def test_a_number_far_from_the_card_is_named() -> None:
    """An offset of 2 K where the card says 0.1 K changes no property, but somebody should look at the camera."""
    identification = of_itself(rig(heating=150.0, cooling=0.0), {"outer.offset": 2.0}, linear=False)
    assert identification.by_name["tread.conductivity"].holds(0.25)
    (words,) = (words for words in identification.words if words.startswith("Unusual"))
    assert "offset of outer is" in words
    assert "standard deviations from the card's 0" in words


def test_the_slopes_of_a_selection_are_those_of_the_fit(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fit and selection that never agree: the words must not deny the slopes of the result, or name others."""
    slope = ("tread.conductivity_slope",)
    wanted = iter([slope, (), slope])
    select = identification_module.select
    monkeypatch.setattr(identification_module, "select", lambda *given: replace(select(*given), chosen=next(wanted)))
    identification = of_itself(rig(heating=60.0, cooling=0.0))
    fitted = tuple(estimate.name for estimate in identification.estimates if estimate.group == "slope")
    assert identification.selection.chosen == fitted == ()
    assert any(words.startswith("No property needs") for words in identification.words)


def test_tests_may_have_different_sensors(monkeypatch: pytest.MonkeyPatch) -> None:
    """A sensor that only a later test has is computed, too."""
    card = rig(runs=("low", "high"), heating=60.0, cooling=0.0)
    done = simulate(card, every=10.0, fineness=COARSE)
    tests = [
        matched(card, done.runs["low"], ["outer", "interface"], ["inner"]),
        matched(card, done.runs["high"], list(card.sensors)),
    ]

    def blocks(_card: RigCard, _file: object, fitter: Fitter, _linear: object) -> Any:
        every = parameters_of(card, fitter.twin.sensors)
        x = np.zeros(len(every))
        return fitter.blocks(every, x, fitter.predict(every, x))

    monkeypatch.setattr(identification_module, "_identified", blocks)
    seen: Any = identification_module.identify(card, tests=tests, fineness=COARSE)
    assert [block.series.sensor for block in seen] == ["outer", "interface", "outer", "inner", "interface"]
    for block in seen:
        assert np.abs(block.residual).max() < 3.0


def test_a_short_test_has_no_misfit_after_its_transients() -> None:
    """All its readings are within 300 s of a switch of the laser."""
    card = rig(idle=0.0, heating=200.0, cooling=100.0)
    block: Any = SimpleNamespace(series=SimpleNamespace(times=np.arange(1.0, 300.0)), residual=np.ones(299))
    early, late = _misfits(SimpleNamespace(card=card, fit=SimpleNamespace(blocks=[block])))
    assert early == 1.0
    assert np.isnan(late)
