"""The strain laws by name, the allowed values of ``mechanics.strain``: a class in a module of `laws`, or a user's."""

from __future__ import annotations

import functools
import importlib
import pkgutil
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any, ClassVar

from tyrefem.errors import InputError, nearest
from tyrefem.inputs.loading import LoadCase
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.user_cycle import with_tried_cycles
from tyrefem.plugins import Kind, registry

#: The package whose modules are the laws.
PACKAGE = "tyrefem.mechanics.laws"


class StrainLaw(ABC):
    """A law that gives the strain cycle of a load case. A subclass has a name and a `provider`; its file in `laws`, or
    a user's plugin, makes it known.

    Two studies have the same strain cycles if the law reads the same values of their material cards:
    `tyrefem.materials.reads`. A law that is not listed there reads all values.
    """

    plugin_kind: ClassVar[Kind]
    #: In study files; in a picture's title.
    name: ClassVar[str] = ""
    title: ClassVar[str] = ""
    #: True: a load case takes seconds, as with finite elements; studies with the same cycles then share them.
    by_elements: ClassVar[bool] = False
    #: True: the law solves the contact with the road and so follows load and pressure by itself; load law and footprint
    #: law of the study are then not used, except by effects that change the pressure: these warn of it.
    presses: ClassVar[bool] = False
    #: True: `tyrefem strain` compares the law, which needs no further inputs.
    compared: ClassVar[bool] = True
    #: Power of the deflection to which the energies are in proportion, if the law says so: 2.0 for a linear tyre.
    energy_exponent: ClassVar[float | None] = None
    #: For the report: the assumption, and its consequence.
    assumption: ClassVar[tuple[str, str]] = ("", "")

    def assumption_of(self, study: StudyData) -> tuple[str, str]:
        """The assumption as the report of a study states it."""
        return self.assumption

    @abstractmethod
    def provider(self, study: StudyData) -> Callable[[LoadCase], Any]:
        """A function from load case to strain cycle (`tyrefem.mechanics.strain_cycle.StrainCycle`), for one study.

        Raises
        ------
        InputError : the study lacks what the law needs.
        """


@functools.cache
def shipped_strain_laws() -> dict[str, type[StrainLaw]]:
    """The laws of this package by name."""
    package = importlib.import_module(PACKAGE)
    for module in pkgutil.iter_modules(package.__path__):
        importlib.import_module(f"{PACKAGE}.{module.name}")
    classes: list[type[StrainLaw]] = [*StrainLaw.__subclasses__()]
    for law in classes:
        classes += law.__subclasses__()
    ours = [law for law in classes if law.name and law.__module__.startswith(f"{PACKAGE}.")]
    return {law.name: law for law in sorted(ours, key=lambda law: law.name)}


KIND = StrainLaw.plugin_kind = Kind(
    "strain law",
    "strain laws",
    'name: ClassVar[str] = "..."',
    lambda cls: str(getattr(cls, "name", "")),
    shipped_strain_laws,
    prepare=with_tried_cycles,
)


def strain_laws() -> dict[str, StrainLaw]:
    """Every strain law by name, those of this package first.

    >>> sorted(strain_laws())
    ['arcs', 'barrel', 'fem', 'given']
    """
    classes = {**shipped_strain_laws(), **dict(sorted(registry().classes(KIND).items()))}
    return {name: law() for name, law in classes.items()}


def strain_law(study: StudyData) -> StrainLaw:
    """The law that a study names.

    Raises
    ------
    InputError : no law has that name.
    """
    name, laws = study.card.mechanics.strain, strain_laws()
    registry().refuse(KIND, name, known=name in laws)
    if name not in laws:
        message = f"unknown strain law '{name}'{nearest(name, laws)}"
        raise InputError(message, field="mechanics.strain", file=study.file)
    return laws[name]
