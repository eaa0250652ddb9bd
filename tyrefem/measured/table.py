"""A measured table: CSV or workbook of one run, or of several with a ``run`` column or a sheet each."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from tyrefem.errors import InputError
from tyrefem.measured.heading import parts
from tyrefem.measured.lines import Lines, NoTableError, split, texts
from tyrefem.measured.names import ColumnNames, missing_columns_error
from tyrefem.measured.run import MeasuredRun
from tyrefem.measured.sheet import Sheet
from tyrefem.output import as_path


def read_table(
    path: str | Path,
    *,
    time_offset: float = 0.0,
    rename: Mapping[str, str] | None = None,
    ignore: Iterable[str] = (),
) -> tuple[MeasuredRun, ...]:
    """The runs of a thermocouple table in the format of loggers.

    The heading has ``time [s]`` (or min, h, ms), perhaps ``run``, and one column per sensor with its unit:
    ``crown [degC]``, ``[degF]`` or ``[K]``. Timestamps, and clock times as h:mm:ss, count from the first row of their
    run. Units may stand in a row of their own. Columns in a unit of pressure, speed, force, length or
    power are not sensors and are left out (`MeasuredRun.channels`).
    Comma, semicolon or tab between columns; decimal comma or point; UTF-8, UTF-16, Windows-1252 or Latin-1. Empty,
    ``NaN``, ``-``, ``--``, ``-9999`` = no reading. ``#`` and ``//`` begin a comment. Of a workbook (xlsx, xlsm, xlsb,
    xls, ods) the visible sheets with a time column are read; several are runs with the sheets' names.

    Parameters
    ----------
    path : the CSV file or workbook.
    time_offset : s, added to every time of the table (model time = table time + offset).
    rename : column name -> sensor name, or ``time`` or ``run``. A time column without unit is given one so:
        ``{"Dauer": "time [mm:ss]"}``.
    ignore : column names to leave out, for temperatures of other things than sensors.

    Returns
    -------
    One `MeasuredRun` per run, in the order of their first row. Its ``notes`` say how content beyond the plain form was
    read.

    Raises
    ------
    InputError : unclear content, with file, line and column; an unknown column to rename; ``ignore`` or ``rename`` of
        another form.

    >>> import tempfile
    >>> file = Path(tempfile.mkdtemp()) / "run-1.csv"
    >>> _ = file.write_text("# Wallops\\ntime [min],crown [degF]\\n0,77\\n1,\\n2,95\\n")
    >>> run, = read_table(file)
    >>> run.name, run.times.tolist(), run.temperatures["crown"].tolist()
    ('run-1', [0.0, 60.0, 120.0], [25.0, nan, 35.0])
    """
    names = ColumnNames.of(ignore=ignore, rename=rename)
    table = table_lines(path, names.rename).read(time_offset=time_offset, rename=names.rename, ignore=names.ignore)
    missing = table.missing(names.rename)
    if missing:
        raise missing_columns_error(missing, "to rename", table.columns, table.file)
    return table.runs


@dataclass(frozen=True, eq=False)
class MeasuredTable:
    """The runs of a file, and the headings of all its columns, including ignored ones."""

    file: Path
    runs: tuple[MeasuredRun, ...]
    headings: tuple[str, ...]

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns, without their units."""
        return tuple(parts(text)[0] for text in self.headings if text)

    def missing(self, names: Iterable[str]) -> list[str]:
        """The names that are no column, with or without its unit."""
        return [name for name in names if name not in self.columns and name not in self.headings]


@dataclass(frozen=True, eq=False)
class TableLines:
    """The rows of a file or a frame: one sheet, or several of a workbook.

    Parameters
    ----------
    sheets : several are runs with the sheets' names, unless they have run columns. file : the table in errors.
    name : of the run of a single sheet without a run column. in_memory : whether the table is no file.
    """

    sheets: tuple[Sheet, ...]
    file: Path
    name: str
    in_memory: bool = False

    def runs(self, names: ColumnNames) -> tuple[str, ...]:
        """Names of the runs, if no more than one column has them."""
        return tuple(dict.fromkeys(run for sheet in self.sheets for run in sheet.runs(names)))

    def read(
        self, *, time_offset: float = 0.0, rename: Mapping[str, str] | None = None, ignore: Iterable[str] = ()
    ) -> MeasuredTable:
        """The runs; arguments and errors as of `read_table`, without the check that the columns to rename exist."""
        ignore = tuple(ignore)
        runs: dict[str, MeasuredRun] = {}
        sheet_of: dict[str, str] = {}
        for sheet in self.sheets:
            with _naming(sheet.sheet):
                read = sheet.read(time_offset=time_offset, rename=rename, ignore=ignore)
            for run in read:
                if run.name in runs:
                    both = f"'{sheet_of[run.name]}' and '{sheet.name}'"
                    raise InputError(f"run '{run.name}' stands in two sheets, {both}", file=self.file)
                runs[run.name], sheet_of[run.name] = run, sheet.name
        headings = dict.fromkeys(text for sheet in self.sheets for text in sheet.lines.heading)
        return MeasuredTable(self.file, tuple(runs.values()), tuple(headings))


def table_lines(path: str | Path, rename: Mapping[str, str] | None = None) -> TableLines:
    """The rows of a file; ``rename``: column -> name, for a time column that is called otherwise.

    Sheets without a time column are left out, which is noted, unless no sheet has one.
    """
    file = as_path(path, "path")
    of_sheets = texts(file)
    alone = len(of_sheets) == 1
    lines, others = dict[str, Lines](), list[str]()
    for name, text in of_sheets.items():
        try:
            with _naming(None if alone else name):
                lines[name] = split(text, file, rename)
        except NoTableError:
            if alone:
                raise
            others.append(name)
    if not lines:
        raise InputError(f"none of its sheets ({', '.join(others)}) has a time column like 'time [s]'", file=file)
    if others:
        note = f"sheets without a time column are left out: {', '.join(others)}"
        lines = {name: replace(of_sheet, notes=(*of_sheet.notes, note)) for name, of_sheet in lines.items()}
    names = dict.fromkeys(lines, file.stem) if len(lines) == 1 else {name: name for name in lines}
    sheets = (Sheet(lines[name], file, names[name], sheet=None if alone else name) for name in lines)
    return TableLines(tuple(sheets), file, file.stem)


@contextmanager
def _naming(sheet: str | None) -> Iterator[None]:
    """Errors say the sheet, if there are several."""
    try:
        yield
    except NoTableError:
        raise
    except InputError as error:
        if sheet is None:
            raise
        raise InputError(f"sheet '{sheet}', {error.message}", field=error.field, file=error.file) from None
