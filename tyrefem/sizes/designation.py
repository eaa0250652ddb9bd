"""A tyre's size as it stands on its wall: ``205/60R15 91V``, ``31x10.50R15LT``, ``11R22.5``, ``H44.5x16.5-21``."""

from __future__ import annotations

import re
from dataclasses import dataclass

from tyrefem.errors import InputError
from tyrefem.sizes.flotation import BELOW_NOMINAL, NARROW
from tyrefem.sizes.load_index import GRAVITY, load_of_index

INCH, MM = 0.0254, 1e-3
_NUMBER = r"\d{1,4}(?:\.\d{1,3})?"
#: Load index with speed symbol, as "91V", "152/148M", "(94Y)"; a second one, as in "160K (158L)", is for another speed.
_SECOND = r"(?:\s*[\s(/]\s*\d{2,3}(?:/\d{2,3})?\s*[A-HJ-NP-Y]\)?)?"
_SERVICE = rf"(?:\s+\(?(?P<index>\d{{2,3}})(?:/\d{{2,3}})?\s*(?P<symbol>[A-HJ-NP-Y])\)?{_SECOND})?"
#: Marks behind a size: all that may stand there, those of an extra load, those of run-flat tyres.
_MARKS = re.compile(
    r"\s*,?\s*(?:\b|(?<=\d[A-Z]))(?:XL|SL|extra load|standard load|reinforced|TL|tubeless|M\s?[+&/]\s?S|3PMSF)(?!\w)",
    re.IGNORECASE,
)
_EXTRA_LOAD = re.compile(r"(?:\b|(?<=\d[A-Z]))(?:XL|extra load|reinforced)(?!\w)", re.IGNORECASE)
#: Also the F of the structure, as 225/45RF17 (UN R30).
_RUN_FLAT = re.compile(r"\s*,?\s*\b(?:run[\s-]?flat|RFT|ROF|SSR|ZP)(?!\w)|(?<=R)F(?=\s?\d)", re.IGNORECASE)
_PLIES = r"(?:\s*,?\s*(?P<plies>\d{1,2})\s*-?\s*(?:PR|ply(?:\s*rating)?))?"
#: Load range behind the rim, as "/E" or " E"; without LT before the size a C is that of commercial tyres.
_RANGE = r"(?:(?P<slash>\s?/\s?|\s?)(?P<letter>[B-H])(?![A-Z0-9]))?"
_METRIC = re.compile(
    rf"(?P<service>P|LT)?\s?(?P<width>\d{{3}})\s?/\s?(?P<series>\d{{2,3}})\s?Z?(?P<build>R|-|D|B)\s?"
    rf"(?P<rim>\d{{2}}(?:\.5)?){_RANGE}{_SERVICE}{_PLIES}",
    re.IGNORECASE,
)
_TRUCK = re.compile(
    rf"(?P<width>\d{{1,2}}(?:\.\d{{1,2}})?)\s?(?P<build>R)\s?(?P<rim>\d{{2}}\.5){_SERVICE}{_PLIES}", re.IGNORECASE
)
_FLOTATION = re.compile(
    rf"(?P<service>LT)?\s?(?P<outside>\d{{2}}(?:\.\d)?)\s?[x×X]\s?(?P<width>\d{{1,2}}(?:\.\d{{1,2}})?)\s?Z?"
    rf"(?P<build>R|-|D|B)\s?(?P<rim>\d{{2}}(?:\.5)?)(?:\s?(?P<light>LT))?{_RANGE}{_SERVICE}{_PLIES}",
    re.IGNORECASE,
)
#: Inch sizes for flat rims with 5 degree seats, with tube or flap: ``12.00R20``.
_FLAT_RIM = re.compile(
    rf"(?P<width>\d{{1,2}}(?:\.\d{{1,2}})?)\s?R\s?(?P<rim>\d{{2}})(?:LT|C)?{_SERVICE}{_PLIES}", re.IGNORECASE
)
#: Width and rim diameter of bias tyres, in: ``10.00-20`` of trucks, ``6.50-8`` of aircraft and forklifts.
_WIDTH_AND_RIM = re.compile(
    rf"(?P<width>\d{{1,2}}(?:\.\d{{1,2}})?)\s?-\s?(?P<rim>\d{{1,2}}(?:\.5)?)(?:LT|C)?{_SERVICE}{_PLIES}", re.IGNORECASE
)
_AIRCRAFT = re.compile(
    rf"(?:(?P<service>[BCH])\s?)?(?P<outside>{_NUMBER})\s?[x×X]\s?(?P<width>{_NUMBER})(?:\s?(?P<build>[-R])\s?(?P<rim>{_NUMBER}))?{_PLIES}",
    re.IGNORECASE,
)
#: Diameter of a flat rim -> that of the 15 degree rim of the same tyre without tube, and the widths that have one, in;
#: the width's number rises by up to one (from memory). Wider tyres, as 14.00R20, have none.
TUBELESS = {"20": ("22.5", (7.5, 8.25, 9.0, 10.0, 11.0, 12.0)), "22": ("24.5", (10.0, 11.0))}
#: One size of each kind, for messages.
EXAMPLES = (
    "205/60R15",
    "P205/60R15 91V",
    "LT245/75R16",
    "31x10.50R15LT",
    "295/80R22.5",
    "11R22.5",
    "22x5.5 8PR",
    "H44.5x16.5-21",
    "46x17R20",
)
#: Height of a truck section over its width where the size gives the width in inches. Estimate: 10R22.5 to 12R22.5
#: are 0.85 to 0.88 by the standard (ETRTO, from memory).
FULL_SERIES = 0.865
#: The same from this width on, in: 15R22.5, 16.5R22.5 and 18R22.5 are 1072, 1124 and 1158 mm (from memory), as their
#: successors 385/65R22.5, 425/65R22.5 and 445/65R22.5.
WIDE_SERIES, LEAST_WIDE = 0.65, 14.0
#: Largest metric sizes on rims of whole inches by kind: width x height x mean diameter, l, and load of the index, kg.
#: Estimate: LT315/75R16 has 48 l, LT325/80R16 56 l, 335/80R20 of trucks 70 l; load indices go to 126 and 132.
LARGEST = {"passenger": (50.0, 1900.0), "light-truck": (60.0, 2400.0)}
#: Speed symbols up to 110 km/h: no car has them.
SLOW = "ABCDEFGJK"
#: Smallest and largest ply rating.
PLY_RATINGS = (2, 60)
#: Load range of a ply rating (Tire and Rim Association, from memory).
LOAD_RANGES = {6: "C", 8: "D", 10: "E", 12: "F"}
#: Without LT, widths from here on that are written to the half inch, on rims from here on, are of light trucks, in:
#: radial aircraft tyres have none of them (makers' data books, from memory), nor has the shipped data book ".50".
LEAST_FLOTATION = (8.5, 14)


