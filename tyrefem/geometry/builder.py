"""From a section's card to the section: solves for dimensions that the card gives indirectly."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from tyrefem.errors import InputError, nearest
from tyrefem.geometry.card import LayerCard, PartCard, SectionCard
from tyrefem.geometry.layer import Division, Layer, Profile, Rating
from tyrefem.geometry.layup import Layup
from tyrefem.geometry.meridian import Line, TwoArcs
from tyrefem.geometry.section import GROOVE, Section
from tyrefem.geometry.spline import SplineLine
from tyrefem.geometry.tread_pattern import TreadPattern
from tyrefem.library import load as load_card


def load(reference: object, *, near: Path | None = None, half: bool = True) -> Section:
    """The section of a name, a path, or a table ``{base = NAME, parameters = {...}}``.

    Raises
    ------
    InputError : no such section, a bad field, or a section that cannot be built; with file and field.

    >>> section = load({"base": "nasa-22x5.5-8pr", "parameters": {"crown_radius": "3.6 in"}})
    >>> round(section.line.crown_radius, 5)
    0.09144
    """
    return load_written(reference, near=near, half=half)[0]


#: A section's card as read, with changes; its file; its name.
WrittenSection = tuple[dict[str, Any], Path, str]


def load_written(reference: object, *, near: Path | None = None, half: bool = True) -> tuple[Section, WrittenSection]:
    """`load`, with the card's data as read, its file and its name."""
    data, path, name = load_card("section", reference, near)
    card = SectionCard.check(data, file=path)
    try:
        _check_nominal_width(reference, card, near)
        return build(card, name=name, half=half), (data, path, name)
    except InputError as error:
        raise error.within(file=path) from None


def section_of(written: WrittenSection, *, half: bool = True) -> Section:
    """The section of a card's data, as `load_written` gives them."""
    data, path, name = written
    try:
        return build(SectionCard.check(data, file=path), name=name, half=half)
    except InputError as error:
        raise error if error.file else error.within(file=path) from None


def _check_nominal_width(reference: object, card: SectionCard, near: Path | None) -> None:
    """Raise `InputError` for a changed nominal width if the width of the card's section does not depend on it."""
    parameters = card.parameters
    changes = reference if isinstance(reference, Mapping) else {}
    if "nominal_width" not in changes.get("parameters", {}) or "line" in changes:
        return
    if card.line.form == "two-arcs" and parameters.overall_width is None:
        return
    if "overall_width" in changes["parameters"]:
        return
    before = SectionCard.check(load_card("section", changes["base"], near)[0])
    if not math.isclose(parameters.nominal_width, before.parameters.nominal_width, rel_tol=1e-9):
        decides = "line.points" if card.line.form == "points" else "parameters.overall_width"
        raise InputError(
            f"names the tyre's size only: the section's width follows from {decides}; change that, or both",
            field="parameters.nominal_width",
        )


def build(card: SectionCard, *, name: str | None = None, half: bool = True) -> Section:
    """The section of a validated card."""
    if card.line.form == "points":
        return _on_points(card, name or card.title, half)
    return _on_two_arcs(card, name or card.title, half)


def _on_points(card: SectionCard, name: str, half: bool) -> Section:
    parameters = card.parameters
    assert card.line.points is not None
    assert parameters.shoulder_s is not None
    line, shift = SplineLine(card.line.points, parameters.shoulder_s), 0.0
    if parameters.outer_diameter is not None:
        # The points keep their shape; the whole line is shifted along r to give the diameter, and the rim with it.
        outside = Layup(_layers(card, line), card.line.reference).faces(0.0)[-1]
        shift = parameters.outer_diameter / 2 - float(outside) - card.line.points[0][0]
        line = SplineLine(tuple((r + shift, z) for r, z in card.line.points), parameters.shoulder_s)
    return _section(card, name, half, line, shift)


def _on_two_arcs(card: SectionCard, name: str, half: bool) -> Section:
    parameters = card.parameters
    assert parameters.crown_radius is not None
    assert parameters.sidewall_radius is not None
    assert parameters.meridian_length is not None
    arcs = (parameters.crown_radius, parameters.sidewall_radius)
    length = parameters.meridian_length

    def with_shoulder(x: float) -> Section:
        # The layers depend on lengths along the arcs only, so the arcs may first be drawn at any radius from the axis.
        line = TwoArcs(0.0, *arcs, x, length)
        outside = Layup(_layers(card, line), card.line.reference).faces(0.0)[-1]
        line = replace(line, crown_midline_radius=_crown_midline_radius(card, float(outside)))
        return _section(card, name, half, line)

    if parameters.overall_width is None:
        assert parameters.shoulder_fraction is not None
        return with_shoulder(parameters.shoulder_fraction * parameters.nominal_width / 2)
    return _with_width(parameters.overall_width, parameters.crown_radius, with_shoulder)


