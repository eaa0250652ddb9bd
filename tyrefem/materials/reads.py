"""The data of material cards that each strain law reads: only these change its strain cycles."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from tyrefem.plugins.kind import is_ours, kind_of

if TYPE_CHECKING:
    from tyrefem.materials.card import MaterialCard

    Cards = Mapping[str, MaterialCard]

#: Tables of a card that only strain laws read.
STIFFNESS = ("shear_modulus", "youngs_modulus", "cord", "elasticity", "cords", "strain_dependence")
#: Tables of the cards that the arcs read, by region.
ARCS = {
    "carcass": ("shear_modulus", "cord"),
    "tread": ("shear_modulus",),
    "sidewall": ("shear_modulus",),
    "bead": ("youngs_modulus",),
}


def read_by_arcs(cards: Cards) -> dict[str, tuple[str, ...]]:
    """Plies and rubber of the report's five zones."""
    return {region: tables for region, tables in ARCS.items() if region in cards}


def read_by_elements(cards: Cards) -> dict[str, tuple[str, ...]]:
    """Compound and cords of every region, as in `tyrefem.mechanics.solid.tyre_body`; also tan delta if cords lose
    energy.
    """
    fields: dict[str, list[str]] = {region: [] for region in cards}
    for region, card in cards.items():
        if card.elasticity is not None:
            fields[region].append("elasticity")
        elif card.shear_modulus is not None:
            fields[region].append("shear_modulus")
        elif "carcass" in fields:
            fields["carcass"].append("shear_modulus")
        if card.cords is not None:
            fields[region].append("cords")
            if card.cords.loss_tangent:
                fields[region].append("loss_tangent")
        elif card.cord is not None and card.cord.ply_shear_modulus is not None:
            fields[region].append("cord")
        elif region == "bead" and card.youngs_modulus is not None:
            fields[region].append("youngs_modulus")
    return {region: tuple(dict.fromkeys(tables)) for region, tables in fields.items()}


def read_by_footprint(cards: Cards) -> dict[str, tuple[str, ...]]:
    """As `read_by_elements`, and the moduli over strain amplitude."""
    fields = read_by_elements(cards)
    depend = {region for region, card in cards.items() if card.strain_dependence is not None}
    return {region: (*fields[region], *(("strain_dependence",) if region in depend else ())) for region in fields}


def read_by_rolling_footprint(cards: Cards) -> dict[str, tuple[str, ...]]:
    """As `read_by_footprint`, and density and loss of every region."""
    fields = read_by_footprint(cards)
    return {region: tuple(dict.fromkeys((*tables, "density", "loss_tangent"))) for region, tables in fields.items()}


def read_by_given(cards: Cards) -> dict[str, tuple[str, ...]]:
    """No data: the study gives the energies."""
    return {}


def read_by_unknown_law(cards: Cards) -> dict[str, tuple[str, ...]]:
    """All data, for a law without an entry here."""
    return {region: tuple(type(card).model_fields) for region, card in cards.items()}


#: The law "fem" with ``mechanics.rolling``.
FEM_ROLLING = "fem-rolling"
#: Strain law -> region -> tables that it reads; a law without an entry may read all tables.
READS: dict[str, Callable[[Cards], dict[str, tuple[str, ...]]]] = {
    "arcs": read_by_arcs,
    "barrel": read_by_elements,
    "fem": read_by_footprint,
    "given": read_by_given,
    FEM_ROLLING: read_by_rolling_footprint,
}


def tables_read(law: str, cards: Cards) -> dict[str, tuple[str, ...]]:
    """Region -> tables of its card that a strain law reads."""
    return READS.get(law, read_by_unknown_law)(cards)


def key_of(values: Any) -> str:
    """Text of cards for the key of a cache; that of a user's law names the version of its file, too.

    >>> key_of({"tread": (1.5, None)})
    "{'tread': (1.5, None)} []"
    """
    return f"{values!r} {sorted(_user_modules(values))}"


def _user_modules(value: Any) -> set[str]:
    if isinstance(value, Mapping):
        return set().union(*map(_user_modules, value.values()))
    if isinstance(value, tuple | list):
        return set().union(*map(_user_modules, value))
    return {type(value).__module__} if kind_of(type(value)) is not None and not is_ours(type(value)) else set()


def values_read(law: str, cards: Cards) -> dict[str, tuple[Any, ...]]:
    """Region -> values that a strain law reads of its card; equal values give equal strain cycles."""
    reads = tables_read(law, cards)
    return {region: tuple(getattr(cards[region], table) for table in tables) for region, tables in reads.items()}
