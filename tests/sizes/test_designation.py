"""A size as it stands on the tyre's wall, and what is no size."""

from __future__ import annotations

import pytest

from tyrefem.errors import InputError
from tyrefem.sizes import looks_like_size, parse_size
from tyrefem.sizes.load_index import AIRCRAFT_EXPONENT, GRAVITY, ROAD_EXPONENT, capacity, check_carries, load_of_index

pytestmark = pytest.mark.fast
INCH = 0.0254


@pytest.mark.parametrize(
    ("text", "kind", "width", "series", "rim"),
    [
        ("205/60R15", "passenger", 0.205, 0.60, 15),
        ("P205/60R15 91V", "passenger", 0.205, 0.60, 15),
        ("255/40ZR17 98W XL", "passenger", 0.255, 0.40, 17),
        ("205/55 R16 (94Y)", "passenger", 0.205, 0.55, 16),
        ("LT245/75R16", "light-truck", 0.245, 0.75, 16),
        ("LT245/75R16 120/116R", "light-truck", 0.245, 0.75, 16),
        ("195/70R15C 104/102R", "light-truck", 0.195, 0.70, 15),
        ("195 / 70 r 15 C", "light-truck", 0.195, 0.70, 15),
        ("295/80R22.5 152/148M", "truck", 0.295, 0.80, 22.5),
        ("11R22.5", "truck", 11 * INCH, None, 22.5),
        ("11 R 22.5", "truck", 11 * INCH, None, 22.5),
    ],
)
def test_road_sizes(text: str, kind: str, width: float, series: float | None, rim: float) -> None:
    size = parse_size(text)
    assert size.kind == kind
    assert size.width == pytest.approx(width)
    assert size.rim_diameter == pytest.approx(rim * INCH)
    if series is not None:
        assert size.series == pytest.approx(series)


def test_marks_on_the_wall_leave_kind_width_and_load() -> None:
    plain = parse_size("205/55R16 94V")
    marks = ("XL", "EXTRA LOAD", "XL TL", "Tubeless", "M+S", "M&S 3PMSF", "SL", "Reinforced", ", M+S")
    for text in (*(f"205/55R16 94V {mark}" for mark in marks), "205/55R16 94VXL"):
        size = parse_size(text)
        assert size.text == text
        assert (size.kind, size.width, size.load) == (plain.kind, plain.width, plain.load)
        assert size.extra_load == any(word in text.lower() for word in ("xl", "extra", "reinforced"))
    assert parse_size("295/80R22.5 152/148M TL").load == parse_size("295/80R22.5 152/148M").load
    assert parse_size("22x5.5 8PR TL").ply_rating == 8


@pytest.mark.parametrize(
    ("size", "metric", "diameter"),
    [
        ("305/680R18", "305/35R18", "680 mm"),
        ("180/550 R13", "185/60R13", "550 mm"),
        ("300/710-18", "305/40R18", "710 mm"),
    ],
)
def test_a_race_tyre_names_its_metric_size(size: str, metric: str, diameter: str) -> None:
    with pytest.raises(
        InputError, match=f"gives the outer diameter, {diameter}, .*; write {metric} with .*outer_diameter"
    ):
        parse_size(size)
    assert parse_size(metric).kind == "passenger"


@pytest.mark.parametrize("size", ["10.00-20", "12.00-20 18PR", "8.50-10 8PR", "6.50-8", "7.00-16LT"])
def test_bias_sizes_of_width_and_rim_are_refused_as_such(size: str) -> None:
    with pytest.raises(InputError, match=r"is a bias tyre of which the size gives width and rim alone"):
        parse_size(size)


def test_a_bias_truck_size_names_the_tubeless_size_that_replaces_it() -> None:
    with pytest.raises(InputError, match=r"11R22\.5 replaces this one"):
        parse_size("10.00-20")


@pytest.mark.parametrize("size", ["14.00R20 164/160J", "16.00R20", "14.00-20", "12.5R20"])
def test_a_wide_tyre_on_a_flat_rim_has_no_tubeless_size_that_replaces_it(size: str) -> None:
    """A 14.00R20 is 1240 mm high, the 15R22.5 that was named 1072 mm."""
    with pytest.raises(InputError) as caught:
        parse_size(size)
    assert "replaces" not in str(caught.value)


@pytest.mark.parametrize(
    ("size", "message"),
    [
        ("365/80R20", "mean diameter is 85 l; allowed: at most 50 l"),
        ("395/85R20 168J", "load index 168 is 5600 kg; allowed: at most 1900 kg"),
        ("255/100R16 126K", "speed symbol K; allowed: those above 110 km/h"),
        ("LT365/80R20", "no light-truck size .* 85 l; allowed: at most 60 l"),
        ("520/85R42", "no car size .* but one of trucks, tractors or machines on flat rims"),
    ],
)
def test_trucks_and_machines_written_as_cars_are_refused(size: str, message: str) -> None:
    """They were drawn as a car's tyre with 250 kPa, one polyester ply and the truck's load."""
    with pytest.raises(InputError, match=message):
        parse_size(size)


