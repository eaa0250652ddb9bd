"""Does a test plan lead to the right name? Confounded blind cases, continued by plan and at random.

    python benchmarks/plan.py --seed 2 --cases 3 --out results/plan               # every layout: about a minute a case
    python benchmarks/plan.py --layouts four --seed 1 --cases 40 --out results/plan-four
    python benchmarks/plan.py --layouts four --linear --out results/plan-linear   # verdicts without fits

The tyre is the 22x5.5 8PR. The layouts of `benchmarks/plan_layouts.py` differ in thermocouples, first runs and
competing effects; the contained air is always read. A case hides one effect, wrong base numbers and displaced sensors
in synthetic data, from another mesh and time integration. It counts if the first verdict is "confounded". The next run
is chosen by `tyrefem plan` and simulated with the hidden cause; all runs are diagnosed again; both up to twice. Then
the same case gets runs at random from the same drives, up to two. Of each hidden effect at most two cases of a layout
count, so that no pair fills it. Every finished case is written at once, and the same command goes on.
`benchmarks/plan_table.py` makes the tables.
"""

from __future__ import annotations

import argparse
import itertools
import json
import math
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from plan_layouts import LAYOUTS, LayoutChoice
from scipy.stats import chi2

import tyrefem as tf
from tyrefem.compare.experiment import experiments
from tyrefem.diagnose.blind.blind_case import BlindCase
from tyrefem.diagnose.blind.synthetic import Logger, record
from tyrefem.diagnose.data.residuals import residuals_of
from tyrefem.diagnose.data.runs import measured_drive
from tyrefem.diagnose.data.sensitivities import Sensitivities, responses, sensitivities, unknowns_of
from tyrefem.diagnose.forward.drive_response import DriveResponse
from tyrefem.diagnose.forward.evaluations import Evaluations
from tyrefem.diagnose.forward.forward_model import ForwardModel
from tyrefem.diagnose.forward.sampling import DriveSampling, SensorSampling
from tyrefem.diagnose.inference.evidence import posterior
from tyrefem.diagnose.inference.linear_model import LinearModel
from tyrefem.diagnose.layout.isolability import MARGIN, competitors_of, margins
from tyrefem.diagnose.options import SimulationWork
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns.candidates import Members, SetPrior, catalogue_candidates
from tyrefem.diagnose.unknowns.unknown import base_unknowns, sensor_unknowns, with_values
from tyrefem.diagnose.verdicts.verdict import CONFOUNDED, IDENTIFIED, NO_GAP, UNEXPLAINED
from tyrefem.diagnose.words.set_posteriors import SetPosterior
from tyrefem.diagnose.workflow import diagnose
from tyrefem.effects import catalogue
from tyrefem.errors import InputError
from tyrefem.measured import MeasuredRun
from tyrefem.plan.batch import greedy_batch
from tyrefem.plan.beliefs import Beliefs
from tyrefem.plan.drives import CandidateDrive, candidate_drives
from tyrefem.plan.readings import planned_readings
from tyrefem.plan.workflow import plan
from tyrefem.simulation.surroundings import GAS

#: Files of finished cases: name-LAYOUT-SEED.jsonl.
FILES = ("cases", "random")
#: Most further runs: by plan, and at random.
PLANNED, RANDOM = 2, 2
#: Amplitudes, prior standard deviations (log-uniform).
AMPLITUDES = (0.7, 3.0)
#: A case is tried if the linear model sees the effect by this lead, nats, and another effect is closer than `CLOSE`.
SEEN, CLOSE = 6.0, 2.5
#: Largest number of draws of a layout.
DRAWS = 1500
SETTINGS = DiagnosisSettings(mesh_size="5 mm", largest=2, looks=1)


@dataclass(frozen=True, eq=False)
class Layout:
    """The study, the drives of a plan, and the response of each, computed once."""

    name: str
    choice: LayoutChoice
    study: tf.Study
    drives: tuple[CandidateDrive, ...]
    known: tuple[DriveResponse, ...]
    sensitive: Sensitivities
    evaluations: Evaluations
    data_mesh: dict[str, str]


