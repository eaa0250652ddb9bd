"""Rms of measured - computed in words: of the original study, and what the amended study makes of it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tyrefem.diagnose.diagnosis import DiagnosisData


def gap_clause(d: DiagnosisData) -> str:
    """Rms of the original study's deviation, and the noise."""
    parts = [f"{value:.1f} K in the {_name(held_out)} runs" for held_out, value in _finite(d)]
    return f"rms {' and '.join(parts)}, noise {d.noise:.1f} K"


def gap_words(d: DiagnosisData) -> str:
    """The rms of the original study: "5.2 K fitted, 4.8 K held out"."""
    return ", ".join(f"{value:.1f} K {'held out' if held_out else 'fitted'}" for held_out, value in _finite(d))


def closed_clause(d: DiagnosisData) -> str:
    """What the amended study makes of the deviation: of the held-out runs if there are any."""
    held_out = bool(d.gap.held_out)
    name = _name(held_out)
    before, after = (d.rms(after=after, held_out=held_out) for after in (False, True))
    checked = "" if held_out else "; no run is held out, so nothing checks it independently"
    if not d.changes:
        return f"measured - computed is {before:.1f} K rms in the {name} runs, noise {d.noise:.1f} K{checked}"
    by = "the amended study brings" if any(change.missing for change in d.changes) else "corrections bring"
    return f"{by} the {name} runs from {before:.1f} to {after:.1f} K rms, noise {d.noise:.1f} K{checked}"


def closing_sentence(d: DiagnosisData) -> str:
    """What the amended study makes of the deviation, in the fitted and the held-out runs: the end of a paragraph."""
    if not d.changes:
        return f"The rms of measured - computed is {gap_words(d)}; the noise is {d.noise:.1f} K."
    parts = [
        f"from {before:.1f} to {d.rms(after=True, held_out=held_out):.1f} K on the {_name(held_out)} runs"
        for held_out, before in _finite(d)
    ]
    amended = d.best.members or any(change.missing for change in d.changes)
    study = "In the amended study" if amended else "With corrections of base numbers and sensors alone"
    changes = " and ".join(parts)
    unchecked = "" if d.gap.held_out else " No run is held out, so no run checks the fit independently."
    return f"{study} the rms of measured - computed changes {changes}; the noise is {d.noise:.1f} K.{unchecked}"


def _name(held_out: bool) -> str:
    return "held-out" if held_out else "fitted"


def _finite(d: DiagnosisData) -> list[tuple[bool, float]]:
    """(held out, rms of the original study in K) of the fitted and of the held-out runs, if there are such runs."""
    values = [(held_out, d.rms(after=False, held_out=held_out)) for held_out in (False, True)]
    return [(held_out, value) for held_out, value in values if math.isfinite(value)]
