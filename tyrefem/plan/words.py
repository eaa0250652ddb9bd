"""The plan in sentences."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tyrefem.diagnose.numbers import percent
from tyrefem.plan.drives import CandidateDrive, quantity_name
from tyrefem.plan.information import NAMED

if TYPE_CHECKING:
    from tyrefem.plan.steps import PlanData, PlanStep

#: Largest number of sets in the first sentence.
SHOWN = 4
#: What to do where only a cause outside the catalogue is left: a plan compares sets of effects.
OUTSIDE = (
    "A plan compares sets of effects, and only a cause outside the catalogue is left. The diagnosis says where and "
    "when its heat is missing. Runs at another speed, load or pressure tell its law; a run that cools at rest tells "
    "heat inside from a flux. Judge the cause as an effect (tyrefem diagnose STUDY --effects FOLDER), then plan again."
)


def plan_words(plan: PlanData) -> list[str]:
    """The remaining sets, a sentence for every step, and notes."""
    pair = bool(plan.beliefs.verdict)
    return [first_words(plan), *(step_words(step, pair=pair) for step in plan.steps), *last_words(plan), *plan.notes]


def first_words(plan: PlanData) -> str:
    """What is to be told apart."""
    sets = plan.beliefs.sets
    if not plan.beliefs.verdict:
        return (
            f"Before any data: no effect, or one of {len(sets) - 1} single effects, with their prior probabilities "
            f"(doubt: {plan.doubt:.2f} nats)."
        )
    shown = ", ".join(f"{entry.key} ({percent(entry.probability)})" for entry in sets[:SHOWN])
    rest = sets[SHOWN:]
    together = percent(sum(entry.probability for entry in rest))
    more = f", and {len(rest)} more ({together}{' together' if len(rest) > 1 else ''})" if rest else ""
    beside = f", beside {' + '.join(plan.beliefs.part)}" if plan.beliefs.part else ""
    return f"After the verdict '{plan.beliefs.verdict}'{beside} these sets are left: {shown}{more}."


def step_words(step: PlanStep, *, pair: bool = True) -> str:
    """A step as a sentence: what to do, what it is expected to tell (``pair``: of the two leading sets), its cost."""
    tells = (
        f"expected to tell {step.between[0]} from {step.between[1]} with {percent(step.pair_probability)}; "
        if pair
        else ""
    )
    tells += f"the true set {'then has' if pair else 'is expected to have'} {percent(step.right)} on average"
    together = f"{step.total_gain:.2f} ± {max(step.sd, 0.01):.2f}"
    return (
        f"{step_name(step)}: {tells} (gain {step.gain:.2f} nats, together {together}; "
        f"cost {step.cost:.3g}, together {step.total_cost:.3g})."
    )


def step_name(step: PlanStep) -> str:
    """ "Run 2: speed 30 mph, load 4000 lbf (1.3 x), 900 s, with a thermocouple ..."."""
    sensor = "" if step.place is None else step.place.words
    if step.drive is None:
        return f"Further {sensor}, in all planned runs"
    added = f", with a further {sensor}" if sensor else ""
    return f"Run {step.run}: {drive_words(step.drive)}{added}"


def drive_words(drive: CandidateDrive) -> str:
    """Values of a drive with their factors on the study's drive, and its duration."""
    parts = []
    for key, value in drive.changes.items():
        ratio = drive.ratios.get(key)
        times = f" ({ratio:.3g} x)" if ratio is not None and abs(ratio - 1) > 0.005 else ""
        parts.append(f"{quantity_name(key)} {value}{times}")
    return ", ".join([*parts, f"{drive.duration:.0f} s"])


def last_words(plan: PlanData) -> list[str]:
    """Why the plan ends."""
    if len(plan.beliefs.sets) < 2 and plan.beliefs.sets[0].outside:
        return [OUTSIDE]
    if len(plan.beliefs.sets) < 2:
        return ["One set is left, so no experiment can tell more."]
    if not plan.steps:
        nothing = "No run within the limits and no further sensor is expected to tell these sets apart."
        return [f"{nothing} Widen the limits."]
    left = plan.doubt - plan.steps[-1].total_gain
    words = [
        f"Doubt between the sets: {plan.doubt:.2f} nats before, {max(left, 0.0):.2f} nats expected after the plan."
    ]
    if plan.steps[-1].right < NAMED:
        least = f"A name needs {percent(NAMED)}; the true set is expected to have {percent(plan.steps[-1].right)}."
        more = "Allow more runs or sensors (runs_most, sensors_most), or wider limits."
        # More runs are allowed already; none of them is worth it.
        ended = "No further run within the limits is expected to tell more: allow wider limits or further sensors."
        words.append(f"{least} {ended if plan.runs_left else more}")
    return words