def study_of(choice: LayoutChoice, drives: int) -> tf.Study:
    """The study with its limits; a measured entry for every drive and its repetitions."""
    shipped = tf.study("hidden-effect")
    changes: dict[str, Any] = {
        "title": "A few thermocouples",
        "drive": choice.drive,
        "sensors": {name: shipped.data["sensors"][name] for name in choice.sensors},
        "diagnosis": {"exclude": sorted(name for name in catalogue() if name not in choice.effects)},
        "plan": {
            "limits": {
                "drive.speed": ["10 mph", "30 mph"],
                "drive.load": ["2000 lbf", "4000 lbf"],
                "drive.pressure": ["66 psi", "100 psi"],
            },
            "drives": drives,
            "runs_most": 1,
            "sensors_most": 0,
        },
        "measured": [],
    }
    study = shipped.replace(changes)
    entries = [
        {"table": "none.csv", "run": run_name(number, again), "drive": drive.changes}
        for number, drive in enumerate(candidate_drives(study))
        for again in range(RANDOM + 1)
    ]
    return study.replace({"measured": entries})


def run_name(drive: int, again: int) -> str:
    """Name of a run: number of its drive, and how often that was run before."""
    return f"drive {drive}, {again}"


def layout_of(name: str, drives: int, data_mesh: dict[str, str]) -> Layout:
    """Responses of all drives to all unknowns."""
    choice = LAYOUTS[name]
    study = study_of(choice, drives)
    tried = candidate_drives(study)
    names = [*study.sensors, GAS]
    unknowns, nuisance = unknowns_of(study, set(names), catalogue_candidates(study), SETTINGS)
    times = np.arange(0.0, study.card.drive.end + 5.0, 10.0)
    samplings = tuple(
        DriveSampling(
            run_name(number, 0),
            dict(drive.changes),
            False,
            tuple(SensorSampling(sensor, times, 0.5, 0.1, 120.0) for sensor in names),
        )
        for number, drive in enumerate(tried)
    )  # fmt: skip
    evaluations = Evaluations(ForwardModel(study, samplings, settings=SETTINGS))
    known = responses(evaluations, unknowns)
    sensitive = sensitivities(samplings, unknowns, nuisance, known)
    return Layout(name, choice, study, tried, known, sensitive, evaluations, data_mesh)


def drawn_case(layout: Layout, number: int, seed: int) -> BlindCase:
    """A case: one hidden effect, base numbers and sensors from their priors."""
    seed += 1000 * list(LAYOUTS).index(layout.name)
    rng = np.random.default_rng([seed, number])
    candidates = catalogue_candidates(layout.study)
    member = candidates[int(rng.integers(len(candidates)))]
    values = {
        unknown: float(np.clip(rng.normal(0.0, unknown.sd), 0.95 * unknown.low, 0.95 * unknown.high))
        for unknown in (*base_unknowns(layout.study), *sensor_unknowns(layout.study, set(layout.study.sensors)))
    }
    for unknown in member.amplitudes:
        size = unknown.sd * math.exp(rng.uniform(*np.log(AMPLITUDES)))
        side = rng.choice([-1.0, 1.0]) if unknown.low < 0 < unknown.high else 1.0
        values[unknown] = float(np.clip(side * size, 0.95 * unknown.low, 0.95 * unknown.high))
    return BlindCase(number, seed, "one", (member,), values)


def leads(layout: Layout, case: BlindCase, numbers: Sequence[int]) -> tuple[float, float, str]:
    """Lead of the hidden effect over no effect, and over the closest other effect, without noise, nats; its key."""
    hidden = {unknown: case.values[unknown] for unknown in case.hidden[0].amplitudes}
    model, sensitive = layout.evaluations.model, layout.sensitive
    signal = np.concatenate(
        [sensitive.drives[i].whitened(model.predict(i, hidden) - model.predict(i, {})) for i in numbers]
    )
    candidates = catalogue_candidates(layout.study)
    prior = SetPrior(candidates, layout.study.card.diagnosis.effects_expected)
    linear = LinearModel(sensitive.design(numbers), signal)
    competitors = competitors_of(case.hidden, candidates)
    none, *others = margins(linear, signal, case.hidden, competitors, prior)
    closest = int(np.argmin(others))
    return none, others[closest], key_of_set(competitors[1 + closest])


