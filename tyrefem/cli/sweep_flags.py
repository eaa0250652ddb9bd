"""The flags of `tyrefem sweep` as keys of a sweep file, and the processes or cluster that compute its variants."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Container, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.errors import InputError, nearest
from tyrefem.threads import usable_cores

if TYPE_CHECKING:
    from tyrefem.sweep.design import DesignData, Questions
    from tyrefem.variants.execution import Execution
    from tyrefem.variants.schedulers import Scheduler


#: Keys of a sweep file that a flag of one word gives.
FLAGS = {
    "uncertain": "--uncertain", "sample": "--sample", "count": "--count", "seed": "--seed", "cases": "--cases",
    "time_to": "--time-to", "answers": "--answer",
}  # fmt: skip


def questions_of_flags(
    *,
    vary: list[str] | None = None,
    link: list[str] | None = None,
    uncertain: float | None = None,
    sample: str | None = None,
    count: int | None = None,
    seed: int | None = None,
    cases: str | None = None,
    limit: list[str] | None = None,
    time_to: str | None = None,
    answer: list[str] | None = None,
    pareto: list[str] | None = None,
    indices: int | None = None,
    tornado: bool = False,
    tolerance_of: list[str] | None = None,
    minimise: str | None = None,
    maximise: str | None = None,
    runs: int | None = None,
    envelope: str | None = None,
    loads: str | None = None,
    pressures: str | None = None,
    speeds: str | None = None,
) -> dict[str, Any]:
    """Convert flags to the keys of a sweep file; flags that are not given are left out."""
    if indices is not None and (sample is not None or count is not None):
        raise InputError("uses Saltelli's sample: remove --sample and --count", field="--indices")
    if cases is not None and sample is None:
        sample = "list"
    tolerances = _once([_tolerance(text) for text in tolerance_of or []], "--tolerance-of")
    given: dict[str, Any] = {
        "vary": _once([varied(text) for text in vary or []], "--vary"),
        "link": _once([_link(text) for text in link or []], "--link"),
        "uncertain": uncertain,
        "sample": "saltelli" if indices is not None else sample,
        "count": count if indices is None else indices,
        "seed": seed,
        # A path of a flag is relative to the working folder, a path in a file to that file.
        "cases": None if cases is None else str(Path(cases).absolute()),
        "limits": _limits(limit or []) or None,
        "time_to": time_to,
        "answers": answer or None,
        "pareto": _once([_aim(text) for text in pareto or []], "--pareto"),
        # Without tolerances of its own the flag leaves those of a file as they are.
        "tornado": ({"tolerances": tolerances} if tolerances else {}) if tornado else None,
        "optimise": _optimise(minimise, maximise, runs, seed),
        "envelope": _envelope(envelope, loads, pressures, speeds),
    }
    if tolerance_of and not tornado:
        raise InputError("needs --tornado", field="--tolerance-of")
    return {key: value for key, value in given.items() if value is not None}


def varied(text: str) -> tuple[str, dict[str, Any]]:
    """Parse one ``--vary``: its key, and the entry of a sweep file.

    >>> varied("drive.speed=10 mph:40 mph:4")
    ('drive.speed', {'from': '10 mph', 'to': '40 mph', 'levels': 4})
    >>> varied("materials.tread=soft,hard")
    ('materials.tread', {'values': ['soft', 'hard']})
    >>> varied("materials.tread.loss_tangent.value=x0.8:x1.2")
    ('materials.tread.loss_tangent.value', {'factor': [0.8, 1.2]})
    """
    key, values = _pair(text, "--vary", "drive.speed=10 mph:40 mph:4")
    # Not at the colon of a path such as C:/cards.
    parts = [part.strip() for part in re.split(r":(?![\\/])", values)]
    if len(parts) == 1:
        return key, {"values": [_plain(part) for part in _listed(values, "--vary")]}
    if len(parts) > 3:
        raise InputError(f"'{values}' has more than from:to:levels", field="--vary")
    levels: dict[str, Any] = {}
    if len(parts) == 3:
        if re.fullmatch("[0-9]{1,99}", parts[2]) is None:
            raise InputError(f"'{parts[2][:99]}' is not a number of levels", field="--vary")
        levels = {"levels": int(parts[2])}
    if parts[0].startswith("x") and parts[1].startswith("x"):
        try:
            return key, {"factor": [float(parts[0][1:]), float(parts[1][1:])], **levels}
        except ValueError:
            raise InputError(f"'{values}' is not two factors, e.g. x0.8:x1.2", field="--vary") from None
    return key, {"from": _plain(parts[0]), "to": _plain(parts[1]), **levels}


def _link(text: str) -> tuple[str, list[str]]:
    name, keys = _pair(text, "--link", "gauges=section.thickness_scale.*")
    return name, _listed(keys, "--link")


def _once(pairs: list[tuple[str, Any]], flag: str) -> dict[str, Any] | None:
    """The values of a repeatable flag by name; None if it is not given."""
    by_key: dict[str, Any] = {}
    for key, value in pairs:
        if key in by_key:
            raise InputError(f"'{key}' is given twice", field=flag)
        by_key[key] = value
    return by_key or None


def _pair(text: str, flag: str, example: str) -> tuple[str, str]:
    key, equals, value = text.partition("=")
    if not equals or not key.strip() or not value.strip():
        raise InputError(f"'{text}' is not KEY=VALUE, e.g. '{example}'", field=flag)
    return key.strip(), value.strip()


def _listed(text: str, flag: str) -> list[str]:
    parts = [part.strip() for part in text.split(",")]
    if not all(parts):
        raise InputError(f"'{text}' has an empty entry between its commas", field=flag)
    return parts


def _plain(text: str) -> str | float:
    try:
        return float(text)
    except ValueError:
        return text


def _bound(text: str, flag: str) -> tuple[str, str, float]:
    match = re.fullmatch(r"\s*([\w .+-]+?)\s*([<>])\s*([-+\d.eE]+)\s*", text)
    if match is None:
        raise InputError(
            f"'{text}' is not ANSWER<VALUE or ANSWER>VALUE, the value without a unit, e.g. 'hottest_degC<110'",
            field=flag,
        )
    try:
        value = float(match[3])
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"'{match[3]}' is not a number", field=flag)
    return match[1], match[2], value


def _limits(texts: list[str]) -> dict[str, dict[str, float]]:
    limits: dict[str, dict[str, float]] = {}
    for text in texts:
        name, sign, value = _bound(text, "--limit")
        key = "below" if sign == "<" else "above"
        if key in limits.setdefault(name, {}):
            raise InputError(f"'{name}' is limited twice", field="--limit")
        limits[name][key] = value
    return limits


def _aim(text: str) -> tuple[str, str]:
    return _pair(text, "--pareto", "hottest_degC=min")


def _tolerance(text: str) -> tuple[str, str]:
    key, value = _pair(text, "--tolerance-of", "materials.tread.loss_tangent.value=10%")
    return key, value.replace("%", " %") if " " not in value else value


def _optimise(minimise: str | None, maximise: str | None, runs: int | None, seed: int | None) -> dict[str, Any] | None:
    if minimise is None and maximise is None:
        if runs is not None:
            raise InputError("needs --minimise or --maximise", field="--runs")
        return None
    given = {"minimise": minimise, "maximise": maximise, "runs": runs, "seed": seed}
    return {key: value for key, value in given.items() if value is not None}


def _envelope(text: str | None, loads: str | None, pressures: str | None, speeds: str | None) -> dict[str, Any] | None:
    if text is None:
        given = {"--loads": loads, "--pressures": pressures, "--speeds": speeds}
        for flag, value in given.items():
            if value is not None:
                raise InputError("needs --envelope", field=flag)
        return None
    answer, sign, bound = _bound(text, "--envelope")
    if sign != "<":
        raise InputError(f"'{text}' must be ANSWER<VALUE, e.g. 'hottest_degC<110'", field="--envelope")
    chosen: dict[str, Any] = {"below": bound, "answer": answer}
    if loads is not None:
        chosen["loads"] = _listed(loads, "--loads")
    if pressures is not None:
        chosen["pressures"] = _listed(pressures, "--pressures")
    if speeds is not None:
        slow, colon, fast = speeds.partition(":")
        if not colon:
            raise InputError(f"'{speeds}' is not FROM:TO, e.g. '1 m/s:60 m/s'", field="--speeds")
        chosen |= {"slowest": slow.strip(), "fastest": fast.strip()}
    return chosen


def questions(
    name: str, given: dict[str, Any], changes: dict[str, Any], case: str | None = None
) -> tuple[str, Questions]:
    """The questions of a sweep file or study, changed by the flags, and a name for the folder of results.

    ``case``: case of a campaign.

    Raises
    ------
    InputError : there is no study or sweep of that name, or a question is not allowed.
    """
    from tyrefem import library
    from tyrefem.api import study as load
    from tyrefem.cards import read_toml
    from tyrefem.sweep import design
    from tyrefem.variants.card import SweepCard

    path = Path(name)
    is_file = path.suffix.lower() == ".toml" and path.is_file() and "study" in read_toml(path)
    if is_file or (path / "sweep.toml").is_file() or name in library.names("sweep"):
        file = library.find("sweep", name)
        stem = file.parent.resolve().name if file.name == "sweep.toml" else file.stem
        with _naming_flags(given):
            return stem, design.loaded(name, changes, **given, **({} if case is None else {"case": case}))
    if (
        path.suffix.lower() != ".toml"
        and os.sep not in name
        and name not in library.names("study")
        and not path.is_dir()
    ):
        known = [*library.names("study"), *library.names("sweep")]
        raise InputError(f"no study or sweep named '{name}'{nearest(name, known)}")
    study = load(name, changes, case)
    with _naming_flags(given):
        card = SweepCard.check({"study": name, **given})
    return study.name, design.questions(study, card, Path())


@contextmanager
def _naming_flags(given: Container[str]) -> Iterator[None]:
    """Name the flag, not the key of a sweep file, in an error of what a flag has given."""
    try:
        yield
    except InputError as error:
        if error.field in FLAGS and error.field in given:
            raise InputError(error.message, field=FLAGS[error.field]) from None
        raise


class _InterruptedError(Exception):
    """Raised to end working processes without waiting for them."""


def computed_design(wanted: Questions, how: Execution, address: str | None, workers: int | None) -> DesignData:
    """Compute the answers on a Dask cluster at ``address``, or in ``workers`` processes (None: one per core)."""
    try:
        with _scheduler(address, workers) as where:
            design = wanted.answered(how, scheduler=where)
            if design.interrupted:
                raise _InterruptedError
    except _InterruptedError:
        pass
    return design


@contextmanager
def _scheduler(address: str | None, workers: int | None) -> Iterator[Scheduler]:
    """Scheduler of all variants of the command, closed at the end."""
    from tyrefem.variants.dask_cluster import Dask
    from tyrefem.variants.schedulers import Here, Local

    if address is not None:
        cluster = Dask(address)
        try:
            yield cluster
        finally:
            cluster.close()
        return
    count = workers or usable_cores()
    if count == 1:
        yield Here()
        return
    with Local(count) as processes:
        yield processes
