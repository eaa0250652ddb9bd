"""The public classes: a study and its results, with their methods.

Their base classes hold data; each method is one line that calls the package that does the work.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import fields
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from tyrefem.compare import comparison
from tyrefem.diagnose import diagnosis
from tyrefem.fatigue import life as lives
from tyrefem.heating_test import identification
from tyrefem.inputs import study as studies
from tyrefem.mechanics.footprint import natural_frequencies as vibrations
from tyrefem.mechanics.footprint import press as presses
from tyrefem.mechanics.rolling import force_table as force_tables
from tyrefem.mechanics.rolling import press as rolling_press
from tyrefem.mechanics.rolling import roll as rolls
from tyrefem.mechanics.rolling import slip_curve as slip_curves
from tyrefem.mechanics.strain_laws import strain_law
from tyrefem.plan import steps as test_plan
from tyrefem.simulation import result
from tyrefem.sweep import campaign, design

if TYPE_CHECKING:
    from tyrefem.fatigue.places import FailurePlace
    from tyrefem.fatigue.sensitivity import LifeShift
    from tyrefem.geometry import Section
    from tyrefem.heating_test.card import RigCard
    from tyrefem.heating_test.grid import Fineness
    from tyrefem.heating_test.readings import HeatingTest
    from tyrefem.inputs.study_parts import StudyParts
    from tyrefem.measured.cases import Case
    from tyrefem.wear.drive_wear import DriveWear
    from tyrefem.wear.ring_wear import RingWear

Data = TypeVar("Data")


def with_verbs(kind: type[Data], data: Any, **changes: Any) -> Data:
    """Copy data, with some fields changed, to ``kind``: a subclass of the data's class that has methods."""
    return kind(**({field.name: getattr(data, field.name) for field in fields(data)} | changes))


class Result(result.ResultData):
    """Result of a run, with methods to write and plot it."""

    def summary(self) -> dict[str, Any]:
        """Contents of `summary.json`: inputs, versions, mesh, tolerance and main results."""
        from tyrefem.reports.run_files import summary

        return summary(self)

    def to_vtk(self, folder: str | Path, *, revolved: bool = False) -> Path:
        """Write ``<name>.pvd`` and a .vtu per saved time: regions, T, heat source, strain energy."""
        from tyrefem.reports.vtk import write_series

        return write_series(self, Path(folder), revolved=revolved)

    def plot(self, folder: str | Path) -> list[Path]:
        """Write the standard pictures as PNG files."""
        from tyrefem.reports.figures import write_pictures

        return write_pictures(self, Path(folder))

    def report(self, path: str | Path) -> Path:
        """Write one self-contained HTML report."""
        from tyrefem.reports.run import write_report

        return write_report(self, Path(path))

    def save(self, folder: str | Path) -> Path:
        """Write readings, extremes and heat budget as CSV, and ``summary.json``."""
        from tyrefem.reports.run_files import write_tables

        return write_tables(self, Path(folder))


class Campaign(campaign.CampaignData):
    """The cases of a study: each case is a study, whose result can be written and plotted."""

    def outcome(self, case: Case) -> Result | str:
        """The result of a case, or the reason why it failed."""
        outcome = super().outcome(case)
        return outcome if isinstance(outcome, str) else with_verbs(Result, outcome)


class Comparison(comparison.ComparisonData):
    """Deviations of a study from measurements, with `save`."""

    def save(self, folder: str | Path) -> Path:
        """Write tables, pictures and a self-contained page into a folder; return the page's path.

        Raises
        ------
        InputError : the folder cannot be written.
        """
        from tyrefem.reports.comparison import save

        return save(self, folder)


class Diagnosis(diagnosis.DiagnosisData):
    """Result of a diagnosis, with `to_dict` and `save`."""

    @classmethod
    def of(cls, data: diagnosis.DiagnosisData) -> Diagnosis:
        """Convert a diagnosis, and every further look at the same data, to this class."""
        return with_verbs(cls, data, again=None if data.again is None else cls.of(data.again))

    def to_dict(self) -> dict[str, Any]:
        """Contents of `verdict.json`."""
        from tyrefem.diagnose.record import record

        return record(self)

    def save(self, folder: str | Path) -> Path:
        """Write verdict.json, amended.toml, tables, pictures and one self-contained page; return the page's path.

        Raises
        ------
        InputError : the folder cannot be written.
        """
        from tyrefem.reports.diagnosis import save

        return save(self, folder)


