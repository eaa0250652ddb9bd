"""Numbers of a diagnosis as text: probabilities, amounts with uncertainty and unit, corrections of unknowns."""

from __future__ import annotations

import math

from tyrefem.diagnose.unknowns.unknown import Unknown

#: SI unit of a parameter -> factor and unit in reports.
READ = {
    "1": (1.0, ""),
    "1/delta_degC": (100.0, "%/K"),
    "J/m**3": (1e-3, "kJ/m³"),
    "Pa/s": (3.6, "kPa/h"),
    "W/m**2": (1.0, "W/m²"),
    "W/m**3": (1e-3, "kW/m³"),
    "delta_degC": (1.0, "K"),
    "delta_degC/s": (3600.0, "K/h"),
    "m": (1e3, "mm"),
    "m**2*K/W": (1.0, "m²K/W"),
    "rad": (180 / math.pi, "°"),
}


def percent(probability: float) -> str:
    """A probability as text, never rounded to 0 or 100 %.

    >>> percent(0.99286), percent(0.99987), percent(0.99999), percent(0.0004), percent(0.62)
    ('99.3 %', '99.99 %', 'more than 99.99 %', 'less than 0.1 %', '62 %')
    """
    if probability < 1e-3:
        return "less than 0.1 %"
    for above, decimals in ((0.9999, None), (0.999, 2), (0.98, 1)):
        if probability > above:
            return "more than 99.99 %" if decimals is None else f"{100 * probability:.{decimals}f} %"
    return f"{100 * probability:.0f} %" if probability >= 0.1 else f"{100 * probability:.1f} %"


def chance(log_odds: float) -> float:
    """A probability from ln odds.

    >>> round(chance(3.0), 3), round(chance(-1e4), 3)
    (0.953, 0.0)
    """
    return 1.0 / (1.0 + math.exp(min(-log_odds, 700.0)))


def at_least(probability: float) -> str:
    """A lower limit of a probability as text: not rounded up.

    >>> at_least(0.97), at_least(0.9656), at_least(0.99999)
    ('at least 97 %', 'at least 96 %', 'more than 99.99 %')
    """
    text = percent(probability)
    if text.startswith(("more", "less")):
        return text
    decimals = len(text.removesuffix(" %").partition(".")[2])
    scale = 10.0**decimals
    return f"at least {math.floor(100 * probability * scale + 1e-9) / scale:.{decimals}f} %"


def amount(value: float, sd: float, unit: str) -> str:
    """A value with sign, standard deviation and unit, rounded to the digits of the standard deviation.

    >>> amount(4.3766, 0.8586, "delta_degC"), amount(0.0002056, 0.00013, "m"), amount(-0.054, 0.098, "1")
    ('+4.4 ± 0.9 K', '+0.21 ± 0.13 mm', '-0.05 ± 0.10')
    """
    factor, shown = READ.get(unit, (1.0, unit.replace("**2", "²").replace("**3", "³")))
    return f"{with_sd(value * factor, sd * factor, sign='+')} {shown}".rstrip()


def with_sd(value: float, sd: float, *, sign: str = "-") -> str:
    """A value and its standard deviation, rounded to the digits of the deviation; ``sign="+"``: always with a sign.

    >>> with_sd(1.9234, 0.0412), with_sd(-0.31, 0.2), with_sd(1234.0, 87.0), with_sd(1.5, 0.2, sign="+")
    ('1.92 ± 0.04', '-0.31 ± 0.20', '1230 ± 90', '+1.50 ± 0.20')
    """
    decimals = _decimals(sd if sd > 0 and math.isfinite(sd) else abs(value) / 100)
    scale = 10.0 ** min(decimals, 0)
    first, second = (
        (round(number * scale) / scale if math.isfinite(number) else number for number in (value, sd))
        if decimals < 0
        else (value, sd)
    )
    places = max(decimals, 0)
    return f"{first:{sign}z.{places}f} ± {second:.{places}f}"


def time_with_sd(time: float, sd: float) -> str:
    """A time with its standard deviation, at least 1 s.

    >>> time_with_sd(611.7, 0.2), time_with_sd(611.7, 24.0), time_with_sd(611.7, 58.0)
    ('611.7 ± 1.0 s', '612 ± 24 s', '610 ± 60 s')
    """
    return f"{with_sd(time, max(sd, 1.0))} s"