@dataclass(frozen=True)
class TyreSize:
    """A size, SI units; None: the text does not tell.

    ``kind``: the rules that it follows, a module of `tyrefem.sizes.kinds`. ``series``: section height over width.
    ``outside_diameter``: nominal, of aircraft and flotation sizes, which give it in place of the series.
    ``load_range``: letter C to F of light-truck sizes, from the letter or the ply rating.
    ``extra_load``: of passenger sizes, the mark XL, Extra Load or Reinforced.

    >>> size = parse_size("205/60R15 91V")
    >>> size.kind, round(size.width, 3), size.series, round(size.rim_diameter, 3), size.load
    ('passenger', 0.205, 0.6, 0.381, 6031.1)
    >>> parse_size("H44.5x16.5-21").text
    'H44.5x16.5-21'
    """

    text: str
    kind: str
    width: float
    series: float | None = None
    rim_diameter: float | None = None
    outside_diameter: float | None = None
    load: float | None = None
    ply_rating: int | None = None
    load_range: str | None = None
    extra_load: bool = False

    @property
    def section_height(self) -> float | None:
        """Height of the section by the designation, m."""
        return None if self.series is None else self.series * self.width

    @property
    def prefix(self) -> str:
        """Letter before an aircraft size, B, C or H (how narrow its rim is); else nothing."""
        first = self.text[:1].upper()
        return first if first in {"B", "C", "H"} and self.kind.startswith("aircraft") else ""


