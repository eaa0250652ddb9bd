"""The link from a report to the page of `tyrefem explore`, or the command that makes it."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from tyrefem.output import TEMPORARY

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData


@dataclass(frozen=True)
class ExploreLink:
    """``address`` : of the page, relative to the report; empty without a page. ``command`` : that makes it."""

    address: str
    command: str


def explore_link(study: StudyData, report: Path) -> ExploreLink | None:
    """The page of a study beside its folder of results; None for studies that have no such page.

    Parameters
    ----------
    report : the file that links, in its folder or in the temporary folder from which it moves there.
    """
    from tyrefem.reports.explore_data import argument

    if study.card.mechanics.feedback is not None or any(phase.slides for phase in study.card.drive.phases):
        return None
    folder = report.absolute().parent
    if folder.name.startswith(TEMPORARY):
        folder = folder.parent
    page = f"{study.name}-explore.html"
    address = next((up + page for up in ("", "../") if (folder / up / page).is_file()), "")
    return ExploreLink(address, f"tyrefem explore {shlex.quote(argument(study))}")
