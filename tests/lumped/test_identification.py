"""A lumped tyre: closed forms, known numbers out of noise and out of a run, and what cannot be told."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tyrefem.cards import merged, read_toml
from tyrefem.cli import main
from tyrefem.errors import InputError
from tyrefem.lumped.card import ThermalCard
from tyrefem.lumped.identification import LumpedIdentification, identify
from tyrefem.lumped.network import LumpedNetwork
from tyrefem.reports.thermal_card import _figure, write_files

pytestmark = pytest.mark.fast

ROOT = Path(__file__).resolve().parents[2]
SHIPPED = ROOT / "studies/thermal-passenger/thermal.toml"
#: Numbers with which the shipped card was computed, studies/thermal-passenger/README.md.
TRUE = {
    "conductance tread-carcass": 12.0, "conductance tread-air at rest": 3.0, "conductance tread-air per speed": 0.35,
    "conductance tread-road": 8.0, "conductance carcass-air": 4.0, "conductance carcass-gas": 5.0,
    "conductance gas-rim": 2.0, "heat capacity tread": 6000.0, "heat capacity carcass": 5500.0,
}  # fmt: skip
BODY: dict[str, Any] = {
    "title": "one body",
    "bodies": {"tyre": {"heat_share": 1.0}},
    "films": [{"between": ["tyre", "air"]}],
    "runs": [
        {"name": "a", "speed": "10 m/s", "rolling_resistance": "50 N", "air": "20 degC",
         "plateau": {"tyre": "70 degC"}, "warm_up": {"tyre": "600 s"}},
    ],
}  # fmt: skip


def shipped(changes: dict[str, Any] | None = None) -> ThermalCard:
    return ThermalCard.check(merged(read_toml(SHIPPED), changes or {}))


def numbers(found: LumpedIdentification) -> dict[str, tuple[float, float]]:
    return {number.name: (number.value, number.sd) for number in found.numbers}


def test_one_body_is_a_closed_form() -> None:
    """G = P/(T - T_a), C = G tau; sd of G: that of the temperature rise; of C: with that of the time; all with P's."""
    card = ThermalCard.check(BODY | {"temperature_sd": "1 K", "time_sd": 0.05, "heat_sd": 0.03})
    found = numbers(identify(card))
    assert found["conductance tyre-air"][0] == pytest.approx(500.0 / 50.0, rel=1e-6)
    assert found["conductance tyre-air"][1] == pytest.approx(10.0 * math.hypot(1.0 / 50.0, 0.03), rel=1e-3)
    assert found["heat capacity tyre"][0] == pytest.approx(6000.0, rel=1e-6)
    assert found["heat capacity tyre"][1] == pytest.approx(6000.0 * math.sqrt(0.02**2 + 0.05**2 + 0.03**2), rel=1e-3)


def test_the_time_constant_of_two_bodies_is_that_of_the_equations() -> None:
    """Against time steps of the same two equations."""
    data = merged(BODY, {"bodies": {"tyre": {"heat_share": 1.0}, "gas": {}}})
    data["films"] = [{"between": ["tyre", "air"]}, {"between": ["tyre", "gas"]}]
    card = ThermalCard.check(data)
    network = LumpedNetwork(card, np.array([6000.0, 300.0]), np.array([8.0, 2.0]), np.zeros(2), np.array([1.0, 0.0]))
    run = card.runs[0]
    K, f = network.system(run, run.speed, run.heat)
    temperatures, step = np.full(2, 20.0), 0.05
    left = np.linalg.inv(np.diag([6000.0, 300.0]) / step + 0.5 * K)
    right = np.diag([6000.0, 300.0]) / step - 0.5 * K
    end, times = network.plateau(run), [math.nan, math.nan]
    for number in range(60_000):
        temperatures = left @ (right @ temperatures + f)
        for body in (0, 1):
            if math.isnan(times[body]) and end[body] - temperatures[body] < (end[body] - 20.0) / math.e:
                times[body] = (number + 1) * step
    assert network.warm_up(run) == pytest.approx(times, abs=2 * step)
    assert end == pytest.approx([82.5, 82.5])


