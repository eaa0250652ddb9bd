"""Every command in the documentation runs: here, as it stands or on a coarse mesh, or it has a row in the record.

`COARSE` says what is added to make a command short, `ELSEWHERE` which commands are not run here, and why.
`tools/run_docs_commands.py --record` runs them all, page by page as they stand, but for those in
`tools/docs_commands.toml`, and writes `tools/docs_record.csv`.
"""

from __future__ import annotations

import re
import shlex
import shutil
from collections.abc import Iterator
from dataclasses import replace
from itertools import groupby, pairwise
from pathlib import Path

import pytest
from docs_commands import Exceptions, commands, lines, pages, plain, split, without_place
from docs_record import Record, Row, to_be_run
from run_docs_commands import Outcome, outcomes
from test_docs_pages import ROOT, tyrefem_arguments

import tyrefem as tf
from tyrefem.cli import main

#: Words of a study's name -> what makes its mechanics and its run short.
LINEAR = ["--set", "mesh.size=14 mm", "--set", "mesh.element=P1", "--set", "numerics.tolerance=0.25 K"]
COARSE = {
    "nasa-22x5.5": [*LINEAR, "--set", "drive.duration=60 s"],
    "nasa-": LINEAR,
    "example-": LINEAR,
    "passenger-": ["--set", "mesh.size=22 mm", "--set", "mechanics.motion=linear"],
    "studies/passenger-": ["--set", "mesh.size=22 mm", "--set", "mechanics.motion=linear"],
}
#: Commands that take a study and ``--set``.
OF_STUDY = {"run", "press", "modes", "strain", "compare", "wear", "life", "sweep", "explore", "export"}
#: Begin of a command -> what else makes it short.
MORE = {
    "tyrefem explore": ["--tolerance", "10 K"],
    "tyrefem explore nasa-22x5.5-8pr --set": ["--vary", "drive.speed=15 mph:20 mph"],
    "tyrefem export": ["--tolerance", "50 K", "--workers", "1"],
}
#: Command -> commands that come before it on its page.
FIRST = {
    "tyrefem check studies/my-tyre": ["tyrefem new study my-tyre"],
    "tyrefem check studies/205-60r15": ["tyrefem new study 205/60R15"],
    "tyrefem check plugins/lamp.py": ["tyrefem new effect lamp"],
    "tyrefem check plugins/arrhenius.py": ["tyrefem new tan-delta-law arrhenius"],
    "tyrefem run results/soft/study.toml": [
        shlex.join(["tyrefem", "modes", "nasa-22x5.5-8pr", *COARSE["nasa-22x5.5"], "--out", "results/soft"])
    ],
    "tyrefem run studies/passenger-225-45r17": ["tyrefem new tyre 225/45R17 --from passenger-205-55r16"],
}
#: Command -> files of the repository that its page has, here by the names of the page.
FILES = {
    "tyrefem check my-sweep.toml": {"my-sweep.toml": "studies/crown-angle/sweep.toml"},
    "tyrefem thermal-card studies/thermal-passenger": {"studies/thermal-passenger": "studies/thermal-passenger"},
}
#: Pattern of a command -> why it is not run here.
ELSEWHERE = {
    r"(\.venv/bin/)?python (benchmarks|tools)/.*": "makes tables and pictures of a page: minutes",
    r"python3? -c .*": "prints a help text, or reads the answer of another command",
    r"export .*": "of the shell",
    r"tyrefem explore nasa-22x5\.5-8pr": "the whole box: tests/explore",
    r"tyrefem show strain passenger.*": "ten seconds: tests/strain/test_strain_by_region.py",
    r"tyrefem \w+ (identify )?my-(study|rig).*": "names files of the reader",
    r"tyrefem (diagnose|isolability|plan|blind) .*": "half a minute and more: site/gallery, tests/diagnose, tests/plan",
    r"tyrefem compare first/.*": "follows a diagnosis: tests/compare, tests/diagnose",
    r"tyrefem (roll|forces) .*": "a minute: tests/cli/test_roll_command.py, tests/cli/test_forces_command.py",
    r"tyrefem press .*(--critical-speed|rolling=true).*": "minutes: tests/cli/test_critical_speed.py, tests/rolling",
    r"tyrefem press .*(--camber|--drum).*": "a full section in large motion: tests/cli/test_press_command.py",
    r"tyrefem rig (identify|layers) .*": "half a minute: tests/rig",
    r"tyrefem sweep .*(--tornado|--indices|--count|output\.life|--minimise).*": "minutes: tests/sweep",
    r"tyrefem sweep .*(crown-angle|eight-numbers).*": "minutes: tests/sweep, tests/reduced",
    r"tyrefem sweep .*--link .*": "a radial for every variant: tests/sweep",
    r"tyrefem sweep .* --workers 4": "the same sweep as of docs/sweeps.md, which runs here",
    r"tyrefem run (nasa-campaign|aircraft-sizes)": "many cases: tests/campaign, tests/sizes",
    r"tyrefem run .*boundaries\.sliding=rolling.*": "a minute: tests/sliding/test_rolling_drive.py",
    r"tyrefem run .*rig-trtlab-identified.*": "takes the cards of an identification: tests/rig",
    r"tyrefem (run|press) (aircraft-radial|truck-|measured-).*": "half a minute: tests/studies, tests/sizes",
    r"tyrefem wear .*": "a minute: tests/wear, site/gallery",
    r"tyrefem life .*": "ten seconds and more: tests/cli/test_life_command.py",
    r"tyrefem .*--out results/first": "the ring of 60 MB: tests/output, site/gallery",
}
EXCEPTIONS = Exceptions.read()


