"""A diagnosis read from its folder: verdict, named effects, readings, amended study."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.api.record import Record
from tyrefem.api.verbs import shown
from tyrefem.diagnose.numbers import percent

if TYPE_CHECKING:
    import pandas as pd

#: Folder of a further look at the same data.
AGAIN = "again"


class DiagnosisRecord(Record):
    """What `tyrefem diagnose` has written. Made by `tyrefem.load`.

    ``verdict``, ``summary`` (contents of ``verdict.json``) and ``study``, the amended study, are those of a `Record`.
    """

    def _title(self) -> str:
        return f"of {self.summary['study']}: {self.verdict}"

    def _facts(self) -> Mapping[str, Any]:
        before, after = self.rms["before"], self.rms["after"]
        facts: dict[str, Any] = {
            "most probable": ", ".join(f"{key} ({percent(share)})" for key, share in list(self.sets.items())[:3]),
            "reasons": " ".join(self.summary["reasons"]),
            "changes": [change["key"] for change in self.summary["changes"]],
            "measured - computed": f"{_kelvin(before['rms_K'])} rms before, {_kelvin(after['rms_K'])} after; "
            f"noise {self.noise:.2f} K",
        }
        if before["held_out_rms_K"] is not None:
            held = (_kelvin(each["held_out_rms_K"]) for each in (before, after))
            facts["held-out runs"] = "{} rms before, {} after".format(*held)
        return facts | {
            "candidates": f"{len(self.candidates)}",
            "folder": str(self.folder),
            **({} if self.complete else {"complete": "False"}),
        }

    def _repr_html_(self) -> str | None:
        from tyrefem.reports.notebook import diagnosis_record_page

        return shown(lambda: diagnosis_record_page(self))

    @property
    def label(self) -> str:
        """The verdict as people read it: "no gap after corrections" if the original study deviates clearly."""
        return str(self.summary.get("label", self.verdict))

    @property
    def headline(self) -> tuple[str, ...]:
        """What is wrong, how sure, and what to do next, a sentence each."""
        return tuple(self.summary["headline"])

    @property
    def words(self) -> tuple[str, ...]:
        """The verdict in more sentences."""
        return tuple(self.summary["summary"])

    @property
    def confidence(self) -> float:
        """Smallest probability of a named effect, also without one sensor or run; NaN without a name."""
        least = self.summary.get("confidence")
        return math.nan if least is None else float(least)

    @property
    def named(self) -> dict[str, float]:
        """Named effect, with its variant and its runs -> probability; empty without a name."""
        from tyrefem.diagnose.unknowns.candidates import key_of

        effects = self.summary["effects"]
        return {key_of(each["name"], each["variant"], each["runs"]): each["probability"] for each in effects}

    @property
    def sets(self) -> dict[str, float]:
        """Set of effects -> probability, the most probable first."""
        return {" + ".join(each["effects"]) or "no effect": each["probability"] for each in self.summary["sets"]}

    @functools.cached_property
    def candidates(self) -> pd.DataFrame:
        """A row per candidate, the most probable first: name, variant, probability, log_evidence, misfit and more."""
        import pandas as pd

        return pd.DataFrame(self.summary["candidates"])

    @functools.cached_property
    def changes(self) -> pd.DataFrame:
        """A row per changed number of the amended study: key, original, value, sd, unit, source and more."""
        import pandas as pd

        return pd.DataFrame(self.summary["changes"])

    @functools.cached_property
    def readings(self) -> pd.DataFrame:
        """``run, hold_out, sensor, time_s, readings, measured_degC, original_degC, amended_degC, noise_K``."""
        return self.table("histories")

    @functools.cached_property
    def where(self) -> pd.DataFrame:
        """Residuals by run, sensor and stretch of time, of the original and of the amended study."""
        return self.table("where")

    @property
    def rms(self) -> dict[str, dict[str, float | None]]:
        """``before`` and ``after`` -> ``rms_K`` and ``held_out_rms_K`` of measured - computed."""
        return {name: self.summary["gap"][name] for name in ("before", "after")}

    @property
    def noise(self) -> float:
        """Root mean square of the readings' noise as the diagnosis uses it, K."""
        return float(self.summary["gap"]["noise_K"])

    @functools.cached_property
    def again(self) -> DiagnosisRecord | None:
        """The further look at the same data; None without, and where it found "no gap": see ``summary["again"]``."""
        folder: Path = self.folder / AGAIN
        return DiagnosisRecord(folder, self.command, self.complete) if (folder / "verdict.json").is_file() else None


def _kelvin(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f} K"
