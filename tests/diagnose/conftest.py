"""One small case for every test: a hot road is hidden, and the diagnosis was interrupted once."""

from __future__ import annotations

import os
import pickle
import shutil
from pathlib import Path
from typing import Any

import pytest
from filelock import FileLock
from hidden import FINISHED, WARMER, Case, measure, study

from tyrefem.diagnose.data.sensitivities import Sensitivities
from tyrefem.diagnose.forward import evaluations
from tyrefem.diagnose.forward.evaluations import Evaluations, ProgressStore
from tyrefem.diagnose.forward.forward_model import ForwardModel
from tyrefem.diagnose.layout.planned_runs import layout_sensitivities, planned


@pytest.fixture(scope="session")
def case(tmp_path_factory: pytest.TempPathFactory) -> Case:
    """Hot road, three runs, one of them held out. Of tests side by side, the first that asks for it computes it."""
    if "PYTEST_XDIST_WORKER" not in os.environ:
        return hot_road(tmp_path_factory.mktemp("hidden"))
    shared = tmp_path_factory.getbasetemp().parent / "hot-road.pickle"
    with FileLock(f"{shared}.lock"):
        if shared.exists():
            # Written by another process of these tests.
            stored: Case = pickle.loads(shared.read_bytes())
            return stored
        made = hot_road(tmp_path_factory.mktemp("hidden"))
        shared.write_bytes(pickle.dumps(made))
        return made


def hot_road(folder: Path) -> Case:
    """The case, computed in a folder."""
    owner = study(folder / "study")
    measure(owner, [{"name": "hot-road", "warmer_by": f"{WARMER} delta_degC"}])
    computed: list[int] = []
    response = ForwardModel.response

    def spied(model: ForwardModel, number: int, unknowns: Any) -> Any:
        computed.append(number)
        return response(model, number, unknowns)

    def interrupted(what: str, done: int, total: int) -> None:
        if what == "sensitivities" and done == FINISHED:
            raise KeyboardInterrupt

    store = ProgressStore(folder / "progress")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(ForwardModel, "response", spied)
        # Both tries begin as a new process does: full runs that another test made are not in memory.
        evaluations._HISTORIES.clear()
        with pytest.raises(KeyboardInterrupt):
            owner.diagnose(largest=1, looks=2, store=store, progress=interrupted)
        first = len(computed)
        evaluations._HISTORIES.clear()
        diagnosis = owner.diagnose(largest=1, looks=2, store=store)
    resumed = store.resumed
    kept = Path(shutil.copytree(folder / "progress", folder / "kept"))
    shutil.copytree(folder / "progress-2", folder / "kept-2")
    store.clear()
    diagnosis.save(folder / "out")
    return Case(owner, diagnosis, folder / "out", computed[:first], computed[first:], kept, resumed)


@pytest.fixture(scope="module")
def known(case: Case) -> Sensitivities:
    """The study's planned runs, with the responses that the diagnosis of the same study found."""
    study = case.study
    sensors = [sensor_series.sensor for sensor_series in case.diagnosis.gap.runs[0].sensors]
    model = ForwardModel(study, planned(study, sensors))
    return layout_sensitivities(Evaluations(model), case.diagnosis.gap.responses)