def parts(command: str) -> Iterator[str]:
    """The parts of a pipe, as commands of ``tyrefem`` where they are some."""
    for between, part in groupby(shlex.split(command), "|".__eq__):
        words = list(part)
        arguments = None if between else tyrefem_arguments(words)
        if not between:
            yield shlex.join(words if arguments is None else ["tyrefem", *arguments])


COMMANDS = list(dict.fromkeys(part for page in pages() for command in commands(page) for part in parts(command)))


def why_elsewhere(command: str) -> str | None:
    """The reason why a command is not run here, if there is one."""
    reasons = {pattern: reason for pattern, (_, reason) in EXCEPTIONS.ends_with.items()} | ELSEWHERE
    words = plain(command)
    matching = (reason for pattern, reason in reasons.items() if re.fullmatch(pattern, words))
    return EXCEPTIONS.why_left_out(command) or next(matching, None)


def short(command: str) -> list[str]:
    """The arguments of a command, with what makes it short."""
    arguments = shlex.split(command)[1:]
    more = []
    if arguments[0] in OF_STUDY:
        more += next((flags for name, flags in COARSE.items() if arguments[1].startswith(name)), [])
        more += [flag for flag in ("--no-pictures", "--no-vtk") if flag not in arguments and arguments[0] == "run"]
    for begin, flags in MORE.items():
        more += flags if command.startswith(begin) else []
    if arguments[0] in ("compare", "sweep", "explore") and "--workers" not in arguments:
        more += ["--workers", "1"]
    return [*arguments, *more]


#: Options that leave something out.
LESS = {"--no-pictures", "--no-vtk"}


def what_runs(command: str) -> tuple[str, ...]:
    """What a command does when it is short: its words, the last value of each setting, not the place of its results."""
    words = shlex.split(without_place(shlex.join(["tyrefem", *short(command)])))
    values = [place + 1 for place, word in enumerate(words) if word == "--set"]
    last = {words[place].partition("=")[0]: words[place] for place in values}
    left = [word for place, word in enumerate(words) if word not in LESS | {"--set"} and place not in values]
    return (*left, *sorted(last.values()))


#: Commands that run here; those that do the same when they are short run once, by the one that leaves out least.
HERE = list({what_runs(each): each for each in reversed(COMMANDS) if why_elsewhere(each) is None}.values())[::-1]
SAME = [each for each in COMMANDS if why_elsewhere(each) is None and each not in HERE]


@pytest.mark.fast
def test_commands_that_do_the_same_run_once() -> None:
    runs = ["run a --set b=1", "run a --set b=2 --out c", "run a --set b=1 --set b=2 --no-vtk"]
    first, second, third = (what_runs(f"tyrefem {each}") for each in runs)
    assert first != second == third
    assert {what_runs(each) for each in SAME} <= {what_runs(each) for each in HERE}


@pytest.mark.fast
@pytest.mark.parametrize("command", [each for each in SAME if " --set " in each])
def test_the_settings_of_a_command_that_runs_as_another_are_those_of_its_study(command: str) -> None:
    words = shlex.split(command)
    changes = dict(after.split("=", 1) for word, after in pairwise(words) if word == "--set")
    assert changes
    tf.study(words[2], changes)


@pytest.mark.fast
def test_every_command_is_one_of_tyrefem_or_has_a_reason() -> None:
    assert len(COMMANDS) > 190
    assert len(HERE) > 50
    assert len(HERE) + len(SAME) > 65
    assert [command for command in HERE if not command.startswith("tyrefem ")] == []