@pytest.mark.parametrize("size", ["325/60R20 121H", "LT325/80R16", "LT375/45R22 128S", "235/65R16C 121/119R"])
def test_the_largest_cars_and_light_trucks_are_none_of_these(size: str) -> None:
    assert parse_size(size).kind in {"passenger", "light-truck"}


@pytest.mark.parametrize("service", ["160K (158L)", "160K/158L", "160K 158L", "(160K) (158L)"])
def test_a_second_load_index_is_for_another_speed(service: str) -> None:
    assert parse_size(f"385/65R22.5 {service}").load == pytest.approx(4500 * GRAVITY, abs=0.1)


@pytest.mark.parametrize(("size", "successor"), [("15R22.5", "385/65R22.5"), ("18R22.5", "445/65R22.5")])
def test_wide_base_sizes_in_inches_are_as_high_as_their_successors(size: str, successor: str) -> None:
    assert parse_size(size).section_height == pytest.approx(parse_size(successor).section_height or 0.0, rel=0.03)


@pytest.mark.parametrize("mark", ["RFT", "Run Flat", "run-flat", "ZP", "SSR"])
def test_run_flat_tyres_are_refused_with_the_usual_tyre_of_the_size(mark: str) -> None:
    with pytest.raises(InputError, match=r"run-flat tyre, whose thick sidewalls .* of this size is 205/55R16 91W$"):
        parse_size(f"205/55R16 91W {mark} XL")


@pytest.mark.parametrize(("size", "usual"), [("205/55RF16 91W", "205/55R16 91W"), ("225/45 ZRF 17", "225/45 ZR 17")])
def test_run_flat_tyres_are_refused_by_the_f_of_their_structure(size: str, usual: str) -> None:
    """UN R30: RF and ZRF are the structure of run-flat tyres."""
    with pytest.raises(InputError, match=f"run-flat tyre, .* of this size is {usual}$"):
        parse_size(size)


@pytest.mark.parametrize(
    ("text", "kind", "outside", "width", "rim", "plies"),
    [
        ("22x5.5", "aircraft-bias", 22, 5.5, None, None),
        ("22x5.5 8PR", "aircraft-bias", 22, 5.5, None, 8),
        ("22x5.5-8", "aircraft-bias", 22, 5.5, 8, None),
        ("H44.5x16.5-21 28 PR", "aircraft-bias", 44.5, 16.5, 21, 28),
        ("h 44.5X16.5-21, 28 ply rating", "aircraft-bias", 44.5, 16.5, 21, 28),
        ("33x12.5-15", "aircraft-bias", 33, 12.5, 15, None),
        ("30x11.5R14.5", "aircraft-radial", 30, 11.5, 14.5, None),
        ("31x10.50R15 30PR", "aircraft-radial", 31, 10.5, 15, 30),
        ("B24x9.5-10.5", "aircraft-bias", 24, 9.5, 10.5, None),
        ("46x17R20", "aircraft-radial", 46, 17, 20, None),
        ("1400x530R23", "aircraft-radial", 1400 / 25.4, 530 / 25.4, 23, None),
    ],
)
def test_aircraft_sizes(
    text: str, kind: str, outside: float, width: float, rim: float | None, plies: int | None
) -> None:
    size = parse_size(text)
    assert size.kind == kind
    assert size.outside_diameter == pytest.approx(outside * INCH)
    assert size.width == pytest.approx(width * INCH)
    assert size.rim_diameter == (None if rim is None else pytest.approx(rim * INCH))
    assert size.ply_rating == plies


@pytest.mark.parametrize(
    ("text", "outside", "width", "rim", "load_range"),
    [
        ("31x10.50R15LT", 31, 10.5, 15, None),
        ("31X10.50R15 LT 109Q", 31, 10.5, 15, None),
        ("31x10.50R15", 31, 10.5, 15, None),
        ("LT31x10.50R15 6PR", 31, 10.5, 15, "C"),
        ("37x12.50R17LT/D 124Q", 37, 12.5, 17, "D"),
        ("33 x 12.5 ZR 20 LT F", 33, 12.5, 20, "F"),
    ],
)
def test_flotation_sizes_are_of_light_trucks(
    text: str, outside: float, width: float, rim: float, load_range: str | None
) -> None:
    size = parse_size(text)
    assert looks_like_size(text)
    assert (size.kind, size.load_range, size.prefix) == ("light-truck", load_range, "")
    assert size.outside_diameter == pytest.approx(outside * INCH)
    assert (size.width, size.rim_diameter) == (pytest.approx(width * INCH), pytest.approx(rim * INCH))


