"""Run the commands of the documentation, page by page, each page in a fresh copy of this checkout.

    python tools/run_docs_commands.py                            # all pages: hours
    python tools/run_docs_commands.py docs/sweeps.md README.md   # these
    python tools/run_docs_commands.py --longest 60               # ends a command after 60 s: "too long"
    python tools/run_docs_commands.py --list                     # what would be run, and why the rest is not
    python tools/run_docs_commands.py --record docs/sweeps.md    # and writes how it ended to docs_record.csv
    python tools/run_docs_commands.py --record --new              # only commands that have no row there

Commands of a page run one after the other in the same folder, as a reader types them. What cannot be run, what is run
shorter and what shall fail stands in `docs_commands.toml`, with the reason. Exit code 1: a command failed. Without
``--new``, a page is run whole: a command may need what one before it made.
"""

from __future__ import annotations

import argparse
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Container, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from docs_commands import ROOT, Exceptions, commands, pages, without_place
from docs_record import Record, Row, commit_date

#: Lines of the output that are shown of a command that failed.
SHOWN = 8


@dataclass(frozen=True)
class Outcome:
    """A command of a page: exit code (None: ended as too long, or left out), seconds, and words on it."""

    page: str
    command: str
    code: int | None
    seconds: float
    word: str
    output: str = ""

    @property
    def failed(self) -> bool:
        """Is something wrong?"""
        return self.word in ("FAILED", "too long")

    def __str__(self) -> str:
        code = "-" if self.code is None else str(self.code)
        return f"{self.page:<36} {code:>3} {self.seconds:7.1f} s  {self.word:<8} {self.command}"


def copied(folder: Path) -> None:
    """Copy what git tracks or would track of this checkout into a folder."""
    named = subprocess.run(
        ["git", "-C", str(ROOT), "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        capture_output=True, check=True,
    ).stdout  # fmt: skip
    for name in filter(None, named.decode().split("\0")):
        if (ROOT / name).is_file():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, folder / name)
    # A page may call the programs of its environment by their path.
    (folder / ".venv").symlink_to(sys.prefix, target_is_directory=True)


def run(command: str, folder: Path, exports: Sequence[str], longest: float | None) -> tuple[int | None, float, str]:
    """Exit code (None: too long), seconds and output of a command in a shell; a process that is left is ended."""
    environment = os.environ | {
        "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ.get('PATH', '')}",
        "PYTHONPATH": str(folder),
    }
    start = time.monotonic()
    # A failing part of a pipe fails the pipe.
    process = subprocess.Popen(
        ["bash", "-c", "\n".join(["set -o pipefail", *exports, command])],
        cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        text=True, errors="replace", start_new_session=True,
    )  # fmt: skip
    try:
        output, _ = process.communicate(timeout=longest)
        return process.returncode, time.monotonic() - start, output
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        output, _ = process.communicate()
        return None, time.monotonic() - start, output


def outcomes(
    page: Path, exceptions: Exceptions, longest: float | None = None, known: Container[str] = ()
) -> Iterator[Outcome]:
    """Run a page's commands, but for those that are known, in a copy of the checkout."""
    name = page.relative_to(ROOT).as_posix()
    with tempfile.TemporaryDirectory(prefix="docs-") as place:
        folder = Path(place)
        copied(folder)
        exports: list[str] = []
        for prepared in exceptions.before.get(name, []):
            code, seconds, output = run(prepared, folder, exports, longest)
            if code:
                yield Outcome(name, f"(before) {prepared}", code, seconds, "FAILED", output)
        for command in commands(page):
            reason = exceptions.why_left_out(command)
            if without_place(exceptions.to_run(command)) in known:
                continue
            if reason is not None:
                yield Outcome(name, f"{command}   [{reason}]", None, 0.0, "left out")
            elif command.startswith("export "):
                exports.append(command)
            else:
                chosen = exceptions.to_run(command)
                code, seconds, output = run(chosen, folder, exports, longest)
                word = "ok" if chosen == command else "shorter"
                word = "too long" if code is None else word if code == exceptions.code(command) else "FAILED"
                yield Outcome(name, chosen, code, seconds, word, output)


def main(arguments: list[str] | None = None) -> int:
    """Run the pages that are named, or all."""
    parser = argparse.ArgumentParser(description="Run the commands of the documentation, page by page.")
    parser.add_argument("pages", nargs="*", help="pages, from here; default: all")
    parser.add_argument("--longest", type=float, help="s after which a command is ended")
    parser.add_argument("--list", action="store_true", help="run nothing: say what would be run")
    parser.add_argument("--record", action="store_true", help="write how the commands ended to docs_record.csv")
    parser.add_argument("--new", action="store_true", help="only commands that have no row in docs_record.csv")
    given = parser.parse_args(arguments)
    exceptions = Exceptions.read()
    record = Record.read()
    known = record.rows if given.new else {}
    chosen = [Path(page).resolve() for page in given.pages] or [page for page in pages() if commands(page)]
    done: list[Outcome] = []
    for page in chosen:
        if given.list:
            for command in commands(page):
                reason = exceptions.why_left_out(command)
                print(f"{page.relative_to(ROOT)}: {exceptions.to_run(command)}" + (f"   [{reason}]" if reason else ""))
            continue
        if all(without_place(exceptions.to_run(command)) in known for command in commands(page)):
            continue
        for outcome in outcomes(page, exceptions, given.longest, known):
            done.append(outcome)
            print(outcome, flush=True)
            if given.record and outcome.word != "left out":
                record.add(Row(outcome.page, outcome.command, outcome.code, outcome.seconds, commit_date()))
                record.write(exceptions)
            if outcome.failed:
                print("\n".join(f"    {line}" for line in outcome.output.splitlines()[-SHOWN:]), flush=True)
    if not given.list:
        ran = [outcome for outcome in done if outcome.word != "left out"]
        failed = [outcome for outcome in done if outcome.failed]
        print(f"{len(ran)} commands in {sum(o.seconds for o in ran) / 60:.0f} minutes, {len(failed)} failed, "
              f"{len(done) - len(ran)} left out")  # fmt: skip
        return 1 if failed else 0
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