class ExperimentPlan(test_plan.PlanData):
    """A plan of the next runs and sensors, with `words` and `save`."""

    @cached_property
    def words(self) -> tuple[str, ...]:
        """The remaining sets, and each step with what it is expected to tell, as sentences."""
        from tyrefem.plan.words import plan_words

        return tuple(plan_words(self))

    def to_dict(self) -> dict[str, Any]:
        """Contents of `plan.json`."""
        from tyrefem.plan.record import record

        return record(self)

    def save(self, folder: str | Path) -> Path:
        """Write plan.csv, plan-candidates.csv, plan.json, plan.png and plan.html; return the page's path.

        Raises
        ------
        InputError : the folder cannot be written.
        """
        from tyrefem.reports.plan import save

        return save(self, folder)


class Design(design.DesignData):
    """The answers to a design study, with `save`."""

    def save(self, folder: str | Path, *, pictures: bool = True) -> Path:
        """Write every table (CSV and Parquet), ``summary.json``, and with pictures the PNG files and ``sweep.html``.

        Raises
        ------
        InputError : the folder cannot be written.
        """
        from tyrefem.reports.sweep_files import save

        save(self, Path(folder), pictures=pictures)
        return Path(folder)


class Identification(identification.IdentificationData):
    """Layers identified from a rig's tables, with `words`, `to_dict` and `save`."""

    @cached_property
    def words(self) -> tuple[str, ...]:
        """Sentences on what the data cannot determine, and on other limits of the result."""
        from tyrefem.heating_test.verdict import sentences

        return sentences(self)

    def to_dict(self) -> dict[str, Any]:
        """Contents of `rig.json`."""
        from tyrefem.heating_test.summary import summary

        return summary(self)

    def save(self, folder: str | Path, base: str | None = None) -> Path:
        """Write JSON, tables, pictures, ``report.html`` and, with a base card, material cards.

        Raises
        ------
        InputError : the folder cannot be written, or the base card does not exist.
        """
        from tyrefem.reports.rig import save

        return save(self, folder, base)


class LoadedTyre(presses.Pressed):
    """A study's tyre, inflated and pressed on the road, with `save`."""

    def save(self, folder: str | Path, at: Iterable[str] = (), *, pictures: bool = True, vtk: bool = True) -> Path:
        """Write the files of `tyrefem press`: ``press.json``, tables, pictures, ``tyre.vtu``; return the folder.

        ``at``: places of the strain cycle, "r, z" or a region; by default the belt's edge and the greatest loss.

        Raises
        ------
        InputError : a place is not in the section; the folder cannot be written.
        """
        from tyrefem.reports.press import write_files
        from tyrefem.reports.press_places import cycle_places

        write_files(self, Path(folder), cycle_places(self, at), self.curve(), pictures=pictures, vtk=vtk)
        return Path(folder)


class NaturalModes(vibrations.NaturalFrequencies):
    """Natural frequencies of a study's inflated tyre, with `save`."""

    def save(self, folder: str | Path, *, pictures: bool = True) -> Path:
        """Write ``modes.csv``, ``modes.json``, and with pictures ``modes.png``; return the folder.

        Raises
        ------
        InputError : the folder cannot be written.
        """
        from tyrefem.reports.modes import write_files

        write_files(self, Path(folder), pictures=pictures)
        return Path(folder)