@pytest.mark.parametrize(
    ("text", "letter"), [("LT245/75R16/C", "C"), ("LT245/75R16 D", "D"), ("LT245/75R16 10PR", "E")]
)
def test_light_trucks_have_load_ranges(text: str, letter: str) -> None:
    assert parse_size(text).load_range == letter


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("205/60X15", "did you mean '205/60R15'"),
        ("205-60-15", "did you mean '205/60R15'"),
        ("P205/60X15 91V", "did you mean 'P205/60R15 91V'"),
        ("LT245-75-16", "did you mean 'LT245/75R16'"),
        ("195-70-15C", "did you mean '195/70R15C'"),
        ("h44.5/16.5/21", "did you mean 'H44.5x16.5-21'"),
        ("22x", "allowed are sizes like"),
        ("*30x7.7 26PR", "allowed are sizes like"),
        ("205/60-15", "radials are written 205/60R15"),
        ("205/05R15", "series 5; allowed: 20 to 100"),
        ("22x21-12", "do not go together"),
        ("22x5.5-30", "do not go together"),
        ("12.00R20", "such as 11R22.5 or 295/80R22.5; 13R22.5 replaces this one"),
        ("10.00R20 16PR", "11R22.5 replaces this one"),
        ("7.50R16LT", "flat rims with 5 deg seats, which have no rules here"),
        ("33X12.50-15LT", "bias-ply light-truck size, which has no rules here; radials are written 33x12.50R15LT"),
        ("33x12.50-15", "radials are written 33x12.50R15LT; an aircraft tyre is written 33x12.5-15"),
        ("31x10.50R16.5LT", "rims of 16.5 in, which have no rules here; nearest: 31x10.50R17LT"),
        ("20x12.50R15LT", "no light-truck size: its outside diameter, width and rim diameter do not go together"),
        ("31x10.50R15LT/F", "load range F; allowed: C (6PR), D (8PR), E (10PR)"),
        ("205/60R15/E", "load ranges belong to light-truck sizes, which are written LT205/60R15/E"),
        ("245/75R16LT", "did you mean 'LT245/75R16'"),
        ("31x10,50R15LT", "did you mean '31x10.50R15LT'"),
        ("185R14C", "did you mean '185/80R14C'"),
        ("180/55ZR17", "no car size, whose widths end in 5, .* nearest: 185/55ZR17"),
        ("999/99R18", "no car size .* trucks, tractors or machines"),
        ("22x5.5 0PR", "'22x5.5 0PR' has the ply rating 0; allowed: 2 to 60"),
        ("205/60R15 99PR", "has the ply rating 99; allowed: 2 to 60"),
        ("120/70ZR17 M/C", "is a motorcycle size, which has no rules here"),
        ("205/60R15 30V", "load index 30 is outside 60 to 179"),
        ("", "is no tyre size"),
        (205, "is no tyre size"),
    ],
)
def test_what_is_no_size_says_what_is_allowed(text: object, message: str) -> None:
    with pytest.raises(InputError, match="(?s)" + message.replace("(", r"\(").replace(")", r"\)")):
        parse_size(text)


def test_the_text_keeps_its_speed_symbol() -> None:
    assert parse_size("205/60R15 100YXL").text == "205/60R15 100YXL"
    assert parse_size("205/60R15 100Y XL").text == "205/60R15 100Y XL"
    assert parse_size("22 x 5.5 - 12").text.startswith("22x5.5")


def test_names_of_cards_are_no_sizes() -> None:
    names = ("nasa-22x5.5-8pr", "passenger-205-55r16", "mine", "geometry/205.toml", "H44", "205/60R15.toml")
    assert not any(map(looks_like_size, names))
    assert all(map(looks_like_size, ("205/60X15", "ST205/75R15", "3.50-18", "31x10,50R15LT")))


@pytest.mark.parametrize(
    ("index", "mass"),
    [
        *((75, 387), (82, 475), (91, 615), (98, 750), (120, 1400), (152, 3550), (160, 4500)),
        # Ten times the halves that the lower indices leave out: 257.5, 272.5, 307.5, 387.5, 487.5 kg.
        *((141, 2575), (143, 2725), (147, 3075), (155, 3875), (163, 4875)),
    ],
)
def test_loads_of_load_indices(index: int, mass: float) -> None:
    """ISO 4000-1: from memory, and within 2 % of 45 x 10^(index/80) kg."""
    assert load_of_index(index) == pytest.approx(mass * GRAVITY, abs=0.06)
    assert load_of_index(index) == pytest.approx(45 * 10 ** (index / 80) * GRAVITY, rel=0.02)


def test_a_load_goes_with_pressure() -> None:
    assert capacity(6000.0, 250e3, 125e3, ROAD_EXPONENT) == pytest.approx(6000 * 0.5**0.8)
    assert capacity(6000.0, 250e3, 300e3, ROAD_EXPONENT) == 6000.0
    check_carries(6000.0, 250e3, 3000.0, 125e3, AIRCRAFT_EXPONENT)
    with pytest.raises(
        InputError, match=r"pressure: 125 kPa carries 3000 N, not 3100 N: at least 129\.2 kPa are needed"
    ):
        check_carries(6000.0, 250e3, 3100.0, 125e3, AIRCRAFT_EXPONENT)
