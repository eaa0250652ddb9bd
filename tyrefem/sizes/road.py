"""What road tyres have in common: measuring rim and allowed rims, design width, load by volume."""

from __future__ import annotations

from tyrefem.errors import InputError
from tyrefem.sizes.designation import INCH, TyreSize
from tyrefem.sizes.flotation import LOAD_SOURCE, load_by_volume, pressure_of
from tyrefem.sizes.load_index import GRAVITY, ROAD_EXPONENT, capacity, check_carries
from tyrefem.sizes.rim import Rim
from tyrefem.sizes.rules import Rules

#: Rim diameters of road tyres that rules here are for, in.
RIMS = (*range(10, 25), 17.5, 19.5, 22.5, 24.5)
#: Allowed rims: so much narrower and wider than the measuring rim, of the nominal width (estimate: 205/60R15 5.5 to
#: 7.5 in, 255/40R17 8.5 to 10 in by ETRTO, from memory).
NARROWER, WIDER = 0.1, 0.19
STANDARD = "ETRTO/ISO 4000-1 (from memory)"


def check_rim_diameter(size: TyreSize) -> float:
    """The rim diameter, m.

    Raises
    ------
    InputError : there is no such rim.
    """
    diameter = size.rim_diameter or 0.0
    inches = round(diameter / INCH, 2)
    if inches not in RIMS:
        near = min(RIMS, key=lambda rim: abs(rim - inches))
        raise InputError(
            f"'{size.text}' has the rim diameter {inches:g} in, which road tyres have not; nearest {near:g} in; "
            "allowed: 10 to 24 in, 17.5, 19.5, 22.5"
            " and 24.5 in",
            field="size",
        )
    return diameter


def measuring_rim(
    size: TyreSize,
    rule: Rules,
    share: float,
    step: float,
    source: str,
    reach: tuple[float, float] = (NARROWER, WIDER),
) -> float:
    """Rule of the rim's width: the nominal width times a share, to the nearest ``step``; the allowed range around it,
    ``reach`` of the nominal width narrower and wider.

    Raises
    ------
    InputError : a given rim is too narrow or too wide.
    """
    measuring = round(size.width * share / step) * step
    low, high = measuring - reach[0] * size.width, measuring + reach[1] * size.width
    given = rule("rim_width", measuring, "in", source)
    if not low - 1e-4 <= given <= high + 1e-4:
        raise InputError(
            f"{given / INCH:.4g} in is too {'narrow' if given < low else 'wide'} for {size.text}; allowed: "
            f"{low / INCH:.3g} to {high / INCH:.3g} in "
            f"(measuring rim {measuring / INCH:g} in)",
            field="rim_width",
        )
    return given


def design_width(size: TyreSize, rule: Rules, rim_width: float, theoretical: float, standard: str = STANDARD) -> float:
    """Section width on this rim: the nominal width and 0.4 of what the rim is wider than the theoretical one."""
    source = f"{standard}: nominal width + 0.4 (rim width - {theoretical:g} nominal widths)"
    width = size.width + 0.4 * (rim_width - theoretical * size.width)
    return rule("section_width", width, "mm", source, 0.8 * size.width, 1.25 * size.width)


def road_rim(
    rule: Rules, diameter: float, width: float, height: float, radius: float, taper: float, source: str
) -> Rim:
    """The rim of its named numbers."""
    return Rim(
        rule("rim_diameter", diameter, "mm", "of the size"),
        width,
        rule("flange_height", height, "mm", source, 5e-3, 60e-3),
        rule("flange_radius", radius, "mm", source, 3e-3, 40e-3),
        rule("seat_taper", taper, "deg", source, 0, 0.35),
    )


def litres(size: TyreSize) -> float:
    """Width x height x mean diameter of the section, l: what loads are estimated by."""
    height = size.section_height or 0.0
    return size.width * height * ((size.rim_diameter or 0.0) + height) * 1e3


def rated(size: TyreSize, rule: Rules, estimate: tuple[float, str], pressure: float, source: str) -> float:
    """Rated load and pressure: of the load index, or the estimate, kg with the words of its source.

    Returns the pressure. A load and pressure of use are checked against it.

    Raises
    ------
    InputError : the pressure of use cannot carry the load of use.
    """
    load, words = round(estimate[0] * GRAVITY, -1), f"estimate: {estimate[1]}; {source}"
    if size.load is not None:
        load, words = size.load, "of the load index (ISO 4000-1)"
    return _of_use(rule, load, words, pressure, source)


def rated_flotation(size: TyreSize, rule: Rules) -> float:
    """`rated` of a light-truck size that gives the diameter: by its load range, its load index, or load range C."""
    width, height, rim = size.width, size.section_height or 0.0, size.rim_diameter or 0.0
    pressure, source = pressure_of(width, height, rim, size.load_range, size.load)
    load, words = round(load_by_volume(width, height, rim, pressure), -1), f"estimate: {LOAD_SOURCE}"
    if size.load is not None:
        load, words = size.load, "of the load index (ISO 4000-1)"
    return _of_use(rule, load, words, pressure, source)


def _of_use(rule: Rules, load: float, words: str, pressure: float, source: str) -> float:
    """Rated load and pressure as rules; a load and pressure of use checked against them. The rated pressure."""
    load = rule("rated_load", load, "N", words, 100, 1e6)
    pressure = rule("rated_pressure", pressure, "kPa", source, 5e4, 2e6)
    if "load" in rule.given or "pressure" in rule.given:
        at = rule("pressure", pressure, "kPa", "as rated", 1e4, 3e6)
        words = "as rated" if at >= pressure else "what the tyre carries at this pressure"
        wanted = rule("load", capacity(load, pressure, at, ROAD_EXPONENT), "N", words)
        check_carries(load, pressure, wanted, at, ROAD_EXPONENT)
    return pressure
