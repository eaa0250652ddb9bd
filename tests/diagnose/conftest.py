"""One small case for every test: a hot road is hidden, and the diagnosis was interrupted once."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import pytest
from hidden import FINISHED, WARMER, Case, measure, study

from tyrefem.diagnose.forward import evaluations
from tyrefem.diagnose.forward.evaluations import ProgressStore
from tyrefem.diagnose.forward.forward_model import ForwardModel


@pytest.fixture(scope="session")
def case(tmp_path_factory: pytest.TempPathFactory) -> Case:
    """Hot road, three runs, one of them held out."""
    folder = tmp_path_factory.mktemp("hidden")
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
