"""Every command in the documentation runs: as it stands where it is quick, else on a coarse mesh, or a test is named.

`COARSE` says what is added to make a command short, `ELSEWHERE` which commands are not run here, and why.
"""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest
from test_docs_pages import PAGES, ROOT, shell_commands, tyrefem_arguments

from tyrefem.cli import main

TEXTS = [
    *PAGES, ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted(ROOT.glob("studies/*/README.md")),
    *sorted((ROOT / "site").glob("*.md")), *sorted((ROOT / "site" / "howto").glob("*.md")),
]  # fmt: skip
#: Commands that stand as an indented line.
INDENTED = re.compile(r"^    ((?:tyrefem|python) .+)$", re.MULTILINE)
#: Words of a study's name -> what makes its mechanics and its run short.
COARSE = {
    "nasa-": ["--set", "mesh.size=14 mm"],
    "example-validation": ["--set", "mesh.size=14 mm"],
    "passenger-": ["--set", "mesh.size=18 mm", "--set", "mechanics.motion=linear"],
}
#: Commands that take a study and ``--set``.
OF_STUDY = {"run", "press", "modes", "strain", "compare", "wear", "life", "sweep"}
#: Pattern of a command -> why it is not run here.
ELSEWHERE = {
    r"(\.venv/bin/)?(python3|pip|ruff|lint-imports|mypy|pytest|\.) ?.*": ".ci/run installs, lints and tests",
    r"(\.venv/bin/)?python (benchmarks|tools)/.*": "makes tables and pictures of a page: minutes to hours",
    r"python site/build\.py.*": ".ci/run builds the site",
    r"python -c .*": "prints a help text",
    r"(export|paraview|pvpython) .*": "of the shell; of ParaView, which is no dependency",
    r"tyrefem explore .*": "a minute: tests/explore",
    r"tyrefem (new tan-delta-law|check plugins/|list tan-delta-laws).*": "tests/plugins/test_extending_page.py",
    r"tyrefem (run studies/passenger-225.*|thermal-card .*)": "follow other commands: tests/sizes, tests/lumped",
    r"tyrefem show strain passenger.*": "ten seconds: tests/strain/test_strain_by_region.py",
    r"dask .*": "starts a cluster: tests/plugins/test_plugins_elsewhere.py has one",
    r".* tcp://.*": "needs a cluster: tests/plugins/test_plugins_elsewhere.py has one",
    r"tyrefem \w+ (identify )?my-.*": "names files of the reader",
    r"tyrefem (diagnose|isolability|plan|blind) .*": "half a minute and more: site/gallery, tests/diagnose, tests/plan",
    r"tyrefem compare (example-structural|first/).*": "follows a diagnosis: tests/compare, tests/diagnose",
    r"tyrefem (roll|forces) .*": "a minute: tests/cli/test_roll_command.py, tests/cli/test_forces_command.py",
    r"tyrefem press .*(--critical-speed|rolling=true).*": "minutes: tests/cli/test_critical_speed.py, tests/rolling",
    r"tyrefem press .*(--camber|--drum).*": "a full section in large motion: tests/cli/test_press_command.py",
    r"tyrefem rig (identify|layers) .*": "half a minute: tests/rig",
    r"tyrefem export .*": "half a minute: tests/realtime, site/gallery",
    r"tyrefem sweep .*(--tornado|--indices|--count|output\.life|--minimise|crown-angle).*": "minutes: tests/sweep",
    r"tyrefem sweep .*--link .*": "a radial for every variant: tests/sweep",
    r"tyrefem sweep .* --workers 4": "the same sweep as of docs/sweeps.md, which runs here",
    r"tyrefem run (nasa-campaign|aircraft-sizes)": "many cases: tests/campaign, tests/sizes",
    r"tyrefem run .*boundaries\.sliding=rolling.*": "a minute: tests/sliding/test_rolling_drive.py",
    r"tyrefem run nasa-taxi-takeoff --set mechanics\.feedback.*": "half a minute: tests/feedback",
    r"tyrefem run .*rig-trtlab-identified.*": "takes the cards of an identification: tests/rig",
    r"tyrefem run .*mesh\.size=0\.11 mm.*": "is refused, as its page says: tests/estimate",
    r"tyrefem (run|press) (aircraft-radial|truck-|measured-).*": "half a minute: tests/studies, tests/sizes",
    r"tyrefem wear .*": "a minute: tests/wear, site/gallery",
    r"tyrefem life (?!.*--no-sensitivity).*": "five runs: tests/cli/test_life_command.py",
    r"tyrefem .*--out results/first": "the ring of 60 MB: tests/output, site/gallery",
}


def commands() -> list[str]:
    """Every command of the documentation, once."""
    lines: dict[str, None] = {}
    for page in TEXTS:
        text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
        indented = [shlex.split(line, comments=True) for line in INDENTED.findall(text.replace("\\\n", " "))]
        for words in [*shell_commands(page), *indented]:
            arguments = tyrefem_arguments(words)
            lines[shlex.join(words if arguments is None else ["tyrefem", *arguments])] = None
    return list(lines)


COMMANDS = commands()


def why_elsewhere(command: str) -> str | None:
    """The reason why a command is not run here, if there is one."""
    plain = " ".join(shlex.split(command))
    return next((reason for pattern, reason in ELSEWHERE.items() if re.fullmatch(pattern, plain)), None)


def without_place(command: str) -> tuple[str, ...]:
    """The words of a command, without the place of its results."""
    words = shlex.split(command)
    place = words.index("--out") if "--out" in words else len(words)
    return (*words[:place], *words[place + 2 :])


#: Commands that run here; those that differ in the place of their results alone run once.
HERE = list({without_place(each): each for each in reversed(COMMANDS) if why_elsewhere(each) is None}.values())[::-1]


def short(command: str) -> list[str]:
    """The arguments of a command, with what makes it short."""
    arguments = shlex.split(command)[1:]
    more = []
    if arguments[0] in OF_STUDY:
        more += next((flags for name, flags in COARSE.items() if arguments[1].startswith(name)), [])
        more += [flag for flag in ("--no-pictures", "--no-vtk") if flag not in arguments and arguments[0] == "run"]
    if arguments[0] in ("compare", "sweep") and "--workers" not in arguments:
        more += ["--workers", "1"]
    return [*arguments, *more]


@pytest.mark.fast
def test_every_command_is_one_of_tyrefem_or_has_a_reason() -> None:
    assert len(COMMANDS) > 100
    assert len(HERE) > 40
    assert [command for command in HERE if not command.startswith("tyrefem ")] == []


@pytest.mark.fast
def test_every_reason_is_needed_and_names_what_there_is() -> None:
    named = {name for reason in ELSEWHERE.values() for name in re.findall(r"(?:tests|site)/[\w./]*\w", reason)}
    assert [name for name in named if not (ROOT / name).exists()] == []
    plain = [" ".join(shlex.split(command)) for command in COMMANDS]
    assert [pattern for pattern in ELSEWHERE if not any(re.fullmatch(pattern, command) for command in plain)] == []


@pytest.mark.parametrize("command", HERE)
def test_a_command_of_the_documentation_runs(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    if command == "tyrefem check studies/my-tyre":
        assert main(["new", "study", "my-tyre"]) == 0
    assert main(short(command)) == 0, capfd.readouterr().err[-1000:]
