"""Results from the folders that commands have written."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from tyrefem.api.record import Record, naming_plugins, read_json
from tyrefem.api.result import Result
from tyrefem.api.studies import Study
from tyrefem.api.verbs import with_verbs
from tyrefem.errors import InputError, nearest
from tyrefem.inputs.origin import STUDY
from tyrefem.output import SUMMARY, as_path
from tyrefem.output.folder import COMMAND, COMPLETE

if TYPE_CHECKING:
    from tyrefem.api.comparison import Comparison
    from tyrefem.api.diagnosis_record import DiagnosisRecord

#: Files of a comparison.
COMPARISON = ("comparison.csv", "residuals.csv", "curves.csv", "comparison.json")


def load(folder: str | Path) -> Result | Comparison | DiagnosisRecord | Record:
    """The result of a folder: a `Result`, a `Comparison`, a `DiagnosisRecord`, or of other commands a `Record`.

    A `Result` from a folder is that of the run: readings, temperatures, heat budget, pictures, report, VTK, study.
    Cards of the study are those of the run, though their files have changed since. No code of the files is run.
    A `Comparison` is that of the command; a `DiagnosisRecord` has verdict, sets, readings and the amended study.

    Parameters
    ----------
    folder : folder of results, or the file ``result.npz`` in it.

    Raises
    ------
    InputError : no such folder; it holds no results, results of another format, or damaged ones.

    >>> import tempfile, tyrefem as tf
    >>> run = tf.study("nasa-22x5.5-8pr", {"mesh.size": "12 mm", "drive.duration": "60 s"}).run()
    >>> place = tempfile.mkdtemp()
    >>> _ = run.save(place)
    >>> again = tf.load(place)
    >>> bool((abs(again.readings - run.readings) < 1e-8).all(axis=None)), again.study.title == run.study.title
    (True, True)
    """
    from tyrefem.simulation.stored_result import FILE, read_result

    place = as_path(folder, "folder")
    with suppress(RuntimeError):  # ~NAME without such a user is a name as any other
        place = place.expanduser()
    if place.is_file() and place.name == FILE:
        place = place.parent
    if place.is_file():
        raise InputError(f"is a file; give its folder of results, or {FILE} in it", file=place)
    if not place.is_dir():
        raise InputError(f"no such folder of results{_near(place)}", file=place)
    if (place / FILE).is_file():
        with naming_plugins(place):
            return with_verbs(Result, read_result(place / FILE, Study))
    if all((place / name).is_file() for name in COMPARISON):
        from tyrefem.api.comparison import Comparison
        from tyrefem.compare.stored import read_comparison

        with naming_plugins(place):
            return with_verbs(Comparison, read_comparison(place), original=_study(place))
    if (place / "verdict.json").is_file():
        from tyrefem.api.diagnosis_record import DiagnosisRecord

        if not {"verdict", "study", "sets"} <= set(read_json(place / "verdict.json")):
            raise InputError("is damaged, or no verdict of 'tyrefem diagnose'", file=place / "verdict.json")
        whole = not (place / SUMMARY).is_file() or bool(read_json(place / SUMMARY).get(COMPLETE, True))
        return DiagnosisRecord(place.absolute(), "diagnose", whole)
    if not (place / SUMMARY).is_file():
        raise InputError(
            f"is no folder of results: it has neither {FILE} nor {SUMMARY}; 'tyrefem run STUDY --out FOLDER' makes one",
            file=place,
        )
    summary = read_json(place / SUMMARY)
    command = summary.get(COMMAND)
    cases = (place / "cases").is_dir() or (place / "campaign.csv").is_file()
    if command == "run" and not cases:
        raise InputError(
            f"has no {FILE}: an older version wrote it, or the run was interrupted before its tables; run the study "
            "again",
            file=place,
        )
    if not isinstance(command, str):
        raise InputError(f"is no folder of results: its {SUMMARY} names no command of tyrefem", file=place)
    return Record(place.absolute(), command, bool(summary.get(COMPLETE, True)))


def _study(place: Path) -> Study | None:
    """The study of a folder of results; None: it has none, or its cards have gone."""
    with suppress(InputError):
        return Study.load(place / STUDY) if (place / STUDY).is_file() else None
    return None


def _near(place: Path) -> str:
    """The nearest folder beside it, as a hint; empty without any."""
    try:
        beside = [path.name for path in place.parent.iterdir() if path.is_dir()]
    except OSError:
        return ""
    return nearest(place.name, beside) if beside else ""
