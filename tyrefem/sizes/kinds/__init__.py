"""One file per kind of tyre: rules that turn a size into named numbers and draw its section.

A kind is a module with a function ``draw(size, rules)``, named as the kind with `_` for its `-`.
`tyrefem.sizes.designation.parse_size` says which kind a text is.
"""

from __future__ import annotations

import importlib

from tyrefem.sizes.designation import TyreSize
from tyrefem.sizes.drawn import Drawn
from tyrefem.sizes.rules import Rules


def draw(size: TyreSize, rules: Rules) -> Drawn:
    """The section of a size by the rules of its kind.

    Raises
    ------
    InputError : the numbers do not go together.
    """
    module = importlib.import_module(f"{__name__}.{size.kind.replace('-', '_')}")
    drawn: Drawn = module.draw(size, rules)
    return drawn