def parse_size(text: object) -> TyreSize:
    """The size of a designation.

    Raises
    ------
    InputError : not a size; says what is allowed and the nearest that is.

    >>> parse_size("295/80R22.5").kind, parse_size("LT245/75R16").kind, parse_size("46x17R20").kind
    ('truck', 'light-truck', 'aircraft-radial')
    """
    if not isinstance(text, str):
        raise InputError(f"{text!r} is no tyre size; write one like {_listed()}", field="size")
    tidy = " ".join(text.split())
    plain = _MARKS.sub("", tidy).strip()
    if _RUN_FLAT.search(plain):
        raise InputError(
            f"'{text}' is a run-flat tyre, whose thick sidewalls have no rules here; the usual tyre of this size is "
            f"{_RUN_FLAT.sub('', plain)}",
            field="size",
        )
    if match := _METRIC.fullmatch(plain):
        return _metric(tidy, match)
    if match := _TRUCK.fullmatch(plain):
        width = float(match["width"])
        series = FULL_SERIES if width < LEAST_WIDE else WIDE_SERIES
        return TyreSize(
            _tidy(tidy), "truck", width * INCH, series, float(match["rim"]) * INCH, None, _load(match), _plies(match)
        )
    if (match := _FLOTATION.fullmatch(plain)) and _is_flotation(match):
        return _flotation(tidy, match)
    if match := _AIRCRAFT.fullmatch(plain):
        return _aircraft(tidy, match)
    if match := _FLAT_RIM.fullmatch(plain):
        raise InputError(
            f"'{text}' is a size for flat rims with 5 deg seats, which have no rules here; truck sizes are for 15 deg "
            f"rims (diameters in half inches), such as 11R22.5 or 295/80R22.5{_tubeless(match)}",
            field="size",
        )
    if match := _WIDTH_AND_RIM.fullmatch(plain):
        raise InputError(
            f"'{text}' is a bias tyre of which the size gives width and rim alone, which has no rules here; an "
            "aircraft tyre is written diameter x width - rim, such as H44.5x16.5-21; a road tyre as a "
            f"radial{_tubeless(match)}",
            field="size",
        )
    if re.search(r"\bM/C\b", tidy, re.IGNORECASE):
        raise InputError(
            f"'{text}' is a motorcycle size, which has no rules here; allowed are sizes like {_listed()}", field="size"
        )
    raise InputError(f"'{text}' is no tyre size{_nearest(tidy)}", field="size")


def looks_like_size(text: object) -> bool:
    """Is a text meant as a size, right or wrong? Names of cards begin with a letter or have no such signs.

    >>> looks_like_size("205/60R15"), looks_like_size("22x5.5 8PR"), looks_like_size("nasa-22x5.5-8pr")
    (True, True, False)
    """
    if not isinstance(text, str) or text.lower().endswith(".toml"):
        return False
    usual = r"\s*(?:P|LT|[BCH])?\s?\d+(?:[.,]\d+)?\s?(?:/\s?\d|[x×X]\s?\d|Z?R\s?\d)"
    other = r"\s*(?:[A-Z]{1,2}\s?\d{3}/\d\d|\d+\.\d\d\s?-\s?\d)"
    return bool(re.match(f"(?:{usual}|{other})", text, re.IGNORECASE))


def _series_of_race_tyre(width: float, outside: float, rim: float) -> int | None:
    """The series to the next five per cent, if a number is an outer diameter, mm; width in mm, rim in inches."""
    series = 100 * (outside - rim * INCH / MM) / 2 / width
    return 5 * round(series / 5) if outside > 100 and 20 <= series <= 100 else None