def _crown_midline_radius(card: SectionCard, outside: float) -> float:
    """y_m from the diameter; ``outside`` is the distance from the meridian to the tread surface at the crown."""
    given, diameter = card.parameters.crown_midline_radius, card.parameters.outer_diameter
    if given is None:
        assert diameter is not None
        if diameter / 2 <= outside:
            raise InputError("is less than the crown is thick", field="parameters.outer_diameter")
        return diameter / 2 - outside
    if diameter is not None and abs(diameter / 2 - outside - given) > 1e-6:
        raise InputError(
            f"disagrees with outer_diameter, which makes it {diameter / 2 - outside:.6g} m; change outer_diameter"
            f" to {2 * (given + outside):.6g} m, or give only one of the two",
            field="parameters.crown_midline_radius",
        )
    return given


def _with_width(width: float, crown_radius: float, with_shoulder: Callable[[float], Section]) -> Section:
    """The section with the shoulder position that gives the overall width."""
    from scipy.optimize import brentq

    reached: list[tuple[float, float]] = []
    reason = ""
    for x in np.linspace(0.02, 0.995, 40) * crown_radius:
        try:
            reached.append((float(x), with_shoulder(float(x)).overall_width))
        except InputError as error:
            reason = f" ({error.message})"
    for (x0, width0), (x1, width1) in pairwise(reached):
        if (width0 - width) * (width1 - width) <= 0:
            try:
                x = brentq(lambda x: with_shoulder(x).overall_width - width, x0, x1, xtol=1e-13)
            except InputError as error:
                raise InputError(error.message, field="parameters.overall_width") from None
            return with_shoulder(float(x))
    if not reached:
        raise InputError(f"no shoulder gives a possible section{reason}", field="parameters.overall_width")
    widths = [w for _, w in reached]
    raise InputError(
        f"{width:.6g} m cannot be reached by moving the shoulder: with these radii the section is between"
        f" {min(widths):.6g} m and {max(widths):.6g} m wide; change sidewall_radius or meridian_length as well",
        field="parameters.overall_width",
    )


def _section(card: SectionCard, name: str, half: bool, line: Line, shift: float = 0.0) -> Section:
    """The section on a line that lies ``shift`` [m] further out than the card's points."""
    rating = None
    if card.rating is not None:
        rating = Rating(**{key: value for key, value in card.rating if key != "source"})
    outer = _division(card.boundaries, _marks(card, line), line.length, "boundaries")
    section = Section(
        name=name,
        line=line,
        layers=_grooved(card, _layers(card, line), outer),
        reference=card.line.reference,
        outer=outer,
        rating=rating,
        nominal_width=card.parameters.nominal_width,
        inner_volume=card.parameters.inner_volume,
        half=half,
        flange_radius=card.parameters.flange_radius,
        flange_centre=_flange_centre(card, shift),
        wrap=card.wrap.region if card.wrap else None,
        pattern=TreadPattern(card.pattern.void, card.pattern.block_length) if card.pattern else None,
        groove_boundary=card.grooves.boundary if card.grooves else "outside_air",
    )
    try:
        _ = section.wrapping
    except InputError as error:
        raise error if error.field else error.within(field="wrap.region") from None
    _check_pattern(section)
    return section


def _check_pattern(section: Section) -> None:
    """Raise `InputError` if a pattern would cut more than a tread: its region lies elsewhere too."""
    if section.patterned is None:
        return
    region = section.patterned
    pieces = [piece for piece in section.pieces if piece.region == region]
    if any(piece.layer < len(section.layers) - 1 for piece in pieces):
        raise InputError(
            f"cuts the outermost layer, but its region '{region}' lies in other layers too; give these another region",
            field="pattern",
        )
    if max(piece.end for piece in pieces) > section.line.length - 1e-9:
        raise InputError(
            f"cuts the tread, but its region '{region}' goes on to the bead; let another region follow it",
            field="pattern",
        )


def _flange_centre(card: SectionCard, shift: float) -> tuple[float, float] | None:
    r, z = card.parameters.flange_r, card.parameters.flange_z
    return None if r is None or z is None else (r + shift, z)