def test_the_shipped_card_gives_the_numbers_it_was_made_with() -> None:
    found = identify(shipped())
    for name, (value, sd) in numbers(found).items():
        assert abs(value - TRUE[name]) < sd, name
        assert sd < 0.2 * value, name
    assert set(numbers(found)) == set(TRUE)
    assert found.misfit < 0.1  # rounding only


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {"films": [{"between": ["tyre", "air"]}, {"between": ["tyre", "road"]}]},
            "air and road differ in temperature",
        ),
        ({"films": [{"between": ["tyre", "air"], "speed": "linear"}]}, "runs at two or more speeds"),
        (
            {
                "bodies": {"tyre": {"heat_share": 1.0}, "gas": {}},
                "films": [{"between": ["tyre", "air"]}, {"between": ["tyre", "gas"]}],
            },
            "a time of gas",
        ),
    ],
    ids=["two sinks alike", "one speed", "no time of the gas"],
)
def test_what_cannot_be_told_is_refused_with_what_is_missing(changes: dict[str, Any], words: str) -> None:
    data = {**BODY, **changes}
    # More runs of the same kind do not help.
    data["runs"] = [*BODY["runs"], BODY["runs"][0] | {"name": "b"}, BODY["runs"][0] | {"name": "c"}]
    with pytest.raises(InputError, match="do not determine") as error:
        identify(ThermalCard.check(data))
    assert words in str(error.value)


def test_too_few_numbers_are_refused() -> None:
    data = merged(BODY, {"runs": {"0": {"warm_up": {}}}})
    data["films"] = [{"between": ["tyre", "air"]}, {"between": ["tyre", "road"]}]
    data["runs"][0]["warm_up"] = {}
    with pytest.raises(InputError, match=r"1 measured numbers cannot determine 2: conductance tyre-air"):
        identify(ThermalCard.check(data))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"bodies": {"tyre": {"heat_share": 0.5}}}, "add up to 0.5"),
        ({"films": [{"between": ["tyre", "roda"]}]}, "did you mean 'road'"),
        ({"films": [{"between": ["air", "road"]}]}, "must join"),
        ({"films": [{"between": ["tyre", "air"]}, {"between": ["air", "tyre"]}]}, "a second film air-tyre"),
        ({"bodies": {"tyre": {"heat_share": 1.0}, "gas": {}}}, "loses its heat nowhere"),
        ({"bodies": {"rim": {"heat_share": 1.0}}}, "is a surrounding"),
    ],
)
def test_impossible_cards_are_refused(changes: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=r"films|bodies") as error:
        ThermalCard.check({**BODY, **changes})
    assert words in str(error.value)


def test_the_command_writes_films_with_standard_deviations(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["thermal-card", str(SHIPPED.parent)]) == 0
    printed = capsys.readouterr().out
    assert "conductance gas-rim" in printed
    assert re.search(r"heat capacity tread +601\d \+- 33\d +J/K", printed), "hundreds without an exponent"
    folder = tmp_path / "results/thermal-passenger-thermal"
    card = read_toml(folder / "thermal-card.toml")
    assert card["conductance"]["carcass-gas"]["film"].endswith("W/m**2/K")
    assert card["heat_capacity"]["tread"]["value"].endswith("J/K")
    assert (folder / "thermal-card.png").read_bytes().startswith(b"\x89PNG")


def test_runs_that_cannot_be_are_refused() -> None:
    """A run written twice would halve its variance; a heated body is not colder than everything about it."""
    run = BODY["runs"][0]
    with pytest.raises(InputError, match=r"runs\.1\.name: a second run '.*': it would count twice"):
        ThermalCard.check({**BODY, "runs": [run, run]})
    cold = {**run, "plateau": dict.fromkeys(run["plateau"], "5 degC")}
    with pytest.raises(InputError, match=r"runs\.0\.plateau\.tyre: 5 degC is colder than all surroundings"):
        ThermalCard.check({**BODY, "runs": [cold]})


def test_a_wrong_time_makes_every_number_doubtful() -> None:
    """500 s typed as 5000 s: no tyre of these bodies has it; the answer names the reading and its run."""
    wrong = identify(shipped({"runs": {"0": {"warm_up": {"tread": "5000 s"}}}}))
    assert {number.verdict for number in wrong.numbers} == {"doubtful"}
    (words,) = wrong.words
    assert "run '60 km/h', warm_up of tread, measured 5000" in words
    assert identify(shipped()).words == ()


