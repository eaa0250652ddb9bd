"""Requirements of a question on a study, checked before any computation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from tyrefem.errors import InputError

#: Number of case names in an error.
LISTED = 5


@dataclass(frozen=True)
class Requirements:
    """Requirements of a question on a study; the study must have a single drive, not a table of cases.

    Parameters
    ----------
    question : the question as the subject of a sentence, e.g. "a diagnosis".
    measured : measured runs are needed: from a given table, or from the study's ``[[measured]]`` entries.
    fitted : at least one of the study's ``[[measured]]`` entries must not be held out.

    >>> from tyrefem import study
    >>> Requirements("a diagnosis", measured=True).check(study("nasa-22x5.5-8pr"))
    Traceback (most recent call last):
    ...
    tyrefem.errors.InputError: ...measured: the study has no [[measured]] entry; a diagnosis needs measured runs: ...
    """

    question: str
    measured: bool = False
    fitted: bool = False

    def check(self, study: Any, table: object = None) -> None:
        """Check a study for the question; ``table``: measured runs given in addition to the study.

        Raises
        ------
        InputError : a campaign; no measured runs; all runs held out. It names the file, the field, and the remedy.
        """
        # A comparison accepts any object that runs and has sensors; only a study has cases.
        if getattr(study, "is_campaign", False):
            raise self._campaign(study)
        if table is not None:
            return
        if self.measured and not study.measured:
            message = (
                f"the study has no [[measured]] entry; {self.question} needs measured runs: add one, or name a table"
            )
            raise InputError(message, field="measured", file=getattr(study, "file", None))
        if self.fitted and study.measured:
            self.check_fitted(study, [entry.hold_out for entry in study.measured])

    def check_fitted(self, study: Any, held_out: Sequence[bool]) -> None:
        """Check that not all runs are held out; ``held_out``: a flag for each run.

        Raises
        ------
        InputError : all runs are held out.
        """
        if all(held_out):
            which = "the only run is" if len(held_out) == 1 else f"all {len(held_out)} runs are"
            message = f"{which} held out, and {self.question} needs one that is not: set hold_out = false in an entry"
            raise InputError(message, field="measured.hold_out", file=study.file)

    def _campaign(self, study: Any) -> InputError:
        names = study.case_names
        listing = ", ".join(names[:LISTED]) + (f", ... ({len(names)} in all)" if len(names) > LISTED else "")
        return InputError(
            f"the study is a campaign, and {self.question} takes one case of it: --case NAME "
            f"(in a sweep file: case = NAME; in Python: study.case(NAME)); its cases: {listing}",
            field="cases",
            file=study.file,
        )