class Life(lives.LifeData):
    """How long a study's tyre lasts, with `places`, `shifts` and `save`."""

    @property
    def places(self) -> tuple[FailurePlace, ...]:
        """The ten places that fail first, the shortest life first."""
        from tyrefem.fatigue.places import first_places

        return first_places(self)

    @cached_property
    def shifts(self) -> tuple[LifeShift, ...]:
        """The shortest life with 10 % more speed, 10 % more load, 10 % less pressure, 10 K more ambient: four runs."""
        from tyrefem.fatigue.sensitivity import shifts

        return shifts(self)

    def summary(self) -> dict[str, Any]:
        """Contents of `summary.json` without the shifts."""
        from tyrefem.reports.life import summary

        return summary(self)

    def save(self, folder: str | Path, *, sensitivity: bool = False, pictures: bool = True, vtk: bool = True) -> Path:
        """Write the files of `tyrefem life`: ``summary.json``, ``life.csv``, ``life.png``, ``life.vtu``; return the
        folder. ``sensitivity``: also the `shifts`, as ``sensitivity.csv``.

        Raises
        ------
        InputError : the folder cannot be written.
        """
        from tyrefem.reports.life import write_files

        write_files(self, Path(folder), self.shifts if sensitivity else (), pictures=pictures, vtk=vtk)
        return Path(folder)


class RollingWheel(rolls.RolledStudy):
    """A study's tyre in steady rolling with friction, with `save`."""

    def wear(self) -> RingWear:
        """Wear of every ring of the tread, from its friction power; not compared with any measured tread.

        Raises
        ------
        InputError : the card of region ``tread`` has no ``[wear]``.
        """
        from tyrefem.wear.ring_wear import ring_wear

        return ring_wear(self)

    def save(self, folder: str | Path, *, pictures: bool = True, vtk: bool = True) -> Path:
        """Write ``roll.json``, ``contact.csv``, ``rings.csv``, ``contact.vtu``, pictures; return the folder.

        Raises
        ------
        InputError : the folder cannot be written.
        """
        from tyrefem.reports.roll import write_files

        write_files(self, Path(folder), pictures=pictures, vtk=vtk)
        return Path(folder)


class ForcesOverSlip(slip_curves.SlipCurve):
    """Forces of a study's tyre over slip angle or slip, with `save`."""

    def save(self, folder: str | Path, *, pictures: bool = True) -> Path:
        """Write ``roll.json``, ``curve.csv``, and with pictures ``curve.png``; return the folder.

        Raises
        ------
        InputError : the folder cannot be written.
        """
        from tyrefem.reports.roll import write_curve

        write_curve(self, Path(folder), pictures=pictures)
        return Path(folder)


class ForceTable(force_tables.TyreForces):
    """Forces of a study's tyre over load, slip, slip angle and camber, with `save`."""

    def save(self, folder: str | Path, *, pictures: bool = True) -> Path:
        """Write ``forces.csv``, ``forces.json``, ``tyre.tir``, and with pictures ``forces.png``; return the folder.

        Raises
        ------
        InputError : the folder cannot be written.
        """
        from tyrefem.reports.forces import write_files

        write_files(self, Path(folder), pictures=pictures)
        return Path(folder)