def measured(layout: Layout, case: BlindCase, name: str, drive: int) -> MeasuredRun:
    """A run as a logger records it, with the hidden cause."""
    rng = np.random.default_rng([case.seed, case.number, *name.encode()])
    driven = layout.study.at_run(name, layout.drives[drive].changes)
    return record(with_values(driven, case.values).replace(layout.data_mesh), name, Logger(), rng)


@dataclass(frozen=True, eq=False)
class Verdict:
    """A verdict, the best set, its probability, the sets, and what a plan needs to know."""

    verdict: str
    best: Members
    probability: float
    sets: dict[str, float]
    knowledge: Any


class Course:
    """The runs of a case so far, and the verdicts by `tyrefem.diagnose`."""

    def __init__(self, layout: Layout, case: BlindCase) -> None:
        self.layout, self.case = layout, case
        self.drives: list[int] = []
        self.runs: list[MeasuredRun] = []
        self.rows: list[dict[str, Any]] = []

    def measure(self, drive: int) -> None:
        """Make a run."""
        name = run_name(drive, self.drives.count(drive))
        self.drives.append(drive)
        self.runs.append(measured(self.layout, self.case, name, drive))

    def begin(self) -> None:
        """Make the first runs."""
        for drive in self.layout.choice.first:
            self.measure(drive)

    @property
    def known(self) -> list[DriveResponse]:
        """Responses of the runs."""
        return [self.layout.known[number] for number in self.drives]

    @property
    def further(self) -> int:
        """Number of runs after the first ones."""
        return len(self.drives) - len(self.layout.choice.first)

    def add(self, drive: int) -> Verdict:
        """Make a run, and diagnose all runs."""
        self.measure(drive)
        return self.diagnosed()

    def diagnosed(self) -> Verdict:
        """Diagnose all runs."""
        verdict = self.judged(self.known)
        right = {member.key for member in verdict.best} == set(self.case.names)
        self.rows.append(
            {
                "drive": self.layout.drives[self.drives[-1]].name,
                "verdict": verdict.verdict,
                "best": key_of_set(verdict.best),
                "probability": verdict.probability,
                "right": bool(right and verdict.verdict == IDENTIFIED),
            }
        )
        return verdict

    def judged(self, known: list[DriveResponse]) -> Verdict:
        """The verdict on all runs."""
        diagnosis = diagnose(self.layout.study, self.runs, known=known, settings=SETTINGS, rerun=False)
        judgement = diagnosis.judgement
        sets = {entry.key: entry.probability for entry in judgement.ranking[:4]}
        return Verdict(diagnosis.verdict, judgement.best.members, judgement.probability, sets, diagnosis)

    def proposed(self, verdict: Verdict) -> tuple[int, float]:
        """Number of the drive that the plan proposes, and the expected probability of the true set after it."""
        proposal = plan(self.layout.study, verdict.knowledge, settings=SETTINGS, known=self.layout.known)
        if proposal.steps and proposal.steps[0].drive is not None:
            return self.layout.drives.index(proposal.steps[0].drive), proposal.steps[0].right
        return (proposal.compared[0].drive or 0) if proposal.compared else 0, math.nan

    @property
    def ended(self) -> bool:
        """Whether an effect is named."""
        return bool(self.rows) and self.rows[-1]["verdict"] == IDENTIFIED


