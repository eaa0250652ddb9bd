"""The plies' line of a radial: its bend at the rim's flange, and the belts' share of the pressure."""

from __future__ import annotations

from dataclasses import replace

from tyrefem.errors import InputError
from tyrefem.sizes.pressed_bead import bend_radius
from tyrefem.sizes.radial import Radial
from tyrefem.sizes.rules import Rules

#: Range of a ``belt_power`` that is solved for: from a parabola, as the inflated 295/80R22.5 has it.
LEAST_POWER, MOST_POWER = 2.0, 5.0
#: A given crown radius that is as near as this to the one of a given ``belt_power`` is that one, as files write it.
SAME_RADIUS = 1e-3


def with_line(radial: Radial, bead_modulus: tuple[float, str] | None = None) -> Radial:
    """The radial with the rules of its line: `bend_radius`, and `with_belt_share`.

    Material outside of the plies lies evenly round the flange; with the ``bead_modulus`` of a kind, Pa and source, it
    does so in the inflated tyre (`tyrefem.sizes.pressed_bead`).
    """
    even = radial.n("flange_radius") + radial.bead_outside
    if bead_modulus is None:
        source = (
            "flange_radius and what lies outside of the plies at the bead: the plies bend about the flange's centre"
        )
        radial.rules("bend_radius", even, "mm", source, 3e-3)
        return with_belt_share(radial)
    # A crown radius that is given with its belt power belongs to the line before inflation.
    others = {"bend_radius", *(["crown_radius"] if "belt_power" in radial.rules.given else [])}
    given = {name: value for name, value in radial.rules.given.items() if name not in others}
    rules = Rules(given, dict(radial.rules.numbers))
    rules("bend_radius", even, "mm", "")
    inflated = with_belt_share(replace(radial, rules=rules)).line
    bend_radius(radial.rules, inflated, radial.n("rated_pressure"), bead_modulus)
    return with_belt_share(radial)


def with_belt_share(radial: Radial) -> Radial:
    """The radial, or with a ``belt_power``, given or of its kind, the one whose belts carry that share of the
    pressure up to the edge of the widest; `crown_radius` is then solved for.

    An arc is drawn where ``crown_radius`` is given, or no line has its kind's ``belt_power``.

    Raises
    ------
    InputError : both are given and do not agree; no line has the given ``belt_power``.
    """
    rules = radial.rules
    given, flatness = "belt_power" in rules.given, "crown_radius" in rules.given
    if not (given or (radial.belt_power[1] and not flatness)):
        return radial
    power, words = radial.belt_power
    if power is None and not given:
        power = _power_of_crown_radius(radial)
    rules("belt_power", power or LEAST_POWER, "1", words, 1.0, 20.0)
    try:
        belted = _belted(radial)
        radius = belted.line.crown_radius
    except InputError:
        if given:
            raise
        del rules.numbers["belt_power"]
        return radial
    if flatness and abs(radial.n("crown_radius") / radius - 1) > SAME_RADIUS:
        raise InputError("is solved for where belt_power is given: give one of them", field="parameters.crown_radius")
    source = "solved for: the belts' share of the pressure falls with belt_power to the edge of the widest belt"
    rules("crown_radius", radius, "mm", source)
    return belted


def _power_of_crown_radius(radial: Radial) -> float:
    """The ``belt_power``, to a hundredth, with which the crown is as flat as the rule of ``crown_radius``.

    The larger it is, the rounder the crown; too small a one has no line.
    """
    low, high = LEAST_POWER, MOST_POWER
    if _is_rounder(radial, low):
        return low
    while high - low > 5e-3:
        middle = (low + high) / 2
        low, high = (low, middle) if _is_rounder(radial, middle) else (middle, high)
    return round(high, 2)


def _is_rounder(radial: Radial, power: float) -> bool:
    """Whether the crown with a ``belt_power`` is rounder than by ``crown_radius``."""
    numbers = Rules(radial.rules.given, dict(radial.rules.numbers))
    numbers("belt_power", power, "1", "")
    try:
        return bool(_belted(replace(radial, rules=numbers)).line.crown_radius <= radial.n("crown_radius"))
    except InputError:
        return False


def _belted(radial: Radial) -> Radial:
    """The radial with the belts' share up to the edge of the widest belt."""
    widths = [radial.n(belt.width) for belt in radial.belts if belt.width in radial.rules.numbers]
    share_end = max(widths, default=0.0) / 2 or radial.tread.edge
    belted = replace(radial, share_end=share_end)
    # A belt without a width yet gets that of the tread, whose edge moves with the line.
    for _ in range(0 if widths else 30):
        share_end, before = belted.tread.edge, share_end
        belted = replace(radial, share_end=share_end)
        if abs(share_end - before) < 1e-8:
            break
    return belted
