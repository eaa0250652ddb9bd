"""The contents of `plan.json`: a plan as plain data for programs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from tyrefem.inputs.study_plugins import plugin_summary
from tyrefem.output import jsonable, versions
from tyrefem.plan.words import plan_words

if TYPE_CHECKING:
    from tyrefem.plan.steps import PlanData


def record(plan: PlanData) -> dict[str, Any]:
    """The plan in SI units, gains in nats; NaN becomes null. ``after``: the earlier verdict, null before a test."""
    contents = {
        "study": plan.study,
        "after": plan.beliefs.verdict or None,
        "summary": plan_words(plan),
        "sets": [{"effects": entry.key, "probability": entry.probability} for entry in plan.beliefs.sets],
        "doubt_nats": plan.doubt,
        "steps": [step.to_dict() for step in plan.steps],
        "candidates": plan.candidates.astype(object).to_dict(orient="records"),
        "notes": list(plan.notes),
        "wall_time_s": plan.seconds,
        "versions": versions(),
        **plugin_summary(plan.beliefs.study, [member.name for entry in plan.beliefs.sets for member in entry.members]),
    }
    plain: dict[str, Any] = jsonable(contents)
    return plain
