"""A plugin's file with all its contracts."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tyrefem.boundaries import KIND as BOUNDARY_LAW
from tyrefem.contracts import effect, law, strain_law, sweep_answer
from tyrefem.contracts.contract import Contract
from tyrefem.effects import KIND as EFFECT
from tyrefem.errors import InputError, PluginWarning
from tyrefem.materials.road_friction import FRICTION
from tyrefem.materials.tan_delta_card import TAN_DELTA
from tyrefem.mechanics.strain_laws import KIND as STRAIN_LAW
from tyrefem.plugins import Failure, Kind, Plugin, registry, use
from tyrefem.plugins.guard import failure_words
from tyrefem.plugins.loading import LoadedModule, module_name
from tyrefem.plugins.registry import nameless
from tyrefem.sweep.question import KIND as SWEEP_ANSWER

#: Kind -> its contracts, of a class and the name of a study or None.
CONTRACTS: dict[Kind, Callable[[Any, str | None], Iterator[Contract]]] = {
    EFFECT: effect.contracts,
    BOUNDARY_LAW: law.boundary_law,
    TAN_DELTA: law.tan_delta_law,
    STRAIN_LAW: strain_law.contracts,
    FRICTION: law.friction_law,
    SWEEP_ANSWER: sweep_answer.contracts,
}


@dataclass(frozen=True)
class CheckedFile:
    """The plugins of a file with their contracts, and what cannot be used at all."""

    plugins: tuple[tuple[Plugin, tuple[Contract, ...]], ...]
    failures: tuple[str, ...]

    @property
    def count(self) -> int:
        """Number of contracts."""
        return len(self.failures) + sum(len(contracts) for _, contracts in self.plugins)

    @property
    def failed(self) -> int:
        """Number of contracts that are not kept."""
        faults = [contract for _, contracts in self.plugins for contract in contracts if contract.fault]
        return len(self.failures) + len(faults)

    @property
    def lines(self) -> Iterator[str]:
        """Every plugin and its contracts, a line each."""
        for failure in self.failures:
            yield f"  FAIL  {failure}"
        for plugin, contracts in self.plugins:
            yield f"{plugin.kind.name} '{plugin.name}', class {plugin.cls.__name__}"
            for contract in contracts:
                yield f"  {contract.line}"

    def to_dict(self) -> dict[str, Any]:
        """Content for JSON."""
        return {
            "failures": list(self.failures),
            "plugins": [
                {**plugin.to_dict(), "contracts": [vars(contract) for contract in contracts]}
                for plugin, contracts in self.plugins
            ],
            "contracts": self.count,
            "failed": self.failed,
        }


def check_file(file: str | Path, study: str | None = None) -> CheckedFile:
    """Load a file with plugins, and try their contracts.

    Parameters
    ----------
    study : name of a study in which they are tried; default: a quick one.

    Raises
    ------
    InputError : no such file, or a file without any plugin.
    """
    place = Path(file).expanduser().resolve()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PluginWarning)  # they are listed instead
        use(place)
        loaded = registry()
    modules = [module for module in loaded.modules if _is_of(place, module)]
    files = {place, *(module.origin.file for module in modules)}
    failures = [_words(failure) for failure in loaded.failures if failure.origin.file in files]
    failures += [words for module in modules for words in nameless(module)]
    plugins = [plugin for plugin in loaded.plugins if plugin.origin.file in files]
    if not plugins and not failures:
        kinds = ", ".join(kind.name for kind in CONTRACTS)
        raise InputError(f"has no plugin: a class that extends the base of a kind ({kinds})", file=file)
    tried = tuple((plugin, tuple(_contracts(plugin, study))) for plugin in plugins)
    return CheckedFile(tried, tuple(failures))


def _contracts(plugin: Plugin, study: str | None) -> Iterator[Contract]:
    """The contracts of a plugin; an attribute of the wrong type, on which they fail, is another that is not kept."""
    words = "its contracts can be tried"
    try:
        yield from CONTRACTS[plugin.kind](plugin.cls, study)
    except InputError as error:
        yield Contract(words, str(error))
    except Exception as error:
        yield Contract(words, failure_words(error, str(plugin.origin.file)))


def _is_of(place: Path, module: LoadedModule) -> bool:
    """Whether a module is that of a file, or of an equal one of another folder, which is loaded once for both."""
    return place.is_file() and module.name == module_name(place, place.read_bytes())


def _words(failure: Failure) -> str:
    return ": ".join(filter(None, (failure.place, failure.words)))
