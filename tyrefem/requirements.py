"""What a question needs of a study: stated by the question, checked before anything is computed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from tyrefem.errors import InputError

#: Names of cases that an error lists.
LISTED = 5


@dataclass(frozen=True)
class Requirements:
    """What a question needs of a study; every question is asked of a single drive, never of a table of cases.

    Parameters
    ----------
    question : the question as the subject of a sentence, e.g. "a diagnosis".
    measured : it needs measured runs: a table that is given, or the study's ``[[measured]]`` entries.
    fitted : where the study has ``[[measured]]`` entries, at least one of them must not be held out.

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
        """Refuse a study that the question cannot be asked of; ``table``: measured runs given beside the study.

        Raises
        ------
        InputError : a campaign; no measured runs; every run held out. It names the file, the field, and what to do.
        """
        # A comparison takes anything that runs and has sensors: only a study has cases.
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
        """Refuse runs that are all held out: ``held_out`` of each.

        Raises
        ------
        InputError : all of them are.
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
