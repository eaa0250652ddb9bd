"""The record of the documentation's commands: which ended how, how long they took, and on what state of the code.

`run_docs_commands.py --record` writes it to `docs_record.csv`. A command without a row, and not run by
`tests/packaging/test_docs_commands.py` either, fails that test.
"""

from __future__ import annotations

import csv
import io
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

from docs_commands import ROOT, Exceptions, commands, pages, without_place

PATH = ROOT / "tools" / "docs_record.csv"
COLUMNS = ("page", "command", "exit code", "seconds", "commit date")


def to_be_run(exceptions: Exceptions) -> list[tuple[str, str, int]]:
    """Page, command as it is run, and exit code that it shall have; of all commands that are not left out."""
    return [
        (page.relative_to(ROOT).as_posix(), exceptions.to_run(command), exceptions.code(command))
        for page in pages()
        for command in commands(page)
        if exceptions.why_left_out(command) is None and not command.startswith("export ")
    ]


def commit_date() -> str:
    """The date of the commit that is checked out."""
    git = ["git", "-C", str(ROOT), "log", "-1", "--format=%cs"]
    return subprocess.run(git, capture_output=True, text=True, check=True).stdout.strip()


@dataclass(frozen=True)
class Row:
    """A command that was run.

    Parameters
    ----------
    page : the page among whose commands it was run. code : exit code; None: ended as too long.
    seconds : by the clock, so longer on a busy machine. date : of the commit that was checked out.
    """

    page: str
    command: str
    code: int | None
    seconds: float
    date: str


@dataclass
class Record:
    """Rows by command without its place. What stands on several pages has the row of the page that was run last."""

    rows: dict[str, Row] = field(default_factory=dict)

    @classmethod
    def read(cls, path: Path = PATH) -> Record:
        """The record of a file; an empty one, if there is none."""
        if not path.exists():
            return cls()
        rows = [list(row.values()) for row in csv.DictReader(io.StringIO(path.read_text(encoding="utf-8")))]
        record = cls()
        for page, command, code, seconds, date in rows:
            record.add(Row(page, command, int(code) if code else None, float(seconds), date))
        return record

    def add(self, row: Row) -> None:
        """Add a row, or put it in the place of that of the same command."""
        self.rows[without_place(row.command)] = row

    def row(self, command: str) -> Row | None:
        """The row of a command."""
        return self.rows.get(without_place(command))

    def write(self, exceptions: Exceptions, path: Path = PATH) -> None:
        """Write the rows of commands that the documentation still has, in the order of its pages."""
        documented = [without_place(command) for _, command, _ in to_be_run(exceptions)]
        text = io.StringIO()
        table = csv.writer(text, lineterminator="\n")
        table.writerow(COLUMNS)
        for row in [self.rows[key] for key in dict.fromkeys(documented) if key in self.rows]:
            code = "" if row.code is None else row.code
            table.writerow([row.page, row.command, code, f"{row.seconds:.1f}", row.date])
        part = path.with_suffix(".part")
        part.write_text(text.getvalue(), encoding="utf-8")
        part.replace(path)
