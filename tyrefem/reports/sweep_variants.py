"""Fields of a sweep's chosen variants for ParaView, each from a full run."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from tyrefem.errors import InputError, nearest
from tyrefem.reports.vtk import write_series
from tyrefem.reports.words import file_stem, unlike

if TYPE_CHECKING:
    from tyrefem.sweep.design import DesignData
    from tyrefem.variants.plan import Plan

#: Folder of the variants' folders; word for all variants on the Pareto front.
FOLDER, FRONT = "variants", "front"


def refuse_unknown(plan: Plan, words: Iterable[str]) -> None:
    """Refuse words that name no variant of a sample, before anything is computed.

    Raises
    ------
    InputError : no sample; neither a variant of it nor `FRONT`.
    """
    for word in words:
        if not len(plan.variants):
            raise InputError("the sweep has no sample, so no variants by name", field="--vtk")
        if word != FRONT and word not in plan.names:
            raise InputError(f"no variant '{word}'{nearest(word, [FRONT, *plan.names])}", field="--vtk")


def chosen_variants(design: DesignData, words: Iterable[str]) -> list[str]:
    """Names of variants, and `FRONT` for those on the Pareto front: each once, in this order.

    Raises
    ------
    InputError : no variant of that name.
    """
    names: list[str] = []
    for word in words:
        names += [str(name) for name in design.pareto["variant"]] if word == FRONT else [word]
    for name in names:
        design.variant_study(name)
    return list(dict.fromkeys(names))


def write_variants(
    design: DesignData, folder: Path, variants: Iterable[str | int] | None = None, *, revolved: bool = False
) -> dict[str, Path]:
    """Run variants and write the VTK files of each into ``variants/NAME``: name -> its .pvd; None: the Pareto front.

    Raises
    ------
    InputError : no variant of that name; the folder cannot be written; errors of a run.
    """
    from tyrefem.simulation.run import run

    if variants is not None and (isinstance(variants, str) or not isinstance(variants, Iterable)):
        raise InputError(f"must be a list of variants, like ['1', '2'], not {variants!r:.60}", field="variants")
    chosen = chosen_variants(design, [FRONT] if variants is None else map(str, variants))
    if not chosen and variants is not None:
        raise InputError("names no variant", field="variants")
    if not chosen:
        raise InputError("no variant is on the Pareto front: none is feasible", field="variant")
    assert design.swept is not None
    taken: set[str] = set()
    # Of all variants, so that the folder of each is the same whichever are chosen.
    folders = {name: folder / FOLDER / unlike(file_stem(name, "tyre"), taken) for name in design.swept.plan.names}
    return {name: write_series(run(design.variant_study(name)), folders[name], revolved=revolved) for name in chosen}
