"""Finished simulations of a diagnosis, kept on disk, so that an interrupted one takes them up again."""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from tyrefem.answer_store import AnswerStore, digest, effects_source, plain
from tyrefem.output import jsonable
from tyrefem.summary import versions

if TYPE_CHECKING:
    from tyrefem.diagnose.bench import Bench
    from tyrefem.diagnose.trials import Series


@dataclass(eq=False)
class ProgressStore(AnswerStore):
    """Answers of a laboratory by question, in a folder; of one study, its cards, its data and one version only."""

    def open(self, bench: Bench) -> int:
        """Find what was left for this bench, and drop what was left for any other; how many answers there are."""
        return self.take_up(key_of(bench))

    def look(self, number: int) -> ProgressStore:
        """The store of a further look at the same data; this one for the first."""
        return self if number == 0 else ProgressStore(self.folder.with_name(f"{self.folder.name}-{number + 1}"))

    def clear(self) -> None:
        """Remove everything, of further looks too: the diagnosis is done."""
        for folder in (self.folder, *self.folder.parent.glob(f"{self.folder.name}-*")):
            shutil.rmtree(folder, ignore_errors=True)


def key_of(bench: Bench) -> str:
    """Digest of everything that decides a bench's answers: study, cards, effects' source, data, versions.

    >>> from tyrefem.diagnose.bench import Bench
    >>> from tyrefem.studies import study
    >>> one, faster = study("nasa-22x5.5-8pr"), study("nasa-22x5.5-8pr", {"drive.speed": "25 mph"})
    >>> key_of(Bench(one, ())) == key_of(Bench(faster, ()))
    False
    """
    trials = [[one.name, one.drive, one.hold_out, [_series(each) for each in one.series]] for one in bench.trials]
    return digest([versions(), effects_source(), plain(bench.study), jsonable(trials)])


def _series(one: Series) -> list[Any]:
    data = [one.times.tolist(), one.measured.tolist()]
    return [one.sensor, data, one.noise, one.discrepancy, one.correlation_time]
