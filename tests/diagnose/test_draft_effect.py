"""Draft effects: their source runs and has the law's numbers; folders of effects that cannot be used are refused."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from tyrefem.cli import main
from tyrefem.diagnose.law.evidence import LawFit
from tyrefem.diagnose.law.heat_law import Exponent, PlaceLaw
from tyrefem.diagnose.law.places import FILM, FLUX, HEAT, LOSS, SIDEWALL, LawPlace
from tyrefem.diagnose.law.terms import LawTerms, Switch
from tyrefem.diagnose.unknowns.heat_patches import OUTER
from tyrefem.diagnose.unknowns.unknown import Unknown
from tyrefem.diagnose.words.draft_effect import draft_effects
from tyrefem.diagnose.words.law import cause_words, discrepancy_words, limits, limits_where_it_acts, one_law_words
from tyrefem.effects import catalogue, use_effects
from tyrefem.errors import InputError
from tyrefem.inputs.study import study

Array = NDArray[np.float64]
REFERENCES = {"speed": 10.0, "load": 12e3, "temperature": 60.0}
STATION = (("station", "0.06 m"), ("width", "0.01 m"))

HEATED = Unknown("heat", 1.0, effect="missing-heat", choice=STATION)


@pytest.fixture(autouse=True)
def _own_catalogue(monkeypatch: pytest.MonkeyPatch) -> None:
    """`use_effects` changes the environment: it is restored after each test."""
    monkeypatch.setenv("TYREFEM_EFFECTS", "")
    monkeypatch.setenv("TYREFEM_PLUGINS", "")


def law(terms: dict[str, float], kind: str = "no switch", time: float = np.nan, amplitude: float = 2e4) -> PlaceLaw:
    """A law with given exponents."""
    covariance = np.diag([0.01] * len(terms))
    fit = LawFit(tuple(terms), Switch(kind, np.ones(3)), np.array(list(terms.values())), covariance, 10.0)
    entries = tuple(Exponent(name, mean, 0.1, 1.0, True, REFERENCES[name]) for name, mean in terms.items())
    known = LawTerms({name: np.zeros(3) for name in terms}, REFERENCES, (), ())
    return PlaceLaw(fit, amplitude, 0.1 * abs(amplitude), entries, {kind: 1.0}, time, 2.0, (), 0.0, known)


def diagnosis(place: LawPlace, of_place: PlaceLaw) -> Any:
    """What a draft needs of a diagnosis."""
    grid = SimpleNamespace(names=("run-1",))
    heat = SimpleNamespace(place=place, law=of_place, holds=True, basis=SimpleNamespace(grid=grid))
    return SimpleNamespace(law=heat, original=study("example-validation"))


def loaded(tmp_path: Path, place: LawPlace, of_place: PlaceLaw) -> Any:
    """The draft effect's class, from its file."""
    ((name, text),) = draft_effects(diagnosis(place, of_place)).items()
    (tmp_path / name).write_text(text, encoding="utf-8")
    (effect,) = use_effects(tmp_path)
    return catalogue()[effect]


class TyreStub:
    """A tyre at 20 m/s and 24 kN."""

    schedule = SimpleNamespace(mean=lambda quantity, t: quantity(SimpleNamespace(load=24e3)))

    def __init__(self, speed: float = 20.0) -> None:
        self._speed = speed

    def speed(self, t: float) -> float:
        """m/s."""
        return self._speed

    def ambient(self, t: float) -> float:
        """The air, degC."""
        return 25.0

    def places(self, x: Array) -> tuple[Array, Array]:
        """Stations, m."""
        return x[0], x[1]

    def region(self, zone: str) -> str:
        """The zone is the region."""
        return zone


