"""Boxes that vary the section's shape: the common mesh topology, and the projected operators over shapes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from tyrefem.errors import InputError
from tyrefem.geometry.meshing.mapped import Counts
from tyrefem.geometry.meshing.topology import Topology, common_counts
from tyrefem.inputs.study import StudyData
from tyrefem.reduced.model import NotReducibleError, ReducedModel
from tyrefem.reduced.shape_operators import shape_operators
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.variants.samples import changes_at
from tyrefem.variants.varied import Varied

if TYPE_CHECKING:
    from tyrefem.geometry import Section
    from tyrefem.variants.plan import Plan

#: All corners of a box are meshed up to so many varied numbers of the section; beyond, its opposite ones only.
MOST_CORNERS = 6
#: Shapes whose weights and tensors are learnt: at least, and more for every varied number of the section.
LEAST_SHAPES, SHAPES_PER_NUMBER = 16, 8


def shape_numbers(varied: Sequence[Varied]) -> list[int]:
    """Places of the varied numbers that change the section."""
    return [n for n, number in enumerate(varied) if any(key.split(".")[0] == "section" for key in number.keys)]


def counts_of(plan: Plan) -> Counts | None:
    """Rows and gaps that are enough for every corner of a plan's box; None: the section does not vary.

    Raises
    ------
    NotReducibleError : the meshes of two corners have no common topology.
    """
    numbers = shape_numbers(plan.varied)
    if not numbers:
        return None
    choice = plan.study.card.mesh
    if choice.file is not None or choice.mesher != "mapped" or choice.cell not in (None, "quad"):
        raise NotReducibleError("shapes share a mesh only if it is mapped, of quadrilaterals ([mesh] mesher, cell)")
    for number in numbers:
        if "section" in plan.varied[number].keys:
            raise NotReducibleError("'section' varies as a whole: other sections have other meshes")
    ends = product((0.0, 1.0), repeat=len(numbers)) if len(numbers) <= MOST_CORNERS else [(0.0,), (1.0,)]
    sections: dict[Section, None] = {}
    for corner in ends:
        place = np.full(len(plan.varied), 0.5)
        place[numbers] = corner if len(corner) == len(numbers) else corner[0]
        try:
            sections[plan.study.replace(changes_at(plan.varied, place)).section] = None
        except InputError as error:
            raise NotReducibleError(f"a corner of the box has no section: {error}") from None
    try:
        return common_counts(plan.study.section, list(sections), choice.size, choice.through)
    except InputError as error:
        raise NotReducibleError(f"the shapes have no common mesh: {error.message}") from None


def tyre_of(study: StudyData, counts: Counts | None) -> RollingTyre:
    """The tyre of a study; with ``counts``, on a mesh that its other shapes share."""
    if counts is None:
        return RollingTyre(study)
    choice = study.card.mesh
    return RollingTyre(study, topology=Topology(study.section, choice.size, choice.through, counts))


def with_shapes(model: ReducedModel, studies: Sequence[StudyData]) -> ReducedModel:
    """The model with projected operators over the shapes of these studies.

    Raises
    ------
    NotReducibleError : none of the studies has a mesh of the model's topology.
    """
    tyres = [model.base]
    for study in studies:
        tyre = model.tyre(study)
        try:
            _ = tyre.mesh
        except InputError:
            continue
        tyres.append(tyre)
    rows = {zone: model.nodes_from_samples[part] for zone, part in model.zone_rows.items()}
    V = model.V if model.further is None else model.enriched.V
    return replace(model, shapes=shape_operators(model.base, V, rows, tyres))


def shape_count(varied: Sequence[Varied]) -> int:
    """Number of shapes to learn from."""
    return LEAST_SHAPES + SHAPES_PER_NUMBER * len(shape_numbers(varied))
