"""The strain laws by name: what ``mechanics.strain`` of a study may say, one class in a module of `laws` each."""

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

#: The package whose modules are the laws.
PACKAGE = "tyrefem.mechanics.laws"


class StrainLaw(ABC):
    """How the strain cycle of a load case is found. A subclass names itself and gives a `provider`; it is found by
    existing.

    Strain cycles of two studies are taken for the same where the law reads the same of their material cards:
    `tyrefem.materials.reads`. A law that is not named there reads all of them.
    """

    #: In study files; in a picture's title.
    name: ClassVar[str] = ""
    title: ClassVar[str] = ""
    #: Does a load case take seconds, as finite elements do? Then studies with the same cycles share them.
    by_elements: ClassVar[bool] = False
    #: Does it press the tyre on its road itself, so that load law and footprint law of the study are not read?
    presses: ClassVar[bool] = False
    #: Is it one of those that `tyrefem strain` compares, without further inputs?
    compared: ClassVar[bool] = True
    #: For the report: what is assumed, and why it matters.
    assumption: ClassVar[tuple[str, str]] = ("", "")

    @abstractmethod
    def provider(self, study: StudyData) -> Callable[[LoadCase], Any]:
        """From a load case to its strain cycle (`tyrefem.mechanics.strain_cycle.StrainCycle`), for one study.

        Raises
        ------
        InputError : the study lacks what the law needs.
        """


@functools.cache
def strain_laws() -> dict[str, StrainLaw]:
    """Every strain law by name.

    >>> sorted(strain_laws())
    ['arcs', 'barrel', 'fem', 'given']
    """
    package = importlib.import_module(PACKAGE)
    for module in pkgutil.iter_modules(package.__path__):
        importlib.import_module(f"{PACKAGE}.{module.name}")
    classes: list[type[StrainLaw]] = [*StrainLaw.__subclasses__()]
    for law in classes:
        classes += law.__subclasses__()
    named = [law for law in sorted(classes, key=lambda law: law.name) if law.name]
    return {law.name: law() for law in named}


def strain_law(study: StudyData) -> StrainLaw:
    """The law that a study names.

    Raises
    ------
    InputError : there is none of that name.
    """
    name, laws = study.card.mechanics.strain, strain_laws()
    if name not in laws:
        message = f"unknown strain law '{name}'{nearest(name, laws)}"
        raise InputError(message, field="mechanics.strain", file=study.file)
    return laws[name]