def test_heat_at_a_station(tmp_path: Path) -> None:
    place = LawPlace(HEAT, 0.06, "all layers", HEATED, 1.0)
    effect = loaded(tmp_path, place, law({"speed": 1.5, "load": 0.5, "temperature": -0.02}, "begins", 300.0))
    assert "20000 +- 2000 W/m**3" in effect.source
    assert "speed 1.50 +- 0.10" in effect.source
    assert effect.jumps == (300.0,)
    assert [parameter.name for parameter in effect.parameters()] == [
        "heat", "speed_exponent", "load_exponent", "temperature_rate",
    ]  # fmt: skip
    hot = effect(heat="2e4 W/m**3")
    x, T = np.array([[0.06, 0.07], [0.0, 0.0]]), np.array([60.0, 110.0])
    expected = 2e4 * 2**1.5 * 2**0.5 * np.exp([0.0, -1.0]) * np.exp([0.0, -0.5])
    assert hot.heat_addend(TyreStub(), "tread", x, 400.0, T) == pytest.approx(expected)
    assert not np.any(hot.heat_addend(TyreStub(), "tread", x, 299.0, T))
    assert not np.any(hot.heat_addend(TyreStub(0.0), "tread", x, 400.0, T))


def test_a_phase_of_any_name_is_no_switch_at_a_time(tmp_path: Path) -> None:
    place = LawPlace(HEAT, 0.06, "all layers", HEATED, 1.0)
    hot = loaded(tmp_path, place, law({}, "phase 2: braking begins"))(heat="2e4 W/m**3")

    class InPhase(TyreStub):
        drive = SimpleNamespace(
            phases=[SimpleNamespace(name="1"), SimpleNamespace(name="2: braking begins")],
            locate=lambda t: (int(t >= 300.0), 0.0),
        )

    x, T = np.array([[0.06], [0.0]]), np.array([60.0])
    assert hot.heat_addend(InPhase(), "tread", x, 400.0, T) == pytest.approx(np.array([2e4]))
    assert not np.any(hot.heat_addend(InPhase(), "tread", x, 200.0, T))


def test_a_law_with_an_exponent_of_zero_is_no_other_law() -> None:
    best = law({"load": 1.0}, "begins", 300.0)
    others = [law({"load": 1.0, "speed": speed}, "begins", 300.0).fit for speed in (0.03, 0.3)]
    others = [replace(fit, covariance=1e-6 * np.eye(2)) for fit in others]
    assert limits(replace(best, alternatives=((others[0], 1.0),))) == []
    (sentence,) = limits(replace(best, alternatives=tuple((fit, 1.0) for fit in others)))
    assert sentence == "These runs do not tell it from load^1.0 × speed^0.3, it begins"


def test_heat_of_several_parts_has_one_law(tmp_path: Path) -> None:
    layer = Unknown("layer", 1.0, effect="missing-heat", choice=(*STATION, ("region", "carcass")))
    place = LawPlace(HEAT, 0.06, "all layers", HEATED, 1.0, ((HEATED, 1.0), (layer, 0.5)))
    hot = loaded(tmp_path, place, law({"load": 1.0}))(heat="2e4 W/m**3")
    x, T = np.array([[0.06], [0.0]]), np.array([60.0])
    assert hot.heat_addend(TyreStub(), "tread", x, 1.0, T) == pytest.approx(np.array([4e4]))
    assert hot.heat_addend(TyreStub(), "carcass", x, 1.0, T) == pytest.approx(np.array([6e4]))


def test_a_flux_and_a_share_of_the_loss(tmp_path: Path) -> None:
    (tmp_path / "flux").mkdir()
    (tmp_path / "loss").mkdir()
    place = LawPlace(FLUX, 0.06, "inner surface", Unknown("flux", 1.0, choice=STATION), 1.0)
    flux = loaded(tmp_path / "flux", place, law({}, "at rest", amplitude=-300.0))(into="-300 W/m**2")
    assert flux.surfaces == ("contained_air",)
    assert flux.flux(TyreStub(0.0), "contained_air", np.array([[0.06], [0.0]]), 5.0) == pytest.approx(
        np.array([-300.0])
    )
    assert not np.any(flux.flux(TyreStub(), "contained_air", np.array([[0.06], [0.0]]), 5.0))
    place = LawPlace(LOSS, np.nan, "tread", Unknown("loss", 1.0), 1.0)
    loss = loaded(tmp_path / "loss", place, law({"load": -1.0}, amplitude=0.4))(gain=0.4)
    x, T = np.array([[0.06], [0.0]]), np.array([60.0])
    assert float(loss.heat_factor(TyreStub(), "tread", x, 1.0, T)) == pytest.approx(1.2)
    assert loss.heat_factor(TyreStub(), "carcass", x, 1.0, T) == 1.0


