"""Every command of the command line, found by itself, and arguments with which it ends within seconds."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import typer.main
from small import write

from tyrefem.cli import app

#: Values of arguments, and of options without a default, by name.
ARGUMENTS = {
    "STUDY": "study.toml", "STUDY|FILE": "study.toml", "RIG": "rig", "FILE": "study.toml", "WHAT": "studies",
    "CARD": "thermal.toml",
}  # fmt: skip
OPTIONS = {
    "speed": "0.35 m/s", "length": "225 mm", "friction": "0.5", "footprint": "0.14 m", "pressure": "300 kPa",
}  # fmt: skip
#: Flags of single commands: what they need beyond that, and what makes them short.
MORE = {
    "sweep": ["--vary", "drive.speed=10 mph:20 mph:2"],
    "diagnose": ["--looks", "1", "--largest", "1"],
    "blind": ["--cases", "1"],
    "plan": ["--set", "plan.drives=2", "--set", "plan.sensors_most=0"],
    "export": ["--tolerance", "50 K"],
    "explore": ["--vary", "drive.speed=10 mph:20 mph", "--tolerance", "15 K"],
    "rig layers": ["--most", "1"],
    "forces": [
        "--loads",
        "8 kN, 12 kN",
        "--slip-angles",
        "1 deg, 3 deg, 5 deg, 8 deg",
        "--slips",
        "none",
        "--cambers",
        "none",
    ],
    "wear": ["--set", "materials.tread=rubber-tread-aircraft"],
    "life": ["--set", "mechanics.strain=fem", "--set", "mechanics.motion=linear", "--no-sensitivity"],
}
#: Words of commands whose arguments are a kind and a name.
KINDS = {"show": ["section", "nasa-22x5.5-8pr"], "new": ["study", "another"]}
#: Suffixes of commands whose ``--out`` is one file.
SUFFIXES = {"show": ".png", "new": ".toml", "export": ".npz", "explore": ".html", "road averaging": ".png",
            "slide tables": ".png", "slide locked-wheel": ".png"}  # fmt: skip


@dataclass(frozen=True)
class Command:
    """A command with arguments that make it short."""

    words: str
    arguments: tuple[str, ...]
    #: Names of its options, without dashes.
    options: frozenset[str]
    #: Does it read a study?
    of_study: bool

    @property
    def name(self) -> str:
        """Its words as one."""
        return self.words.replace(" ", "-")

    def line(self, out: str | Path | None = None, *more: str) -> list[str]:
        """The command line, writing to ``out`` where the command can be told."""
        place = [] if out is None or "out" not in self.options else ["--out", str(out)]
        return [*self.words.split(), *self.arguments, *place, *more]

    @property
    def writes_folder(self) -> bool:
        """Does ``--out`` name a folder?"""
        return "out" in self.options and self.words not in SUFFIXES

    def out(self, folder: Path) -> Path:
        """A place for its results."""
        return folder / f"out{SUFFIXES.get(self.words, '')}"


def commands() -> list[Command]:
    """Every command that is registered; one that needs an argument unknown here is an error."""
    return [_command(words, each) for words, each in _walk((), typer.main.get_command(app))]


def _walk(words, command):  # type: ignore[no-untyped-def]
    if hasattr(command, "commands"):
        for name, each in sorted(command.commands.items()):
            yield from _walk((*words, name), each)
    else:
        yield " ".join(words), command


def _command(words: str, command) -> Command:  # type: ignore[no-untyped-def]
    arguments = list(KINDS.get(words, []))
    options = set()
    of_study = False
    for each in command.params:
        if each.param_type_name == "argument":
            of_study |= each.name == "study"
            if words not in KINDS and each.required:
                known = {**ARGUMENTS, "KIND": "studies"}
                label = (each.metavar or each.name.upper()).strip("[]")
                assert label in known, f"tests/hostile: say in ARGUMENTS how '{words}' is given its {label}"
                arguments.append(known[label])
            continue
        options.add(each.name)
        if each.required:
            assert each.name in OPTIONS or each.name == "out", (
                f"tests/hostile: say in OPTIONS how '{words}' is given --{each.name}"
            )
            if each.name != "out":
                arguments += [each.opts[0], OPTIONS[each.name]]
    if words == "slide rise":
        arguments += ["--pressure", OPTIONS["pressure"]]
    arguments += MORE.get(words, [])
    if "workers" in options:
        arguments += ["--workers", "1"]
    return Command(words, tuple(arguments), frozenset(options), of_study)


def workplace(folder: Path) -> Path:
    """A folder with everything that the commands read."""
    return write(folder)