@pytest.mark.fast
def test_every_reason_is_needed_and_names_what_there_is() -> None:
    reasons = [*ELSEWHERE.values(), *EXCEPTIONS.left_out.values()]
    named = {name for reason in reasons for name in re.findall(r"(?:tests|site)/[\w./]*\w", reason)}
    assert [name for name in named if not (ROOT / name).exists()] == []
    every = {plain(command) for page in pages() for command in commands(page)} | {plain(each) for each in COMMANDS}
    patterns = [*ELSEWHERE, *EXCEPTIONS.patterns()]
    assert [pattern for pattern in patterns if not any(re.fullmatch(pattern, command) for command in every)] == []
    assert {name for name in EXCEPTIONS.before if not (ROOT / name).is_file()} == set()


@pytest.mark.fast
def test_every_command_that_does_not_run_here_has_been_run() -> None:
    record = Record.read()
    elsewhere = [
        (page, command, code)
        for page, command, code in to_be_run(EXCEPTIONS)
        if any(why_elsewhere(part) for part in parts(command))
    ]
    assert len(elsewhere) > 80
    rows = [(page, command, code, record.row(command)) for page, command, code in elsewhere]
    missing = [f"python tools/run_docs_commands.py --record {page}   # for: {command}"
               for page, command, _, row in rows if row is None]  # fmt: skip
    assert missing == []
    assert [row for _, _, code, row in rows if row is not None and row.code != code] == []


@pytest.mark.fast
def test_the_record_gives_back_what_was_written(tmp_path: Path) -> None:
    every = [command for _, command, _ in to_be_run(EXCEPTIONS)]
    first, last = (
        Row("README.md", command, code, 1.5, "2026-11-26") for command, code in ((every[0], 2), (every[-1], None))
    )
    record = Record()
    for row in (replace(last, code=0), last, replace(first, command="tyrefem gone"), first):
        record.add(row)
    record.write(EXCEPTIONS, tmp_path / "record.csv")
    again = Record.read(tmp_path / "record.csv")
    # In the order of the pages, without what no page has.
    assert list(again.rows.values()) == [first, last]
    assert again.row(f"{every[0]} --out elsewhere") == first
    assert again.row("tyrefem gone") is None


@pytest.mark.fast
def test_commands_are_read_as_a_shell_reads_them() -> None:
    line = "tyrefem a --set x='1; 2' && tyrefem b | jq .c; export D=$PWD/d     # not; this"
    assert split(line) == ["tyrefem a --set x='1; 2'", "tyrefem b | jq .c", "export D=$PWD/d"]
    page = ROOT / "docs" / "rig.md"
    assert len(lines(page)) == 5
    assert commands(page)[-1].startswith("tyrefem run nasa-22x5.5-8pr --set materials.tread=results/")


@pytest.fixture
def shown(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, Outcome]:
    """The outcomes of a page's commands by the tool that runs whole pages."""
    monkeypatch.setattr("run_docs_commands.ROOT", tmp_path)
    monkeypatch.setattr("run_docs_commands.copied", lambda folder: (folder / "there.txt").write_text("4"))
    page = tmp_path / "page.md"
    page.write_text(
        "```sh\nexport NAME=made && mkdir $NAME   # kept for the page\ntest -d made; cat there.txt first.txt | grep 4\n"
        "exit 2\nfalse\nsleep 9\npip install all\nlong way\n```\n"
    )
    exceptions = Exceptions(
        {"pip .*": "installs"}, {"long .*": ("echo short", "long")}, {"exit 2": (2, "as it says")},
        {"page.md": ["echo 4 > first.txt"]},
    )  # fmt: skip
    return {outcome.command: outcome for outcome in outcomes(page, exceptions, longest=1.0)}


@pytest.mark.fast
def test_commands_of_a_page_run_one_after_the_other_in_one_folder(shown: dict[str, Outcome]) -> None:
    words = {command: (outcome.word, outcome.code) for command, outcome in shown.items()}
    assert words == {
        "mkdir $NAME": ("ok", 0), "test -d made": ("ok", 0), "cat there.txt first.txt | grep 4": ("ok", 0),
        "exit 2": ("ok", 2), "false": ("FAILED", 1), "sleep 9": ("too long", None),
        "pip install all   [installs]": ("left out", None), "echo short": ("shorter", 0),
    }  # fmt: skip
    assert [command for command, outcome in shown.items() if outcome.failed] == ["false", "sleep 9"]
    assert 1.0 <= shown["sleep 9"].seconds < 5.0


@pytest.mark.parametrize("command", HERE)
def test_a_command_of_the_documentation_runs(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    # What a command names as plugins is no longer named after it.
    monkeypatch.setenv("TYREFEM_PLUGINS", "")
    for name, file in FILES.get(command, {}).items():
        place = tmp_path / name
        place.parent.mkdir(parents=True, exist_ok=True)
        (shutil.copytree if (ROOT / file).is_dir() else shutil.copy)(ROOT / file, place)
    for first in FIRST.get(command, []):
        assert main(shlex.split(first)[1:]) == 0
    assert main(short(command)) == 0, capfd.readouterr().err[-1000:]