def test_a_flux_through_a_whole_surface_is_the_same_everywhere(tmp_path: Path) -> None:
    unknown = Unknown("flux", 1.0, effect="missing-flux", choice=(("surface", "tread"),))
    place = LawPlace(FLUX, np.nan, "whole tread surface", unknown, 1.0)
    effect = loaded(tmp_path, place, law({"speed": 0.8}, "ends", 400.0, amplitude=-2e3))
    assert effect.name == "inferred-flux-whole-tread-surface"
    assert "through the whole tread surface" in effect.sentence
    assert effect.surfaces == ("road",)
    x = np.array([[0.0, 0.03, 0.06], [0.0, 0.0, 0.0]])
    wet = effect(into="-2000 W/m**2")
    into = np.broadcast_to(wet.flux(TyreStub(), "road", x, 399.0), 3)
    assert into == pytest.approx(np.full(3, -2e3 * 2**0.8))
    assert not np.any(wet.flux(TyreStub(), "road", x, 401.0))


def test_a_film_of_the_drive(tmp_path: Path) -> None:
    place = LawPlace(FILM, np.nan, "tread_air", Unknown("film", 1.0), 1.0)
    effect = loaded(tmp_path, place, law({"speed": 0.5}, "while rolling", amplitude=2.0))
    assert effect.of_drive
    assert effect(gain=2.0).film_factor(TyreStub(), "tread_air", 1.0) == pytest.approx(1 + 2 * 2**0.5)
    assert effect(gain=2.0).film_factor(TyreStub(), "road", 1.0) == 1.0
    assert effect(gain=2.0).film_factor(TyreStub(0.0), "tread_air", 1.0) == 1.0


def test_a_law_of_one_run_becomes_an_effect_of_the_day(tmp_path: Path) -> None:
    place = LawPlace(HEAT, 0.06, "all layers", HEATED, 1.0)
    assert loaded(tmp_path, place, law({}, "run run-1")).of_the_day


def test_a_second_draft_at_the_same_place_has_another_name(tmp_path: Path) -> None:
    place = LawPlace(HEAT, 0.06, "all layers", HEATED, 1.0)
    assert loaded(tmp_path, place, law({})).name == "inferred-heat-60-mm"
    assert list(draft_effects(diagnosis(place, law({})))) == ["inferred_heat_60_mm_2.py"]


def test_no_draft_without_a_law_that_holds() -> None:
    place = LawPlace(HEAT, 0.06, "all layers", HEATED, 1.0)
    d = diagnosis(place, replace(law({})))
    d.law.holds = False
    assert draft_effects(d) == {}


@pytest.mark.parametrize(
    ("files", "complaint"),
    [
        (None, "is not a folder"),
        ({}, "no Python file"),
        ({"notes.py": "x = 1\n"}, "none with an effect"),
        ({"broken.py": "class Broken(\n"}, "cannot be loaded: line 1: SyntaxError"),
    ],
)
def test_a_folder_that_cannot_be_used_is_one_error(
    tmp_path: Path, files: dict[str, str] | None, complaint: str, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "mine"
    if files is not None:
        folder.mkdir()
    for name, text in (files or {}).items():
        (folder / name).write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=complaint):
        use_effects(folder)
    assert os.environ["TYREFEM_PLUGINS"] == ""
    assert main(["diagnose", "hidden-effect", "--effects", str(folder)]) == 2
    message = " ".join(capsys.readouterr().err.split())
    assert complaint in message
    assert "Traceback" not in message


def test_steady_heat_into_the_sidewall_may_be_the_sun_on_that_side() -> None:
    side = LawPlace(FLUX, np.nan, SIDEWALL, HEATED, 1.0)
    (sentence,) = cause_words(side, law({}))
    assert sentence.startswith("The sun on that side")
    assert cause_words(side, law({}, amplitude=-2e4)) == cause_words(side, law({}, "begins", 300.0)) == []
    assert cause_words(side, law({"speed": 1.0})) == []
    assert cause_words(replace(side, where="whole outer surface"), law({})) == []


