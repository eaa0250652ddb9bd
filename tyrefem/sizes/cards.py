"""Material cards of the regions that sizes draw: rubbers all radials share, plies and belts of a kind, bead wires."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from tyrefem.errors import InputError

#: Shear modulus of the rubber that insulates bead wires, Pa. Estimate: 93 Shore A, by Gent 1958 E = 30 MPa.
INSULATION = 10e6
#: Densities, kg/m3, specific heats, J/kg/K, and conductivity, W/m/K, of rubber and steel (handbook values).
RUBBER, STEEL = (1120.0, 1700.0, 0.25), (7850.0, 460.0)
#: More of a bundle than round wires in rubber can be.
MOST_WIRE = 0.9


def wires_in_rubber(share: float) -> float:
    """(1 + v)/(1 - v): shear modulus and conductivity across stiff round fibres of share v over the rubber's.

    Hashin and Rosen 1964, rigid fibres.

    >>> wires_in_rubber(0.5)
    3.0

    Raises
    ------
    InputError : no such share of wire.
    """
    if not 0 < share < MOST_WIRE:
        raise InputError(
            f"bead_wire_area is {share:.0%} of bead_height x bead_width; allowed: below {MOST_WIRE:.0%}",
            field="parameters.bead_wire_area",
        )
    return (1 + share) / (1 - share)


def bead_shear(share: float) -> dict[str, str]:
    """Shear modulus of a bundle across its wires, as a card has it."""
    source = f"estimate: insulation of {INSULATION / 1e6:g} MPa, (1 + v)/(1 - v) times with v = {share:.0%} of wire"
    return {"value": f"{INSULATION / 1e6 * wires_in_rubber(share):.4g} MPa", "source": source}


def bead_card(base: str, share: float, ends: Mapping[str, Any]) -> dict[str, Any]:
    """A bundle of which ``share`` is wire: its card, with the properties of the mixture.

    >>> card = bead_card("passenger-bead", 0.5, {})
    >>> card["elasticity"]["shear_modulus"], card["density"]["value"]
    ('30 MPa', '4485 kg/m**3')
    """
    shear = bead_shear(share)
    density = (1 - share) * RUBBER[0] + share * STEEL[0]
    heat = ((1 - share) * RUBBER[0] * RUBBER[1] + share * STEEL[0] * STEEL[1]) / density
    conductivity = f"{RUBBER[2] * wires_in_rubber(share):.3g} W/m/K"
    mixed = f"estimate: rubber and {share:.0%} steel"
    return {
        "base": base,
        "cords": dict(ends),
        "shear_modulus": shear,
        "elasticity": {"law": "neo-hookean", "shear_modulus": shear["value"], "source": shear["source"]},
        "density": {"value": f"{density:.4g} kg/m**3", "source": f"{mixed} mixed by volume"},
        "specific_heat": {"value": f"{heat:.3g} J/kg/K", "source": f"{mixed} mixed by mass"},
        "conductivity": {
            "along": conductivity,
            "across": conductivity,
            "source": f"{mixed}: (1 + v)/(1 - v) times that of rubber, {RUBBER[2]:g} W/m/K",
        },
    }


def radial_cards(
    ply: str, ply_card: Mapping[str, Any], belts: Mapping[str, Mapping[str, Any]], tread: str, bead: Mapping[str, Any]
) -> dict[str, Any]:
    """Region -> card of a radial. ``ply``: region of the plies; the turn-up and the wrap have their card.

    >>> list(radial_cards("body-ply", {}, {"belt-1": {}}, "rubber-tread-truck", {}))[:5]
    ['liner', 'body-ply', 'turn-up', 'bead-wrap', 'belt-1']
    """
    return {
        "liner": "rubber-liner",
        ply: dict(ply_card),
        "turn-up": dict(ply_card),
        "bead-wrap": dict(ply_card),
        **{region: dict(card) for region, card in belts.items()},
        "undertread": "rubber-undertread",
        "tread": tread,
        "shoulder-cushion": "rubber-cushion",
        "sidewall": "rubber-sidewall",
        "apex": "rubber-apex",
        "bead": dict(bead),
        "chafer": "rubber-chafer",
    }
