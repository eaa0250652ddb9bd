"""Commands of the documentation: where they stand, and which cannot be run as they are (`docs_commands.toml`)."""

from __future__ import annotations

import re
import shlex
import tomllib
from dataclasses import dataclass, field
from itertools import groupby
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SHELL = re.compile(r"^```(?:sh|bash|console)\n(.*?)^```", re.DOTALL | re.MULTILINE)
#: Any block of code; and a command that stands as an indented line outside of one.
BLOCK = re.compile(r"^```.*?^```", re.DOTALL | re.MULTILINE)
INDENTED = re.compile(r"^    ((?:tyrefem|python) .+)$", re.MULTILINE)
#: What stands between two commands of a line. Parts of a pipe belong together.
BETWEEN = {"&&", "||", ";"}
#: Parts of a line: in quotes, escaped, a comment, what stands between commands, or a single letter.
PARTS = re.compile(r"""'[^']*'|"(?:\\.|[^"\\])*"|\\.|(?<!\S)\#.*|&&|\|\||;|.""", re.DOTALL)


def pages() -> list[Path]:
    """All pages with commands: the manual's first, evidence and method last."""
    docs = sorted((ROOT / "docs").rglob("*.md"), key=lambda page: (len(page.parts), page))
    others = [*sorted((ROOT / "site").glob("*.md")), *sorted((ROOT / "site" / "howto").glob("*.md"))]
    return [ROOT / "README.md", *docs, *others, *sorted(ROOT.glob("studies/*/README.md")), ROOT / "CONTRIBUTING.md"]


def lines(page: Path) -> list[str]:
    """The lines of a page's shell blocks, and its indented commands, in their order; continued lines are joined."""
    text = page.read_text(encoding="utf-8").replace("\\\n", " ")
    places = [(match.start(), match[1]) for match in SHELL.finditer(text)]
    prose = BLOCK.sub(lambda match: " " * len(match[0]), text)
    places += [(match.start(), match[1]) for match in INDENTED.finditer(prose)]
    return [line for _, block in sorted(places) for line in block.splitlines() if line.strip()]


def split(line: str) -> list[str]:
    """The commands of a line, as written, without comments; a pipe is a single command.

    >>> split('a "x; y" | b && c=$PWD/d   # why; how')
    ['a "x; y" | b', 'c=$PWD/d']
    """
    parts = [part for part in PARTS.findall(line) if not part.startswith("#")]
    commands = ("".join(group).strip() for between, group in groupby(parts, BETWEEN.__contains__) if not between)
    return [command for command in commands if command]


def commands(page: Path) -> list[str]:
    """The commands of a page, as written, in their order."""
    return [command for line in lines(page) for command in split(line)]


def plain(command: str) -> str:
    """A command with its words between single spaces and without quotes, as the patterns of the list have it.

    >>> plain('tyrefem  run a --set mesh.size="6 mm"')
    'tyrefem run a --set mesh.size=6 mm'
    """
    return " ".join(shlex.split(command))


def without_place(command: str) -> str:
    """The words of a command without the place of its results: commands that differ in it alone do the same.

    >>> without_place('tyrefem  run a --out "b c" --quiet')
    'tyrefem run a --quiet'
    """
    words = shlex.split(command)
    place = words.index("--out") if "--out" in words else len(words)
    return shlex.join([*words[:place], *words[place + 2 :]])


@dataclass(frozen=True)
class Exceptions:
    """The list of commands that are not run as they stand; patterns match the whole `plain` command.

    Parameters
    ----------
    left_out : pattern -> reason. shorter : pattern -> what replaces the command, and why. ends_with : pattern -> its
        exit code, and why. before : page -> commands that make what the page takes for granted.
    """

    left_out: dict[str, str] = field(default_factory=dict)
    shorter: dict[str, tuple[str, str]] = field(default_factory=dict)
    ends_with: dict[str, tuple[int, str]] = field(default_factory=dict)
    before: dict[str, list[str]] = field(default_factory=dict)

    @classmethod
    def read(cls, path: Path = ROOT / "tools" / "docs_commands.toml") -> Exceptions:
        """The list of a file."""
        data = tomllib.loads(path.read_text(encoding="utf-8"))
        return cls(
            data.get("left_out", {}),
            {pattern: (entry["run"], entry["why"]) for pattern, entry in data.get("shorter", {}).items()},
            {pattern: (entry["code"], entry["why"]) for pattern, entry in data.get("ends_with", {}).items()},
            data.get("before", {}),
        )

    def why_left_out(self, command: str) -> str | None:
        """The reason why a command is not run at all, if there is one."""
        words = plain(command)
        return next((reason for pattern, reason in self.left_out.items() if re.fullmatch(pattern, words)), None)

    def to_run(self, command: str) -> str:
        """What is run for a command."""
        words = plain(command)
        return next((run for pattern, (run, _) in self.shorter.items() if re.fullmatch(pattern, words)), command)

    def code(self, command: str) -> int:
        """The exit code that a command shall have."""
        words = plain(command)
        return next((code for pattern, (code, _) in self.ends_with.items() if re.fullmatch(pattern, words)), 0)

    def patterns(self) -> list[str]:
        """All patterns."""
        return [*self.left_out, *self.shorter, *self.ends_with]