@pytest.mark.parametrize(
    ("kind", "speeds", "told"),
    [("run B", [15.6, 15.6, 0.0], True), ("run B", [10.0, 20.0, 0.0], False), ("no switch", [15.6, 15.6, 0.0], False)],
)
def test_an_exponent_from_one_run_at_one_speed_is_no_law_of_speed(kind: str, speeds: list[float], told: bool) -> None:
    """With the walking pace at rest, such a run gave speed^1.33 with a standard deviation of 0.05."""
    variables = SimpleNamespace(speed=np.array(speeds), rolling=np.array(speeds) > 0)
    place = LawPlace(FLUX, np.nan, "whole tread surface", HEATED, 1.0)
    heat: Any = SimpleNamespace(place=place, law=law({"speed": 1.33}, kind), variables=variables)
    words = "Speed hardly varies there while the tyre rolls, so its exponent only tells rolling from rest"
    assert limits_where_it_acts(heat) == ([words] if told else [])


@pytest.mark.parametrize(
    ("sources", "share", "beside", "told"), [(3, 0.987, 0, True), (1, 0.987, 0, False), (3, 0.8, 0, False),
                                             (3, 0.987, 1, False)],
)  # fmt: skip
def test_one_law_that_describes_what_several_sources_do_is_told_in_one_sentence(
    sources: int, share: float, beside: int, told: bool
) -> None:
    side = LawPlace(FLUX, np.nan, SIDEWALL, HEATED, 1.0)
    d = diagnosis(side, law({}, amplitude=216.0))
    source = SimpleNamespace(where=OUTER, inside=False, depths={OUTER: 1.0}, move=None)
    d.missing = SimpleNamespace(over_time=SimpleNamespace(clear=(source,) * sources))
    d.law.lead, d.law.share = -0.5, share
    d.law.ranking = (SimpleNamespace(place=side, others=(None,) * beside, below=0.0),)
    words = "One law describes 98.7 % of this heat: through the whole sidewall surface, the same at every speed, "
    assert one_law_words(d).startswith(words) is told
    assert ("+216 ± 22 W/m²; the sun on that side, or a hot body" in one_law_words(d)) is told


@pytest.mark.parametrize(("lead", "told"), [(8.0, True), (-8.0, False)])
def test_one_law_at_another_place_than_the_sources_is_told_if_the_data_prefer_it(lead: float, told: bool) -> None:
    """Heat inside the sidewall was told alone, though the data preferred a larger film with more than 99.99 %."""
    d = diagnosis(LawPlace(FILM, np.nan, "outside_air", HEATED, 1.0), law({}, "ends", 586.0, amplitude=1.18))
    move = SimpleNamespace(kelvin=-8.0)
    source = SimpleNamespace(station=0.095, where="sidewall", inside=True, depths={"sidewall": 1.0}, move=move)
    d.missing = SimpleNamespace(over_time=SimpleNamespace(clear=(source, source)))
    d.law.lead, d.law.share = lead, 0.999
    d.law.ranking = (SimpleNamespace(place=d.law.place, others=(), below=0.0),)
    assert one_law_words(d).startswith("One law describes 99.9 % of this heat: a share of the outside air film") is told


@pytest.mark.parametrize(
    ("name", "probability", "told"),
    [
        ("strain energy", 0.999, True),
        ("strain energy", 0.3, False),
        ("correlated readings", 0.9, False),
        ("none", 0.9, False),
    ],
)
def test_a_law_beside_a_more_probable_description_has_intervals_that_are_too_narrow(
    name: str, probability: float, told: bool
) -> None:
    leading = SimpleNamespace(name=name, probability=probability, words="another strain energy along the meridian")
    d: Any = SimpleNamespace(robustness=SimpleNamespace(models=[leading]))
    words = "Another strain energy along the meridian would describe this heat as well (99.9 %); the law's intervals"
    assert [sentence.startswith(words) for sentence in discrepancy_words(d)] == [True] * told
    d.robustness = None
    assert discrepancy_words(d) == []