class Study(studies.StudyData):
    """A study, with methods to run, compare, diagnose and sweep it. `study` makes it; `replace` changes it.

    >>> coarse = study("nasa-22x5.5-8pr", {"mesh.size": "12 mm", "drive.duration": "60 s"})
    >>> f"{coarse.run().peaks['tyre'].temperature:.0f} degC"
    '36 degC'
    """

    def __post_init__(self, like: studies.StudyData | None, built: StudyParts | None) -> None:
        super().__post_init__(like, built)
        # The data's package does not import the strain laws; this class checks their name.
        strain_law(self)

    def run(self, progress: Callable[[float], None] | None = None, *, partial: bool = False) -> Result:
        """Simulate the drive. ``progress`` is called with the time (s) after every step.

        ``partial``: return the finished part after Ctrl-C (``result.history.interrupted``); else raise it.
        """
        from tyrefem.simulation.estimate import RunEstimate
        from tyrefem.simulation.run import run

        RunEstimate.of(self).announce()
        return with_verbs(Result, run(self, progress, partial=partial))

    def compare(self, table: Any = None, result: result.ResultData | None = None, **options: Any) -> Comparison:
        """Deviation from measured tables: ``table``, or the study's tables. Options: see `tyrefem.compare.compare`."""
        from tyrefem.compare import compare

        return with_verbs(Comparison, compare(self, table, result, **options))

    def diagnose(self, table: Any = None, **options: Any) -> Diagnosis:
        """Effects that the model lacks, inferred from measured tables: ``table``, or the study's tables.

        Options: see `tyrefem.diagnose.diagnose`.
        """
        from tyrefem.diagnose import diagnose

        return Diagnosis.of(diagnose(self, table, **options))

    def plan(self, after: Any = None, **options: Any) -> ExperimentPlan:
        """The next runs and sensors that are expected to tell the remaining effects apart, by gain per cost.

        ``after``: None before a test; else a `Diagnosis`, the folder of one, or measured tables. Options: see
        `tyrefem.plan.workflow.plan`.
        """
        from tyrefem.plan.workflow import plan

        return with_verbs(ExperimentPlan, plan(self, after, **options))

    def sweep(self, vary: Mapping[str, Any] | None = None, **options: Any) -> Design:
        """Compute many variants: response, Pareto front, tornado, Sobol indices, optimum, envelope.

        ``vary``: dotted name -> tuple (from, to) or (from, to, levels), list of values, or entry of a sweep file.
        Options: every other key of a sweep file (docs/sweeps.md), and those of
        `tyrefem.sweep.design.Questions.answered`.

        >>> coarse = study("nasa-22x5.5-8pr", {"mesh.size": "12 mm", "drive.duration": "60 s"})
        >>> design = coarse.sweep({"drive.speed": ["10 mph", "20 mph"]}, limits={"hottest_degC": {"below": 35}})
        >>> design.table["feasible"].tolist()
        [True, False]
        """
        from tyrefem.sweep.design import run_design_study

        return with_verbs(Design, run_design_study(self, vary, **options))

    def press(self, **options: Any) -> LoadedTyre:
        """Inflate the tyre and press it on the road: load, stiffness, footprint, cords, loss of a revolution.

        Options, in SI: ``pressure``, ``load`` or ``deflection``, ``drum_diameter``, ``camber``, ``tolerance``,
        ``motion``: see `tyrefem.mechanics.footprint.press.press`. By default the start of the drive's first phase.

        >>> tyre = study("nasa-22x5.5-8pr", {"mesh.size": "12 mm"}).press(deflection=0.015, motion="linear")
        >>> tyre.footprint.motion, 5e3 < tyre.footprint.load < 9e3
        ('linear', True)
        """
        return with_verbs(LoadedTyre, rolling_press.press(self, **options))

    def roll(self, **options: Any) -> RollingWheel:
        """Roll the tyre steadily with friction: forces, moments, slip, friction power by ring of the tread.

        Options, in SI: ``slip_angle``, ``camber``, ``turn_slip``; ``slip``, ``torque`` or ``axle_force``; ``friction``,
        ``speed``, and those of `press`. See `tyrefem.mechanics.rolling.roll.roll`.

        >>> rolled = study("nasa-22x5.5-8pr", {"mesh.size": "12 mm"}).roll(slip=0.01)
        >>> rolled.state.force[0] > 0 and rolled.state.torque > 0
        True
        """
        return with_verbs(RollingWheel, rolls.roll(self, **options))

    def wear(self) -> DriveWear:
        """Wear of the tread over the drive, by ring; the drive's phases roll with friction.

        Raises
        ------
        InputError : a law of sliding other than ``rolling``; no ``[wear]`` on the tread's card.
        """
        from tyrefem.wear.drive_wear import drive_wear

        return drive_wear(self)

    def slip_curve(self, **options: Any) -> ForcesOverSlip:
        """Forces and moments over several ``slip_angle`` or several ``slip``, with stiffness, trail and peak.

        Options as in `roll`; see `tyrefem.mechanics.rolling.slip_curve.slip_curve`.
        """
        return with_verbs(ForcesOverSlip, slip_curves.slip_curve(self, **options))

    def tyre_forces(self, **options: Any) -> ForceTable:
        """Forces at every one of ``loads``, over ``slips``, ``slip_angles`` and ``cambers``, with a Magic Formula.

        ``fit`` of the answer has the coefficients; `ForceTable.save` writes them as a ``.tir`` file. See
        `tyrefem.mechanics.rolling.force_table.tyre_forces`.
        """
        return with_verbs(ForceTable, force_tables.tyre_forces(self, **options))

    def natural_frequencies(
        self, harmonics: Iterable[int] = vibrations.HARMONICS, count: int = vibrations.COUNT, **options: Any
    ) -> NaturalModes:
        """Natural frequencies of the inflated tyre without load and rotation, with its rim held.

        ``harmonics``: waves round the wheel; ``count``: modes of each; options ``pressure``, Pa, and ``amplitude``. See
        `tyrefem.mechanics.footprint.natural_frequencies.natural_frequencies`.

        >>> study("nasa-22x5.5-8pr", {"mesh.size": "12 mm"}).natural_frequencies([0], 1).table.name.tolist()
        ['lateral']
        """
        return with_verbs(NaturalModes, vibrations.natural_frequencies(self, harmonics, count, **options))

    def life(self, **options: Any) -> Life:
        """Distance until small flaws become cracks, at every point, by strain cycle and temperatures of a run.

        Options: ``temperature`` (degC everywhere, without a run), ``plateau``, ``result`` (a finished run): see
        `tyrefem.fatigue.life.life`. Not compared with any measured life.

        >>> coarse = {"mesh.size": "14 mm", "mechanics.strain": "fem", "mechanics.motion": "linear"}
        >>> tyre = study("nasa-22x5.5-8pr", coarse).life(temperature=80.0)
        >>> len(tyre.places), tyre.left_out
        (10, ('bead',))
        """
        return with_verbs(Life, lives.life(self, **options))

    def campaign(self) -> Campaign:
        """The cases of the study's table, each of them a study."""
        return Campaign.of(self)