def extent(low: float, high: float, unit: str) -> str:
    """A range with unit, rounded to the digits of half its width.

    >>> extent(18.73, 27.02, "delta_degC"), extent(0.0001, 0.0004, "m")
    ('+19 to +27 K', '+0.10 to +0.40 mm')
    """
    factor, shown = READ.get(unit, (1.0, unit.replace("**2", "²").replace("**3", "³")))
    low, high = low * factor, high * factor
    places = max(_decimals((high - low) / 2), 0)
    return f"{low:+z.{places}f} to {high:+z.{places}f} {shown}".rstrip()


def _decimals(sd: float) -> int:
    """Decimals for two digits of a standard deviation with a mantissa below 3.55, else one (Particle Data Group)."""
    if sd <= 0 or not math.isfinite(sd):
        return 2
    size = math.floor(math.log10(sd))
    return 1 - size if sd / 10.0**size < 3.55 else -size


def parameter_name(unknown: Unknown) -> str:
    """Meaning of an effect's parameter, or the name of another unknown."""
    return unknown.parameter.prior.meaning if unknown.parameter else base_name(unknown)


def base_name(unknown: Unknown) -> str:
    """A base number in words, with all regions that share it.

    >>> keys = ("materials.belt-1.conductivity.along", "materials.belt-2.conductivity.along")
    >>> base_name(Unknown(keys[0], 0.1, keys=keys)), base_name(Unknown("drive.load", 0.02))
    ('conductivity along of belt-1, belt-2', 'load')
    """
    table, *rest = unknown.key.split(".")
    if table == "drive":
        return " ".join(rest).replace("_", " ")
    if table != "materials" or len(rest) < 2:
        return unknown.label
    regions = dict.fromkeys(key.split(".")[1] for key in (unknown.key, *unknown.keys))
    named = " ".join(part for part in rest[1:] if part not in ("value", "elasticity"))
    return f"{named.replace('_', ' ')} of {', '.join(regions)}"


def correction_subject(unknown: Unknown) -> str:
    """What a correction changes: a base number, a film, or a sensor with what is wrong at it.

    >>> correction_subject(Unknown("drive.load", 0.02))
    'load'
    """
    if unknown.effect is None or unknown.effect == "film-scale":
        film = dict(unknown.choice).get("film", "").replace("_", " ")
        return f"film coefficient of {film}" if film else base_name(unknown)
    place = ", ".join([*dict(unknown.choice).values(), *unknown.runs])
    return f"{place}: {parameter_name(unknown)}" if place else parameter_name(unknown)


def correction_words(unknown: Unknown, x: float, sd: float) -> str:
    """A correction of a base number, film or sensor: its name and its change with unit.

    >>> correction_words(Unknown("drive.load", 0.02), 0.0583, 0.004)
    'load +6.0 ± 0.4 %'
    """
    return f"{correction_subject(unknown)} {correction_amount(unknown, x, sd)}"


def correction_amount(unknown: Unknown, x: float, sd: float) -> str:
    """The change of a base number or film in per cent, of a temperature or a sensor in its unit.

    >>> correction_amount(Unknown("drive.load", 0.02), 0.0583, 0.004)
    '+6.0 ± 0.4 %'
    >>> correction_amount(Unknown("drive.ambient", 0.0067, kelvins=298.15), 0.01, 0.002)
    '+3.0 ± 0.6 K'
    """
    if unknown.kelvins:
        return amount(unknown.kelvins * math.expm1(x), unknown.kelvins * sd * math.exp(x), "delta_degC")
    if unknown.effect is None or unknown.effect == "film-scale":
        return amount(100 * math.expm1(x), 100 * sd * math.exp(x), "%")
    return amount(unknown.value(x), sd, unknown.unit)


def run_words(name: str) -> str:
    """The name of a run in a sentence.

    >>> run_words("slow"), run_words("run-2")
    ('run slow', 'run-2')
    """
    return name if name.lower().startswith("run") else f"run {name}"
