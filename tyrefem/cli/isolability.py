"""`tyrefem isolability`: effects that a study's sensors and runs can distinguish, computed before any measurement."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from tyrefem.cli.common import (
    CaseOption,
    ForceOption,
    SetOption,
    StudyArgument,
    settings,
    warn,
)
from tyrefem.cli.progress import progress
from tyrefem.cli.shell import answer_with, say
from tyrefem.errors import InputError
from tyrefem.interruption import keeping
from tyrefem.output.folder import results_folder
from tyrefem.threads import usable_cores

#: Files that the command writes.
FILES = ("isolability.csv", "isolability.json", "isolability.png", "calibration.json", "calibration.png")


def isolability(
    study: StudyArgument,
    changes: SetOption = None,
    case: CaseOption = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder; default: results/STUDY-isolability.")] = None,
    workers: Annotated[int | None, typer.Option(min=1, help="Processes; default: one per core, at most 4.")] = None,
    cases: Annotated[
        int | None,
        typer.Option("--calibrate", min=40, max=100_000, help="Quick cases that test the stated probabilities."),
    ] = None,
    fitted: Annotated[
        bool, typer.Option("--fitted", help="Simulate and fit the cases as a diagnosis does: some 10 s each.")
    ] = False,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the cases.")] = 1,
    force: ForceOption = False,
) -> None:
    """Compute which effects the study's sensors and runs can distinguish, and how strong these must be.

    With --calibrate N, N quick cases test the probabilities that a diagnosis would state, in its linear model; with
    --fitted by simulations and full fits. Finished cases of these are kept: the same command continues.
    """
    if fitted and cases is None:
        raise InputError("needs --calibrate, the number of cases", field="--fitted")
    from tyrefem.api import study as load
    from tyrefem.diagnose.blind.fitted_cases import fitted_cases
    from tyrefem.diagnose.blind.kept_cases import CASES
    from tyrefem.diagnose.forward.evaluations import ProgressStore
    from tyrefem.diagnose.layout.calibration import calibrated
    from tyrefem.diagnose.layout.isolability import isolability as found_by
    from tyrefem.diagnose.layout.planned_runs import NEEDS, planned_sensitivities
    from tyrefem.inputs.origin import StudyOrigin
    from tyrefem.output import SUMMARY, atomic_folder, jsonable, write_json
    from tyrefem.reports.calibration import save
    from tyrefem.reports.isolability import picture
    from tyrefem.variants.answer_store import PROGRESS

    loaded = load(study, settings(changes), case)
    NEEDS.check(loaded)
    warn(loaded.warnings)
    count = workers or min(usable_cores(), 4)
    place = out or Path("results") / f"{loaded.name}-isolability"
    origin = StudyOrigin(loaded, simulated=True, random_seed=None if cases is None else seed)
    keeps = ["cases/*.json", f"{PROGRESS}/*/*.npz"]
    with results_folder(place, "isolability", FILES, origin=origin, force=force, keeps=keeps) as folder:
        store = ProgressStore(folder / PROGRESS)
        with keeping(lambda: store.kept):
            with progress(f"{loaded.name}: sensitivities", 1.0) as step:
                known = planned_sensitivities(
                    loaded, workers=count, progress=lambda _what, done, total: step(done / max(total, 1)), store=store
                )
            with progress(f"{loaded.name}: effects against each other", 1.0) as step:
                result = found_by(loaded, known=known, progress=lambda _what, done, total: step(done / max(total, 1)))
            calibration = None
            if cases is not None:
                with progress(f"{loaded.name}: {cases} {'fitted' if fitted else 'quick'} cases", 1.0) as step:
                    tick, by_fits = lambda done: step(done / cases), None
                    if fitted:
                        by_fits = fitted_cases(loaded, known, cases, seed, folder / CASES, count, tick)
                    calibration = calibrated(loaded, known, cases, seed, tick, by_fits)
            write_json(origin.using(list(result.plugins)).summary(), folder / SUMMARY)
            with atomic_folder(folder) as temporary:
                result.table.to_csv(temporary / "isolability.csv", index=False, lineterminator="\n")
                text = json.dumps(jsonable(result.to_dict()), indent=1, ensure_ascii=False, allow_nan=False)
                (temporary / "isolability.json").write_text(text + "\n", encoding="utf-8")
                (temporary / "isolability.png").write_bytes(picture(result))
                if calibration is not None:
                    save(calibration, temporary)
        store.clear()
    answer_with(result.to_dict() | ({} if calibration is None else {"calibration": calibration.to_dict()}))
    for line in [*result.words(), *([] if calibration is None else calibration.words())]:
        say(line)
    say(f"results in {folder}")


#: Place among the commands.
ORDER = 26


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(isolability)
