"""A draft effect: the law of the missing heat as a Python file that runs as an effect of a user's folder."""

from __future__ import annotations

import datetime
import math
import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from tyrefem.diagnose.heat.courses import BEGINS, ENDS, PHASE, RUN
from tyrefem.diagnose.law.places import EVERYWHERE, FILM, FLUX, HEAT, LOSS, UNITS, WHOLE_SURFACES, LawPlace
from tyrefem.diagnose.law.terms import (
    ABOVE,
    DEFLECTION,
    LEAST_ABOVE,
    LOAD,
    PRESSURE,
    REST,
    ROLLING,
    SLOWEST,
    SPEED,
    WARM,
)
from tyrefem.diagnose.numbers import time_with_sd, with_sd
from tyrefem.diagnose.unknowns.heat_patches import ALL_LAYERS, SURFACES, place_of
from tyrefem.diagnose.unknowns.unknown import Unknown
from tyrefem.diagnose.words.law import law_formula, law_place_words
from tyrefem.effects import catalogue
from tyrefem.effects.missing_flux import BOUNDARIES

if TYPE_CHECKING:
    from tyrefem.diagnose.diagnosis import DiagnosisData
    from tyrefem.diagnose.law.heat_law import Exponent, PlaceLaw

#: Folder of the draft effects, beside the record.
EFFECTS = "effects"
#: Least prior sd of an exponent, and of a rate of temperature (1/K), in a draft; range about the start, in prior sd.
LEAST_SD, LEAST_RATE_SD, RANGE = 0.1, 0.002, 8.0
#: Term -> name of the parameter, meaning.
PARAMETERS: Mapping[str, tuple[str, str]] = {
    SPEED: ("speed_exponent", "exponent of speed"),
    LOAD: ("load_exponent", "exponent of load"),
    PRESSURE: ("pressure_exponent", "exponent of pressure"),
    DEFLECTION: ("deflection_exponent", "exponent of deflection"),
    WARM: ("temperature_rate", "rate of change with temperature"),
    ABOVE: ("above_ambient_exponent", "exponent of the temperature above ambient"),
}
_CASE = "tyre.schedule.mean(lambda case: case.{0}, t)"
#: Term -> its factor; {0}: the reference.
FACTORS: Mapping[str, str] = {
    SPEED: f"(max(tyre.speed(t), {SLOWEST}) / {{0}}) ** self.speed_exponent",
    LOAD: f"({_CASE.format('load')} / {{0}}) ** self.load_exponent",
    PRESSURE: f"({_CASE.format('pressure')} / {{0}}) ** self.pressure_exponent",
    DEFLECTION: f"({_CASE.format('deflection')} / {{0}}) ** self.deflection_exponent",
    WARM: "np.exp(self.temperature_rate * (np.clip(T, -50.0, 250.0) - {0}))",
    ABOVE: f"(np.maximum(T - tyre.ambient(t), {LEAST_ABOVE}) / {{0}}) ** self.above_ambient_exponent",
}
#: Kind of place -> family, name and meaning of the amplitude.
AMPLITUDES: Mapping[str, tuple[str, str, str]] = {
    HEAT: ("heat", "heat", "heat at the station, at the references"),
    FLUX: ("boundary", "into", "flux at its station, or on the whole surface, at the references"),
    LOSS: ("heat", "gain", "share of the model's heat, at the references"),
    FILM: ("boundary", "gain", "share of the film, at the references"),
}


def draft_effects(d: DiagnosisData) -> dict[str, str]:
    """File name -> Python source of the draft effect; empty where no law of the missing heat holds."""
    if d.law is None or not d.law.holds:
        return {}
    name = draft_name(d.law.place)
    return {f"{name.replace('-', '_')}.py": draft_source(d, name)}


def draft_name(place: LawPlace) -> str:
    """Name of the draft effect, which no effect of the catalogue has: "inferred-heat-95-mm"."""
    where = f"{place.station * 1e3:.0f}-mm" if math.isfinite(place.station) else re.sub(r"[^a-z0-9]+", "-", place.where)
    base = name = f"inferred-{place.kind}-{where.strip('-')}"
    number = 1
    while name in catalogue():
        number += 1
        name = f"{base}-{number}"
    return name