def linear_verdict(course: Course, known: list[DriveResponse]) -> Verdict:
    """The verdict on all runs of a course by the linear model about x = 0."""
    study = course.layout.study
    runs = tuple(measured_drive(each, study, SETTINGS) for each in experiments(study, course.runs))
    of_layout = course.layout.sensitive
    sensitive = sensitivities([run.sampling for run in runs], of_layout.unknowns, of_layout.nuisance, known)
    linear = residuals_of(study, runs, sensitive, SETTINGS).linear(range(len(runs)))
    candidates = catalogue_candidates(study)
    prior = SetPrior(candidates, study.card.diagnosis.effects_expected)
    singles = [(candidate,) for candidate in candidates]
    sets: list[Members] = [(), *singles, *itertools.combinations(candidates, 2)]
    score = np.array([prior(members) + linear.log_evidence(members) for members in sets])
    p = np.exp(score - score.max())
    p /= p.sum()
    order = np.argsort(-p)
    best = sets[order[0]]
    acts = float(sum(share for share, members in zip(p, sets, strict=True) if set(best) <= set(members)))
    misfit = chi2.sf(linear.least_misfit(best), len(linear.data))
    if misfit < SETTINGS.rejected_p:
        verdict = UNEXPLAINED
    elif not best:
        verdict = NO_GAP
    elif acts >= SETTINGS.named_probability and p[order[0]] >= SETTINGS.alone_probability:
        verdict = IDENTIFIED
    else:
        verdict = CONFOUNDED
    posteriors = tuple(_set_posterior(linear, sets[i], float(p[i] / p[order[:12]].sum())) for i in order[:12])
    noise = {sensor.sensor: sensor.noise for sensor in runs[0].sensors}
    beliefs = Beliefs(study, posteriors, noise)
    return Verdict(verdict, best, acts, {key_of_set(sets[i]): float(p[i]) for i in order[:4]}, beliefs)


class LinearCourse(Course):
    """The same with verdicts by the evidence of the linear model about x = 0: all single effects and pairs, no fits."""

    def judged(self, known: list[DriveResponse]) -> Verdict:
        """The verdict on all runs."""
        return linear_verdict(self, known)

    def proposed(self, verdict: Verdict) -> tuple[int, float]:
        """Number of the drive that the plan proposes, and the expected probability of the true set after it."""
        layout = self.layout
        readings = planned_readings(
            verdict.knowledge,
            layout.study,
            layout.drives,
            (),
            settings=SETTINGS,
            work=SimulationWork(known=layout.known),
        )
        search = greedy_batch(readings, layout.drives, (), layout.study.card.plan)
        entry = (search.chosen or search.compared)[0]
        return entry.drive or 0, entry.information.right


def _set_posterior(linear: LinearModel, members: Members, probability: float) -> SetPosterior:
    """The Gaussian of a set's unknowns in the linear model."""
    design = linear.design
    unknowns = (*design.unknowns[: design.nuisance], *(u for member in members for u in member.amplitudes))
    J = linear.jacobian[:, design.columns(unknowns)]
    sd, low, high = (np.array([getattr(unknown, name) for unknown in unknowns]) for name in ("sd", "low", "high"))
    fit = posterior(J.T @ J, J.T @ linear.data, sd, low, high)
    return SetPosterior(members, probability, unknowns, fit.mean, fit.covariance)


def key_of_set(members: Members) -> str:
    """The members' keys."""
    return " + ".join(sorted(member.key for member in members)) or "no effect"


def followed(course: Course, verdict: Verdict) -> tuple[list[Any], list[float]]:
    """The verdicts along the plan, one run at a time, and the expected probability that each plan stated."""
    expected: list[float] = []
    while not course.ended and course.further < PLANNED:
        drive, right = course.proposed(verdict)
        expected.append(right)
        verdict = course.add(drive)
    return course.rows[1:], expected


def at_random(course: Course) -> list[Any]:
    """The verdicts along random drives after the same first run."""
    rng = np.random.default_rng([course.case.seed, course.case.number, 7])
    course.begin()
    while not course.ended and course.further < RANDOM:
        course.add(int(rng.integers(len(course.layout.drives))))
    return course.rows


def written(file: Path) -> list[dict[str, Any]]:
    """The rows of an earlier attempt."""
    return [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()] if file.is_file() else []


def write_row(file: Path, row: dict[str, Any]) -> None:
    """Add a row, and print it."""
    with file.open("a", encoding="utf-8") as stream:
        stream.write(json.dumps(row) + "\n")
    courses = [[step["best"] for step in row[name]] for name in ("plan", "random") if name in row]
    print(row["number"], row["hidden"], row.get("verdict", ""), courses, f"{row['processor_s']:.0f} s", flush=True)