def _width_of_cars(width: str) -> str:
    """The width of three digits in the same ten, mm, that ends in 5."""
    return str(max(int(width) // 10 * 10 + 5, 105))


def _metric(text: str, match: re.Match[str]) -> TyreSize:
    build, rim, series = match["build"].upper(), float(match["rim"]), float(match["series"])
    of_race = _series_of_race_tyre(float(match["width"]), series, rim)
    if of_race is not None:
        metric = f"{_width_of_cars(match['width'])}/{of_race}R{match['rim']}"
        raise InputError(
            f"'{text}' gives the outer diameter, {series:g} mm, as race tyres do, where the series belongs; write "
            f"{metric} with parameters = {{ outer_diameter = '{series:g} mm' }} (new section, new study: --set)",
            field="size",
        )
    if build != "R":
        raise InputError(
            f"'{text}' is a bias-ply road tyre, which has no rules here; radials are written "
            f"{text.replace(match['build'], 'R', 1)}",
            field="size",
        )
    if not 20 <= series <= 100:
        raise InputError(
            f"'{text}' has the series {series:g}; allowed: 20 to 100 (section height in % of the width)", field="size"
        )
    light = (match["service"] or "").upper() == "LT"
    kind = "passenger"
    if rim % 1:
        kind = "truck"
    elif light or (match["letter"] or "").upper() == "C":
        kind = "light-truck"
    if match["letter"] and not light and (kind != "light-truck" or "/" in match["slash"]):
        whole = f"LT{text.removeprefix(match['service'] or '').strip()}"
        raise InputError(f"'{text}': load ranges belong to light-truck sizes, which are written {whole}", field="size")
    if kind != "truck":
        _refuse_machines(text, match, kind)
    if kind == "passenger" and int(match["width"]) % 10 != 5:
        near = _width_of_cars(match["width"])
        raise InputError(
            f"'{text}' is no car size, whose widths end in 5, but one of motorcycles or machines, which have no rules "
            f"here; nearest: {text.replace(match['width'], near, 1)}",
            field="size",
        )
    width = float(match["width"]) * MM
    load_range = _load_range(text, match, "CDE") if light else None
    extra = kind == "passenger" and _EXTRA_LOAD.search(text) is not None
    load, plies = _load(match), _plies(match)
    return TyreSize(_tidy(text), kind, width, series / 100, rim * INCH, None, load, plies, load_range, extra)


def _refuse_machines(text: str, match: re.Match[str], kind: str) -> None:
    """Refuse what is written as a car's size but is of trucks, tractors or machines: 365/80R20, 520/85R42."""
    width, rim = float(match["width"]) * MM, float(match["rim"]) * INCH
    height = width * float(match["series"]) / 100
    litres, kilograms = LARGEST[kind]
    load, symbol = _load(match), (match["symbol"] or "-").upper()
    if load is not None and load > kilograms * GRAVITY:
        reason = f"load index {match['index']} is {load / GRAVITY:.0f} kg; allowed: at most {kilograms:g} kg"
    elif kind == "passenger" and symbol in SLOW:
        reason = f"speed symbol {symbol}; allowed: those above 110 km/h, from L on"
    elif width * height * (rim + height) * 1e3 > litres:
        reason = (
            f"width x height x mean diameter is {width * height * (rim + height) * 1e3:.0f} l; allowed: at most "
            f"{litres:g} l"
        )
    else:
        return
    name = "car" if kind == "passenger" else "light-truck"
    raise InputError(
        f"'{text}' is no {name} size ({reason}) but one of trucks, tractors or machines on flat rims, which have no "
        "rules here; truck sizes are for 15 deg rims (diameters in half inches), such as 11R22.5 or 295/80R22.5",
        field="size",
    )


def _is_flotation(match: re.Match[str]) -> bool:
    """Is a size diameter x width - rim one of a light truck? Without LT, load range or load index see
    `LEAST_FLOTATION`."""
    if match["service"] or match["light"] or match["letter"] or match["index"]:
        return True
    width, rim, plies = match["width"], float(match["rim"]), _plies(match)
    half = width.endswith(".50") or (width.endswith(".5") and match["build"].upper() == "R")
    road = float(width) >= LEAST_FLOTATION[0] and rim >= LEAST_FLOTATION[1] and rim % 1 == 0
    return half and road and (plies is None or plies in LOAD_RANGES)


def _flotation(text: str, match: re.Match[str]) -> TyreSize:
    outside, width, rim = (float(match[name]) for name in ("outside", "width", "rim"))
    if match["build"].upper() != "R":
        plain = f"{match['outside']}x{match['width']}"
        aircraft = f"; an aircraft tyre is written {match['outside']}x{width:g}-{match['rim']}"
        light = match["service"] or match["light"] or match["letter"] or match["index"]
        raise InputError(
            f"'{text}' is a bias-ply light-truck size, which has no rules here; radials are written "
            f"{plain}R{match['rim']}LT{'' if light else aircraft}",
            field="size",
        )
    if rim % 1:
        raise InputError(
            f"'{text}' is for 15 deg rims of {rim:g} in, which have no rules here; nearest: "
            f"{match['outside']}x{match['width']}R{rim + 0.5:g}LT",
            field="size",
        )
    height = (outside * INCH - BELOW_NOMINAL - rim * INCH) / 2
    series = height / (width * INCH)
    if not 0.2 <= series <= 1.1:
        raise InputError(
            f"'{text}' is no light-truck size: its outside diameter, width and rim diameter do not go together"
            "; allowed: diameter x width R rim LT, in inches, such as 31x10.50R15LT",
            field="size",
        )
    load_range = _load_range(text, match, "CDE" if width * INCH <= NARROW + 1e-6 else "CDEF")
    return TyreSize(
        _tidy(text),
        "light-truck",
        width * INCH,
        series,
        rim * INCH,
        outside * INCH,
        _load(match),
        _plies(match),
        load_range,
    )


def _load_range(text: str, match: re.Match[str], allowed: str) -> str | None:
    """The load range of a light-truck size, by its letter or its ply rating."""
    plies = _plies(match)
    letter = (match["letter"] or "").upper() or (None if plies is None else LOAD_RANGES.get(plies, f"of {plies}PR"))
    if letter is not None and letter not in allowed:
        ratings = ", ".join(f"{x} ({n}PR)" for n, x in LOAD_RANGES.items() if x in allowed)
        raise InputError(f"'{text}' has the load range {letter}; allowed: {ratings}", field="size")
    return letter


def _aircraft(text: str, match: re.Match[str]) -> TyreSize:
    outside, width = float(match["outside"]), float(match["width"])
    unit = MM if outside > 100 else INCH
    rim = float(match["rim"]) * INCH if match["rim"] else None
    kind = "aircraft-radial" if (match["build"] or "").upper() == "R" else "aircraft-bias"
    if not (1.2 * width < outside < 8 * width and (rim is None or 0.2 * outside * unit < rim < 0.85 * outside * unit)):
        raise InputError(
            f"'{text}' is no aircraft size: its outside diameter, width and rim diameter do not go together"
            "; allowed: diameter x width, or diameter x width - rim (R for radials), in inches, such as 22x5.5-12",
            field="size",
        )
    return TyreSize(_tidy(text), kind, width * unit, None, rim, outside * unit, None, _plies(match))


def _tubeless(match: re.Match[str]) -> str:
    """The size for a 15 degree rim that replaces one for a flat rim, as a message says it."""
    rim, widths = TUBELESS.get(match["rim"], ("", ()))
    width = float(match["width"])
    return f"; {int(width) + 1}R{rim} replaces this one" if width in widths else ""


def _tidy(text: str) -> str:
    return re.sub(r"(?<=\d)\s?[x×X]\s?(?=\d)", "x", text)


def _plies(match: re.Match[str]) -> int | None:
    """The ply rating of a size; None without one."""
    if not match["plies"]:
        return None
    low, high = PLY_RATINGS
    if not low <= int(match["plies"]) <= high:
        raise InputError(f"'{match[0]}' has the ply rating {match['plies']}; allowed: {low} to {high}", field="size")
    return int(match["plies"])


def _load(match: re.Match[str]) -> float | None:
    return load_of_index(int(match["index"])) if match["index"] else None


def _listed() -> str:
    return ", ".join(EXAMPLES[:-1]) + " or " + EXAMPLES[-1]


def _nearest(text: str) -> str:
    """The nearest valid form: the text's own numbers put as a size is written, with what stands before and after."""
    numbers = list(re.finditer(r"\d+(?:\.\d+)?", text))
    values = [number[0] for number in numbers]
    attempts = []
    if len(values) >= 3:
        a, b, c = values[:3]
        attempts = [f"{a}/{b}R{c}", f"{a}x{b}-{c}"]
    elif len(values) == 2:
        attempts = [f"{values[0]}x{values[1]}", f"{values[0]}R{values[1]}"]
    if "x" in text.lower():
        attempts.reverse()
    before = text[: numbers[0].start()].strip().upper() if numbers else ""
    after = text[numbers[min(len(numbers), 3) - 1].end() :] if numbers else ""
    rewritten = [
        text.replace(",", "."),
        re.sub(r"^(\d{2}5)\s?R\s?(?=\d{2}\D|\d{2}$)", r"\1/80R", text, flags=re.IGNORECASE),
        re.sub(r"^(\d{3}/\d{2,3}Z?R\d{2})\s?LT", r"LT\1", text, flags=re.IGNORECASE),
    ]
    pieces = [
        whole
        for plain in attempts
        for whole in (f"{before}{plain}{after}", f"{before}{plain}", f"{plain}{after}", plain)
    ]
    for attempt in rewritten + pieces:
        if not any(form.fullmatch(attempt) for form in (_METRIC, _TRUCK, _FLOTATION, _AIRCRAFT)):
            continue
        try:
            parse_size(attempt)
        except InputError:
            continue
        return f"; did you mean '{attempt}'? Allowed are sizes like {_listed()}"
    return f"; allowed are sizes like {_listed()}"
