"""Heat of unknown origin in sentences: missing heat or missing cooling, its place, its amount, its course in time."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from tyrefem.diagnose.heat.courses import BEGINS, CONSTANT, ENDS, FREE, GROWS, PHASE, RUN, SPEED
from tyrefem.diagnose.heat.sources import CLEAR, STATED, UnknownSource
from tyrefem.diagnose.numbers import amount, percent, run_words
from tyrefem.diagnose.unknowns.heat_patches import ALL_LAYERS, OUTER, SURFACES
from tyrefem.geometry.place_names import place

if TYPE_CHECKING:
    from tyrefem.diagnose.diagnosis import DiagnosisData
    from tyrefem.diagnose.heat.over_time import HeatOverTime

#: Sentence if no amount is clear.
NOT_CLEAR = "No place of missing heat is clear: none differs from zero by more than two standard deviations"


def heat_words(d: DiagnosisData) -> str:
    """Heat of unknown origin in a few sentences, without the last full stop."""
    over_time = d.missing.over_time
    if over_time is None:
        return _without_course(d)
    if not over_time.clear:
        return NOT_CLEAR
    return ". ".join(source_words(d, source, over_time) for source in over_time.clear)


def source_words(d: DiagnosisData, source: UnknownSource, over_time: HeatOverTime) -> str:
    """A source in one to three sentences: sign, place and amount; then what the data do not tell; then the course."""
    when = "" if source.at else ", while the tyre rolls" if source.inside else ", also at rest"
    first = f"{_sign(source.amount)} {source_place(d, source)}: {source_amount(source)}{when}"
    moved = [f"It {source.move.words}"] if source.move is not None else []
    return ". ".join([first, *moved, *_depth_doubt(source, over_time), course_words(source)])


def source_amount(source: UnknownSource) -> str:
    """The amount of a source with its standard deviation; of a free course with run and time, if clear only then."""
    size = amount(source.amount, source.sd, "W/m**3" if source.inside else "W/m**2")
    return size if source.at is None else f"{size} ({run_words(source.at[0])} at {source.at[1]:.0f} s)"


def source_place(d: DiagnosisData, source: UnknownSource) -> str:
    """The place of a source; a layer or a surface only where the data tell it from the others."""
    station = station_words(d, source.station)
    if not is_told(source):
        return station
    if source.where in SURFACES:
        surface = "at the rim" if source.where == "rim" else f"at the {source.where}"
        return f"{surface}, {station}"
    layer = source.where if source.where != ALL_LAYERS and source.depths[source.where] >= STATED else ""
    return f"{station}, in the {layer}" if layer else f"{station}, {ALL_LAYERS}"


def station_words(d: DiagnosisData, station: float) -> str:
    """A station of the meridian, with its part of the tyre."""
    section = d.original.section
    total = float(section.total_thickness([station])[0])
    return f"{place(section, station, total / 2).split(',')[0]} (s = {station * 1e3:.0f} mm along the meridian)"


def is_told(source: UnknownSource) -> bool:
    """Whether the data tell heat inside from a flux through one of the surfaces."""
    return inside_share(source) >= STATED or any(source.depths.get(name, 0.0) >= STATED for name in SURFACES)


def inside_share(source: UnknownSource) -> float:
    """Probability that the heat is inside the rubber, in any layers."""
    return sum(share for where, share in source.depths.items() if where not in SURFACES)


def course_words(source: UnknownSource) -> str:
    """The course in time, if the data tell it; else the courses that remain."""
    likely = [kind for kind, share in source.kinds.items() if share >= 1 - STATED]
    if source.kinds[source.kind] >= STATED:
        return f"It {_course(source, source.kind)}"
    ranked = [f"{_course(source, kind, timed=False)} ({percent(source.kinds[kind])})" for kind in likely]
    if not ranked:
        return "These data do not tell its course in time"
    if len(ranked) == 1:
        return f"Probably it {ranked[0]}"
    return f"These data do not tell its course in time: it {', or it '.join(ranked)}"


def _sign(value: float) -> str:
    return "Heat is missing" if value > 0 else "The model has too much heat, cooling is missing,"


def _course(source: UnknownSource, kind: str, *, timed: bool = True) -> str:
    size = 10.0 ** math.floor(math.log10(source.time_sd)) if timed and source.time_sd > 0 else 1.0
    size = min(size, 10.0)
    time = f"{round(source.time / size) * size:.0f} ± {math.ceil(source.time_sd / size) * size:.0f} s" if (
        timed and math.isfinite(source.time)
    ) else ""  # fmt: skip
    switch = f" at {time}" if time else ""
    if kind.startswith(PHASE):
        return f"acts in the phase {kind.removeprefix(PHASE)} only"
    if kind.startswith(RUN):
        name, begins = kind.removeprefix(RUN), kind.endswith(f" {BEGINS}")
        return f"acts in {name.removesuffix(f' {BEGINS}')} only" + (f" and begins{switch}" if begins else "")
    return {
        CONSTANT: "is constant in time",
        SPEED: "is in proportion to the speed",
        BEGINS: f"begins{switch}",
        ENDS: f"ends{switch}",
        GROWS: "grows evenly" + (f" from {time} on" if time else ""),
        FREE: "changes over time (picture missing-heat-course.png)",
    }[kind]


def _depth_doubt(source: UnknownSource, over_time: HeatOverTime) -> list[str]:
    if is_told(source):
        return []
    options = {"inside": inside_share(source)} | {name: source.depths.get(name, 0.0) for name in SURFACES}
    likely = sorted((item for item in options.items() if item[1] >= 1 - STATED), key=lambda item: -item[1])
    names = ", ".join(f"{name} {percent(share)}" for name, share in likely)
    why = "" if over_time.cools else ", as no run cools at rest"
    return [f"These data do not tell heat inside from a flux through a surface{why}: {names}"]


def _without_course(d: DiagnosisData) -> str:
    missing = d.missing
    inside = missing.kind == "heat"
    mean, spread = (missing.heat, missing.heat_sd) if inside else (missing.flux, missing.flux_sd)
    at = int(np.abs(missing.stations - missing.station).argmin())
    value, sd = float(mean[:, at].mean()), float(spread[:, at].mean())
    if abs(value) <= CLEAR * sd:
        return NOT_CLEAR
    size = amount(value, sd, "W/m**3" if inside else "W/m**2")
    station = station_words(d, missing.station)
    if inside:
        return f"{_sign(value)} {station}, {ALL_LAYERS}: {size}, while the tyre rolls"
    return f"{_sign(value)} at the {OUTER}, {station}: {size}, also at rest"
