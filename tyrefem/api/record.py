"""A folder that a command other than `run` and `compare` has written: summary, tables, study."""

from __future__ import annotations

import functools
import itertools
import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.api.studies import Study
from tyrefem.brief import Brief
from tyrefem.errors import InputError, nearest
from tyrefem.output import SUMMARY
from tyrefem.output.folder import BOOKKEEPING
from tyrefem.plugins.missing import words_of_missing

if TYPE_CHECKING:
    import pandas as pd

#: Files of a command's main answer, in the order of search; then ``summary.json``.
ANSWERS = (
    "verdict.json", "comparison.json", "plan.json", "critical-speed.json", "press.json", "roll.json", "forces.json",
    "modes.json", "blind.json", "isolability.json", "strain.json", "thermal-card.json",
    "rig.json",
)  # fmt: skip
#: Beside ``isolability.json`` with ``--calibrate``: the answer's ``calibration``.
CALIBRATION = "calibration.json"
#: Columns of text: 01 is no number there, NA is a name, empty stays empty.
TEXTS = ("variant", "run", "sensor", "phase", "case", "failure", "note")
#: Files of a study in such a folder.
STUDIES = ("amended.toml", "study.toml")


@dataclass(frozen=True, eq=False)
class Record(Brief):
    """What a command has written, read again. Made by `tyrefem.load`.

    Parameters
    ----------
    folder : the folder. command : that wrote it, e.g. "diagnose". complete : False if it was interrupted.
    """

    folder: Path
    command: str
    complete: bool

    def _title(self) -> str:
        return f"of tyrefem {self.command}, {self.folder}"

    def _facts(self) -> Mapping[str, Any]:
        return {
            "complete": str(self.complete),
            **({"verdict": self.verdict} if self.verdict else {}),
            "tables": ", ".join(self.names) or "none",
            **({"page": self.page.name} if self.page else {}),
            **({"cases": ", ".join(self.cases)} if self.cases else {}),
        }

    @functools.cached_property
    def summary(self) -> dict[str, Any]:
        """The command's answer: contents of the first of `ANSWERS` in the folder, else of ``summary.json``.

        Raises
        ------
        InputError : the file is damaged.
        """
        file = next((self.folder / name for name in (*ANSWERS, SUMMARY) if (self.folder / name).is_file()), None)
        assert file is not None, "made of a folder with a summary"
        answer = {key: value for key, value in read_json(file).items() if key not in BOOKKEEPING}
        calibration = self.folder / CALIBRATION
        if file.name == "isolability.json" and calibration.is_file():
            answer["calibration"] = read_json(calibration)
        return answer

    @property
    def verdict(self) -> str:
        """In a few words, where the command gives a verdict; else empty."""
        verdict = self.summary.get("verdict", "")
        return verdict if isinstance(verdict, str) else ""

    @functools.cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the tables."""
        files = [file for kind in ("csv", "parquet") for file in self.folder.glob(f"*.{kind}")]
        return tuple(sorted({file.stem for file in files}))

    def table(self, name: str) -> pd.DataFrame:
        """A table by name, from its Parquet file if there is one.

        Raises
        ------
        InputError : no such table; the file cannot be read.
        """
        if name not in self.names:
            raise InputError(f"has no table '{name}'{nearest(name, self.names)}", file=self.folder)
        file = self.folder / f"{name}.parquet"
        try:
            return _read_table(file if file.is_file() else file.with_suffix(".csv"))
        except (OSError, ValueError) as error:
            raise InputError(f"cannot be read: {error!s:.80}", file=self.folder / f"{name}.csv") from None

    @functools.cached_property
    def study(self) -> Study | None:
        """The study of the folder, after a diagnosis the amended one; None: the folder has none."""
        file = next((self.folder / name for name in STUDIES if (self.folder / name).is_file()), None)
        if file is None:
            return None
        with naming_plugins(self.folder):
            return Study.load(file)

    @property
    def page(self) -> Path | None:
        """The page for people; None: not drawn."""
        pages = sorted(self.folder.glob("*.html"))
        return pages[0] if pages else None

    @functools.cached_property
    def cases(self) -> tuple[str, ...]:
        """Cases of a campaign whose results are here: `tyrefem.load` of ``folder / "cases" / name`` gives each."""
        return tuple(sorted(file.parent.name for file in self.folder.glob("cases/*/result.npz")))


def _read_table(file: Path) -> pd.DataFrame:
    import pandas as pd

    if file.suffix == ".parquet":
        return pd.read_parquet(file)
    with open(file, encoding="utf-8") as stream:
        above = sum(1 for _ in itertools.takewhile(lambda line: line.startswith("#"), stream))
    texts = pd.read_csv(file, usecols=lambda column: column in TEXTS, dtype=str, keep_default_na=False, skiprows=above)
    return pd.read_csv(file, skiprows=above).assign(**texts)


@contextmanager
def naming_plugins(folder: Path) -> Iterator[None]:
    """Errors of a study in this block say which plugins the folder's result used that this process has not."""
    try:
        yield
    except InputError as error:
        file = folder / SUMMARY
        rows = read_json(file).get("plugins") if file.is_file() else None
        missing = words_of_missing(rows) if isinstance(rows, list) else ""
        if not missing:
            raise
        message = f"{error.message}; {missing}"
        raise InputError(message, field=error.field, file=error.file or folder) from None


def read_json(file: Path) -> dict[str, Any]:
    """The table of a JSON file.

    Raises
    ------
    InputError : the file cannot be read, or is damaged.
    """
    try:
        data = json.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror or error}", file=file) from None
    except ValueError:
        raise InputError("is damaged: run the command again", file=file) from None
    if not isinstance(data, dict):
        raise InputError("is damaged: run the command again", file=file)
    return data