def test_a_film_that_is_not_there_comes_out_as_nothing_with_its_deviation() -> None:
    """(G_0 + G_1 v) (T - T_a) = F v with G_0 = 0, and noise that asks for less: sd as of a straight line."""
    speeds, runs = np.array([10.0, 20.0, 40.0]), []
    for speed, plateau in zip(speeds, ("122 degC", "120 degC", "118 degC"), strict=True):
        run = {"name": f"{speed:g}", "speed": f"{speed} m/s", "rolling_resistance": "50 N", "air": "20 degC"}
        runs.append(run | {"plateau": {"tyre": plateau}})
    films = [{"between": ["tyre", "air"], "speed": "linear"}]
    identified = identify(ThermalCard.check(BODY | {"films": films, "runs": runs, "heat_sd": 0.0}))
    at_rest, per_speed = identified.numbers
    # A degree of the plateau changes F v/(T - T_a) = 0.5 v by one part in a hundred of it.
    weighted = np.column_stack([np.ones(3), speeds]) / (0.005 * speeds[:, None])
    sd = np.sqrt(np.diag(np.linalg.inv(weighted.T @ weighted)))
    assert (at_rest.value, at_rest.verdict) == (0.0, "poorly determined")
    assert at_rest.sd == pytest.approx(sd[0], rel=0.01)
    assert per_speed.value == pytest.approx(0.5, rel=0.01)
    assert per_speed.sd == pytest.approx(sd[1], rel=0.01)
    assert "0 fits best" in identified.words[0]


def test_readings_that_no_tyre_has_are_refused_with_the_worst() -> None:
    """The gas hotter than all that heats it, in every run."""
    with pytest.raises(
        InputError, match=r"cannot have what was measured; worst: run '.*', plateau of gas, measured 95"
    ):
        identify(shipped({"runs": {str(n): {"plateau": {"gas": "95 degC"}} for n in range(5)}}))


def test_a_share_of_the_heat_below_nothing_is_refused() -> None:
    """Plateaus of bodies with shares 0.6, 0.6 and -0.2 fit without misfit; no body takes heat away."""
    films = [{"between": [name, "air"], "conductance": "5 W/K"} for name in "abc"]
    films += [{"between": [name, "c"], "conductance": "20 W/K"} for name in "ab"]
    shares = {"a": {"heat_share": 0.4}, "b": {"heat_share": 0.4}, "c": {"heat_share": 0.2}}
    data = BODY | {"bodies": shares, "films": films, "identify_shares": True}
    rest = {"speed": "10 m/s", "air": "20 degC", "plateau": {"a": "30 degC"}}
    runs = [{"name": str(force), "rolling_resistance": f"{force} N", **rest} for force in (40, 60)]
    for given, refused in (((0.6, 0.6, -0.2), True), ((0.5, 0.3, 0.2), False)):
        card = ThermalCard.check(data | {"runs": runs})
        conductances = np.array([5.0, 5.0, 5.0, 20.0, 20.0])
        network = LumpedNetwork(card, np.ones(3), conductances, np.zeros(5), np.array(given))
        plateaus = [dict(zip("abc", map("{} degC".format, network.plateau(run)), strict=True)) for run in card.runs]
        measured = [run | {"plateau": plateau} for run, plateau in zip(runs, plateaus, strict=True)]
        card = ThermalCard.check(data | {"runs": measured})
        if refused:
            with pytest.raises(InputError, match=r"bodies\.c\.heat_share: comes out as -0\.2, less than no heat"):
                identify(card)
        else:
            assert numbers(identify(card))["heat share a"][0] == pytest.approx(0.5, rel=1e-4)


def test_two_films_of_one_name_are_refused() -> None:
    """Their numbers would have one place in thermal-card.toml."""
    bodies = {"tyre": {"heat_share": 1.0}, "a": {}, "b-c": {}, "a-b": {}, "c": {}}
    films = [{"between": pair} for pair in (["tyre", "air"], ["a", "b-c"], ["a-b", "c"])]
    with pytest.raises(InputError, match=r"films\.2\.between: 'a-b-c' is the name of another film"):
        ThermalCard.check(BODY | {"bodies": bodies, "films": films})


def test_names_of_bodies_are_no_formulas(tmp_path: Path) -> None:
    name = "$\\frac$"
    run = BODY["runs"][0] | {"plateau": {name: "70 degC"}, "warm_up": {name: "600 s"}}
    data = BODY | {"bodies": {name: {"heat_share": 1.0}}, "films": [{"between": [name, "air"]}], "runs": [run]}
    identified = identify(ThermalCard.check(data))
    write_files(identified, tmp_path / "out")
    assert (tmp_path / "out" / "thermal-card.png").is_file()
    assert [axes.get_xlabel() for axes in _figure(identified).axes] == ["measured [°C]", "measured [s]"]


def test_a_resistance_above_the_load_is_refused() -> None:
    run = {**BODY["runs"][0], "load": "4800 N", "rolling_resistance": "38 kN"}
    with pytest.raises(InputError, match=r"runs\.0\.rolling_resistance: 38000 N must be less than the load, 4800 N"):
        ThermalCard.check({**BODY, "runs": [run]})