def draft_source(d: DiagnosisData, name: str) -> str:
    """Python source of the draft effect: its law, amplitude with standard deviation, and what it was inferred from.

    The amplitude is unknown again (prior sd: its size); exponents are shape parameters about their values here.
    """
    assert d.law is not None
    heat, law, place = d.law, d.law.law, d.law.place
    family, amplitude, meaning = AMPLITUDES[place.kind]
    unit = UNITS[place.kind]
    size = float(f"{abs(law.amplitude):.3g}")
    low, high = (0.0, 50 * size) if law.amplitude > 0 else (-50 * size, 0.0)
    if unit == "1":
        low = max(low, -0.95)
    where = law_place_words(d, place)
    exponents = [law.exponent[term] for term in law.fit.terms]
    fitted = [Path(entry.table).name for entry in d.original.measured if not entry.hold_out]
    tables = ", ".join(dict.fromkeys(fitted)) or ", ".join(heat.basis.grid.names)
    today = datetime.datetime.now(tz=datetime.UTC).date().isoformat()
    numbers = [f"{with_sd(law.amplitude, law.sd)} {'' if unit == '1' else unit}".rstrip()]
    numbers += [f"{PARAMETERS[e.name][1]} {with_sd(e.mean, e.sd)}" for e in exponents]
    if math.isfinite(law.time):
        numbers.append(f"switch at {time_with_sd(law.time, law.time_sd)}")
    listed = "; ".join(numbers).replace("±", "+-")
    source = f"inferred from {d.original.name}, tables {tables}, {today}: {listed}"
    formula = law_formula(law).replace("×", "x").replace("±", "+-").replace("°", "deg").replace("·", " ")
    sign = "Heat is missing" if law.amplitude > 0 else "Cooling is missing"
    words = f"{sign} {where}, by an unknown cause.".replace("Cooling is missing a share", "Too large is a share")
    words = words.replace("Heat is missing a share", "Too small is a share")
    parts = [
        f'"""Draft effect: {where}; {formula}.\n\n',
        _wrapped(f"{source[0].upper()}{source[1:]}."),
        "\n\nRename it, give it a physical cause and a source, and judge it by runs that were not fitted.\n",
        '"""\n\nfrom typing import Annotated, ClassVar\n\nimport numpy as np\n\n',
        "from tyrefem.effects import Effect, Prior\n\n\n",
        f"class {_class_name(name)}(Effect):\n",
        f'    """{words}"""\n\n',
        f'    name: ClassVar[str] = "{name}"\n    family: ClassVar[str] = "{family}"\n',
        f'    sentence: ClassVar[str] = "{words}"\n',
        f"    source: ClassVar[str] = {_literal(source)}\n",
        *_flags(law, place),
        "\n",
        f'    {amplitude}: Annotated[float, Prior("{unit}", "{meaning}", {size!r}, {low!r}, {high!r})] = 0.0\n',
        *(_shape(entry) for entry in exponents),
        "\n",
        _law_method(law, place),
        "\n",
        _port(place, amplitude),
    ]
    return "".join(parts)


def _shape(entry: Exponent) -> str:
    parameter, meaning = PARAMETERS[entry.name]
    rate = entry.name == WARM
    sd = max(float(f"{entry.sd:.2g}"), LEAST_RATE_SD if rate else LEAST_SD)
    start = round(entry.mean, 5 if rate else 3)
    unit = "1/delta_degC" if rate else "1"
    limits = f"{round(start - RANGE * sd, 5)!r}, {round(start + RANGE * sd, 5)!r}"
    prior = f'Prior("{unit}", "{meaning}", {sd!r}, {limits}, start={start!r}, amplitude=False)'
    return f"    {parameter}: Annotated[float, {prior}] = {start!r}\n"


def _flags(law: PlaceLaw, place: LawPlace) -> list[str]:
    kind = law.fit.switch.kind
    flags = []
    if kind.startswith(RUN):
        flags.append("    of_the_day: ClassVar[bool] = True\n")
    if place.kind == FILM and not math.isfinite(law.time):
        flags.append("    of_drive: ClassVar[bool] = True\n")
    if math.isfinite(law.time):
        flags.append(f"    jumps: ClassVar[tuple[float, ...]] = ({round(law.time, 1)!r},)\n")
    if place.kind == FLUX:
        flags.append(
            f"    surfaces: ClassVar[tuple[str, ...]] = {BOUNDARIES[{**SURFACES, **WHOLE_SURFACES}[place.where]]!r}\n"
        )
    return flags


