"""What to do next in words: an experiment, the rest that no effect explains, the draft effect."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tyrefem.diagnose.beside.discrepancy import ENERGY, READINGS
from tyrefem.diagnose.words.draft_effect import EFFECTS, draft_effects
from tyrefem.diagnose.words.missing_heat import heat_before_errors

if TYPE_CHECKING:
    from tyrefem.diagnose.diagnosis import DiagnosisData


def next_words(d: DiagnosisData) -> str:
    """The best next experiment in one sentence; empty without a proposal."""
    if not d.next_experiment:
        return ""
    sensor = next(iter(d.next_experiment.get("sensors", ())), None)
    drive = next(iter(d.next_experiment.get("drives", ())), None)
    odds = 1.0
    offers = []
    if sensor and sensor["gain"] > odds:
        offers.append(f"a thermocouple at {sensor['place']} (difference up to {sensor['largest_K']:.1f} K)")
    if drive and drive["gain"] > odds:
        offers.append(f"a run at {drive['drive']} (difference up to {drive['largest_K']:.1f} K, {drive['sensor']})")
    between = " and ".join(f"“{key}”" for key in d.next_experiment["between"])
    if not offers:
        return f"No tested sensor place or drive would distinguish {between}."
    sentence = f"{' or '.join(offers)} would best distinguish {between}."
    return sentence[0].upper() + sentence[1:]


def rest_clause(d: DiagnosisData) -> str:
    """How to go on with what no effect explains: by strain laws, stated errors, or the draft effect; else empty."""
    leading = d.robustness.models[0] if d.robustness is not None else None
    if leading is not None and leading.name == ENERGY:
        return "compare strain laws and tan delta where the heat differs (tyrefem strain STUDY)"
    if leading is not None and leading.name == READINGS and not leading.refuted and not heat_before_errors(d):
        return (
            f"state such errors if readings or model may have them (discrepancy in [diagnosis], about {leading.size:g} "
            "K), and diagnose again"
        )
    files = list(draft_effects(d))
    if not files:
        return ""
    return f"judge the draft {files[0]}: tyrefem diagnose STUDY --effects FOLDER/{EFFECTS}, FOLDER that of the results"


def draft_words(d: DiagnosisData) -> tuple[str, ...]:
    """Where the draft effect is, and how it is judged; empty without a law that holds."""
    return tuple(
        f"A draft with this law is in {EFFECTS}/{name} in the folder of the results: check it, then diagnose again "
        f"with --effects FOLDER/{EFFECTS}."
        for name in draft_effects(d)
    )