def _grooved(card: SectionCard, layers: tuple[Layer, ...], outer: Division) -> tuple[Layer, ...]:
    """The layers with grooves cut out of the outermost one."""
    grooves = card.grooves
    if grooves is None or grooves.width == 0:
        return layers
    if grooves.boundary not in outer.names:
        hint = nearest(grooves.boundary, outer.names)
        raise InputError(f"no boundary '{grooves.boundary}'{hint}", field="grooves.boundary")
    *inner, tread = layers
    regions, road = tread.regions, outer.ends[0]
    for index, middle in enumerate(grooves.at):
        start, end = max(middle - grooves.width / 2, 0.0), middle + grooves.width / 2
        try:
            if end >= road:
                raise InputError(
                    f"ends {end:.4g} m from the crown, beyond '{outer.names[0]}', which ends at {road:.4g} m"
                )
            regions = regions.cut(start, end, GROOVE)
        except InputError as error:
            raise InputError(f"groove at {middle:.4g} m: {error.message}", field=f"grooves.at.{index}") from None
    return (*inner, replace(tread, regions=regions))


def _marks(card: SectionCard, line: Line) -> dict[str, float]:
    """Named stations along the meridian."""
    from_bead = {"bead_start": card.parameters.bead_length, "rim_start": card.parameters.rim_length}
    return {
        "shoulder": line.shoulder_s,
        **{mark: line.length - length for mark, length in from_bead.items() if length is not None},
    }


def _layers(card: SectionCard, line: Line) -> tuple[Layer, ...]:
    marks, layers = _marks(card, line), []
    for index, layer in enumerate(card.layers):
        field = f"layers.{index}"
        regions = _division(layer.regions, marks, line.length, f"{field}.regions")
        if GROOVE in regions.names:
            raise InputError(
                f"'{GROOVE}' is the name of what [grooves] cuts out of the outermost layer; take another one",
                field=f"{field}.regions",
            )
        profile = _profile(layer, regions, card.parameters.thickness_scale, line.length, field)
        layers.append(Layer(layer.name, profile, regions))
    return tuple(layers)


def _division(parts: tuple[PartCard, ...], marks: dict[str, float], length: float, field: str) -> Division:
    ends = []
    for index, part in enumerate(parts):
        here = f"{field}.{index}.to"
        last = index == len(parts) - 1
        if last and part.to is not None:
            raise InputError("the last part goes on to the end of the section: leave 'to' out", field=here)
        if not last and part.to is None:
            raise InputError("missing; every part but the last needs it", field=here)
        if isinstance(part.to, str) and part.to not in marks:
            needed = part.to.replace("_start", "_length")
            raise InputError(f"'{part.to}' needs parameters.{needed}", field=here)
        ends.append(length if part.to is None else _end(part, marks, length, here))
    try:
        return Division(tuple(part.name for part in parts), tuple(ends))
    except InputError as error:
        raise error.within(field=field) from None


def _end(part: PartCard, marks: dict[str, float], length: float, field: str) -> float:
    """End of a part [m]: a mark, a length from the crown, or (negative) a length from the bead."""
    if isinstance(part.to, str):
        return marks[part.to]
    assert part.to is not None
    end = part.to if part.to > 0 else length + part.to
    if not 0 < end < length:
        raise InputError(
            f"'{part.name}' ends {abs(part.to):.4g} m from the {'crown' if part.to > 0 else 'bead'}, beyond the"
            f" section, whose meridian is {length:.4g} m long",
            field=field,
        )
    return end


def _profile(layer: LayerCard, regions: Division, scale: Mapping[str, float], length: float, field: str) -> Profile:
    """The layer's thickness: the table stretched to the meridian, with every entry scaled by its region's factor."""
    stations = np.asarray(layer.s)
    if layer.stretch and stations[-1] > 0:
        stations = stations * (length / stations[-1])
    names = regions.at(stations)
    try:
        profile = Profile(tuple(stations.tolist()), layer.thickness, layer.interpolation)
        values = np.asarray(profile.values) * [scale.get(str(name), 1.0) for name in names]
        profile = replace(profile, values=tuple(values.tolist()))
    except InputError as error:
        raise error.within(field=f"{field}.thickness") from None
    if abs(stations[0]) > 1e-9 or stations[-1] < length - 1e-9:
        raise InputError(
            f"the table runs from {stations[0]:.4g} to {stations[-1]:.4g} m, but the section from 0 to {length:.4g} m",
            field=f"{field}.s",
        )
    return profile