def study(name: str | Path, changes: Mapping[str, Any] | None = None, case: str | None = None) -> Study:
    """Load a study by name or path; ``changes`` gives new values by dotted name.

    ``case``: case of a campaign; ``changes`` then change the case's values.

    Raises
    ------
    InputError : the study does not exist, or it or a card that it names has an error: file, field, what is allowed.
    """
    return Study.load(name, changes, case)


def section_from_size(size: str, numbers: Mapping[str, Any] | None = None) -> Section:
    """A section from a tyre's size: ``"205/60R15"``, ``"295/80R22.5"``, ``"22x5.5 8PR"``, ``"46x17R20"``.

    Parameters
    ----------
    size : as it stands on the tyre's wall.
    numbers : name -> quantity, in place of the rules' own: ``{"rim_width": "6 in", "crown_radius": "700 mm"}``.
        `tyrefem new section SIZE` writes all of them, with their sources.

    Raises
    ------
    InputError : no such size or number; a rim out of range; a pressure that cannot carry the load.

    >>> section = section_from_size("205/60R15")
    >>> round(section.outer_diameter, 4), round(section.overall_width, 3)
    (0.627, 0.209)
    """
    from tyrefem.geometry import load

    return load({"size": size, "parameters": dict(numbers or {})})


def identify(
    rig: str | Path | RigCard,
    tables: Iterable[str | Path] = (),
    *,
    tests: Sequence[HeatingTest] = (),
    without: Sequence[str] = (),
    linear: bool = True,
    fineness: Fineness | None = None,
    progress: Callable[[], None] | None = None,
) -> Identification:
    """Identify conductivity and specific heat of every layer of a rig from measured tables.

    Parameters
    ----------
    rig : name, path or card. tables : CSV files whose runs have the card's names; default: those beside the card.
    tests, without, linear, fineness, progress : see `tyrefem.heating_test.identification.identify`.

    Raises
    ------
    InputError : the card or a table cannot be used.
    """
    data = identification.identify(
        rig, tables, tests=tests, without=without, linear=linear, fineness=fineness, progress=progress
    )
    return with_verbs(Identification, data)