def _law_method(law: PlaceLaw, place: LawPlace) -> str:
    """The law over its amplitude."""
    kind = law.fit.switch.kind
    off = ["tyre.speed(t) == 0"] if place.inside or kind == ROLLING else ["tyre.speed(t) > 0"] if kind == REST else []
    if kind.endswith(BEGINS) and not kind.startswith(PHASE):
        off.append(f"t < {round(law.time, 1)!r}")
    if kind == ENDS:
        off.append(f"t >= {round(law.time, 1)!r}")
    if kind.startswith(PHASE):
        off.append(f"tyre.drive.phases[tyre.drive.locate(t)[0]].name != {kind.removeprefix(PHASE)!r}")
    lines = [
        "    def law(self, tyre, t, T=None):\n",
        '        """The law over its amplitude, at time t (s) and temperatures T (degC)."""\n',
    ]
    if off:
        lines += [f"        if {' or '.join(off)}:\n", "            return 0.0\n"]
    lines.append("        strength = 1.0\n")
    for term in law.fit.terms:
        reference = float(f"{law.terms.references[term]:.5g}")
        lines.append(f"        strength = strength * {FACTORS[term].format(repr(reference))}\n")
    lines.append("        return strength\n")
    return "".join(lines)


def _port(place: LawPlace, amplitude: str) -> str:
    """The port where the effect acts."""
    choice = dict(place.unknown.choice)
    shape = "np.exp(-(((s - {0}) / {1}) ** 2) / 2)"
    if place.where in WHOLE_SURFACES:
        return (
            "    def flux(self, tyre, surface, x, t):\n"
            '        """W/m2, the same on the whole surface."""\n'
            f"        return self.{amplitude} * self.law(tyre, t)\n"
        )
    if place.kind == FLUX:
        shape = shape.format(*(choice[key].split()[0] for key in ("station", "width")))
    if place.kind == HEAT:
        return "".join([
            "    def heat_addend(self, tyre, zone, x, t, T):\n",
            '        """W/m3 at points x (2, n)."""\n',
            "        s, _ = tyre.places(x)\n        shape = np.zeros_like(s)\n",
            *(_patch(unknown, share) for unknown, share in place.parts or ((place.unknown, 1.0),)),
            f"        return self.{amplitude} * self.law(tyre, t, T) * shape\n",
        ])  # fmt: skip
    if place.kind == FLUX:
        return (
            "    def flux(self, tyre, surface, x, t):\n"
            '        """W/m2 at points x (2, n)."""\n'
            "        s, _ = tyre.places(x)\n"
            f"        return self.{amplitude} * self.law(tyre, t) * {shape}\n"
        )
    if place.kind == LOSS:
        only = "" if place.where == EVERYWHERE else (
            f"        if tyre.region(zone) != {place.where!r}:\n            return 1.0\n"
        )  # fmt: skip
        return (
            "    def heat_factor(self, tyre, zone, x, t, T):\n"
            '        """1 + gain x law."""\n'
            f"{only}        return np.maximum(1 + self.{amplitude} * self.law(tyre, t, T), 0.0)\n"
        )
    return (
        "    def film_factor(self, tyre, film, t):\n"
        '        """1 + gain x law on one film."""\n'
        f"        if film != {place.where!r}:\n            return 1.0\n"
        f"        return max(1 + self.{amplitude} * float(self.law(tyre, t)), 0.05)\n"
    )


def _patch(unknown: Unknown, share: float) -> str:
    """The shape of the heat about one station."""
    station, where = place_of(unknown)
    width = dict(unknown.choice)["width"].split()[0]
    line = f"shape = shape + {share:.4g} * np.exp(-(((s - {station!r}) / {width}) ** 2) / 2)\n"
    if where == ALL_LAYERS:
        return f"        {line}"
    return f"        if tyre.region(zone) == {where!r}:\n            {line}"


def _class_name(name: str) -> str:
    return "".join(part.capitalize() for part in name.split("-"))


def _wrapped(text: str, width: int = 110) -> str:
    import textwrap

    return "\n".join(textwrap.wrap(text, width, break_long_words=False))


def _literal(text: str) -> str:
    return '"' + text.replace("\\", "/").replace('"', "'") + '"'