def planned_case(course: Course, lead: float, rival: str) -> dict[str, Any]:
    """The first verdict of a case after its first runs, and the verdicts along the plan if it is "confounded"."""
    start, case, layout = time.process_time(), course.case, course.layout
    verdict = course.diagnosed()
    row: dict[str, Any] = {
        "number": case.number,
        "hidden": case.names,
        "amplitude": [case.values[unknown] / unknown.sd for unknown in case.hidden[0].amplitudes],
        "lead": lead,
        "rival": rival,
        "verdict": verdict.verdict,
        "sets": verdict.sets,
    }
    if verdict.verdict == CONFOUNDED:
        row["identifiable"] = bool(min(leads(layout, case, range(len(layout.drives)))[:2]) >= MARGIN)
        row["plan"], row["expected"] = followed(course, verdict)
    return row | {"processor_s": time.process_time() - start}


def drawn(
    layout: Layout, rows: list[dict[str, Any]], seed: int, kind: type[Course]
) -> Iterator[tuple[Course, float, str]]:
    """The next cases of a layout after their first runs; with lead over the closest other effect, and its key.

    The first runs see the hidden effect, and another one is close. If the layout is screened, the linear model finds
    the noisy data confounded too, which takes a second where a diagnosis takes ten.
    """
    for number in range(max((row["number"] for row in rows), default=-1) + 1, DRAWS):
        case = drawn_case(layout, number, seed)
        hidden = Counter(row["hidden"][0] for row in rows if row["verdict"] == CONFOUNDED)
        if hidden[case.names[0]] >= layout.choice.alike:
            continue
        try:
            none, other, rival = leads(layout, case, layout.choice.first)
        except InputError:  # the effect cannot act in this drive
            continue
        if none < SEEN or other > CLOSE:
            continue
        course = kind(layout, case)
        course.begin()
        if not layout.choice.screened or linear_verdict(course, course.known).verdict == CONFOUNDED:
            yield course, other, rival


def run_layout(name: str, kind: type[Course], given: argparse.Namespace, is_left: Callable[[], bool]) -> None:
    """The cases of a layout, by plan and at random."""
    mesh = {"mesh.mesher": "mapped", "mesh.cell": "tri", "mesh.element": "P2", "mesh.size": given.data_mesh}
    files = [given.out / f"{each}-{name.replace(', ', '-').replace(' ', '-')}-{given.seed}.jsonl" for each in FILES]
    rows = written(files[0])
    began = time.process_time()
    layout = layout_of(name, given.drives, mesh)
    print(f"{name}: {len(layout.drives)} drives, {time.process_time() - began:.0f} processor seconds", flush=True)
    wanted = drawn(layout, rows, given.seed, kind)
    while sum(row["verdict"] == CONFOUNDED for row in rows) < given.cases and is_left():
        course, lead, rival = next(wanted, (None, 0.0, ""))
        if course is None:
            break
        rows.append(planned_case(course, lead, rival))
        write_row(files[0], rows[-1])
    if given.planned_only:
        return
    finished = {row["number"] for row in written(files[1])}
    for number in [row["number"] for row in rows if row["verdict"] == CONFOUNDED and row["number"] not in finished]:
        if not is_left():
            break
        start, case = time.process_time(), drawn_case(layout, number, given.seed)
        row = {"number": number, "hidden": case.names, "random": at_random(kind(layout, case))}
        write_row(files[1], row | {"processor_s": time.process_time() - start})


def main() -> None:
    """Run, and write every finished case."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=5, help="Confounded cases of each layout.")
    parser.add_argument("--seed", type=int, default=2)
    parser.add_argument("--layouts", nargs="+", choices=LAYOUTS, default=[name for name in LAYOUTS if name != "four"])
    parser.add_argument("--drives", type=int, default=9)
    parser.add_argument("--data-mesh", default="4 mm", help="Mesh of the synthetic data: triangles, quadratic.")
    parser.add_argument("--minutes", type=float, default=600.0, help="No case begins after this time.")
    parser.add_argument("--linear", action="store_true", help="Verdicts by the linear model: seconds a case.")
    parser.add_argument("--planned-only", action="store_true", help="The same command without it adds random plans.")
    parser.add_argument("--out", type=Path, default=Path("results/plan"))
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    end = time.monotonic() + 60 * given.minutes
    for name in given.layouts:
        run_layout(name, LinearCourse if given.linear else Course, given, lambda: time.monotonic() < end)


if __name__ == "__main__":
    main()
