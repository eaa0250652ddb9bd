"""A study: one immutable description of a tyre and its drive, and what can be asked of it."""

from __future__ import annotations

import copy
import functools
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from tyrefem import library
from tyrefem.brief import Brief
from tyrefem.cards import read_toml
from tyrefem.effects import catalogue
from tyrefem.errors import InputError, InputWarning, nearest, quoted
from tyrefem.inputs.changes import all_changed
from tyrefem.inputs.drive import as_written
from tyrefem.inputs.study_card import MeasuredEntry, Sensor, StudyCard
from tyrefem.inputs.uncertain_numbers import UncertainNumber, uncertain_number, uncertain_numbers
from tyrefem.inputs.warnings import study_warnings
from tyrefem.materials.card import MaterialCard
from tyrefem.materials.cord_layers import check_cords_fit
from tyrefem.measured.cases import Case, read_cases
from tyrefem.quantity import written

if TYPE_CHECKING:
    from tyrefem.effects import Effect
    from tyrefem.geometry import Section
    from tyrefem.geometry.meshing import TyreMesh


@dataclass(frozen=True, eq=False)
class Study(Brief):
    """A tyre, its materials, drive, boundaries and sensors. Made by `study`; changed by `replace`.

    ``data`` is the file as written (units in the text); ``card`` the same, validated, in SI.

    >>> faster = study("nasa-22x5.5-8pr").replace({"drive.speed": "25 mph"})
    >>> faster.data["drive"]["speed"]
    '25 mph'
    """

    name: str
    data: Mapping[str, Any]
    file: Path | None = None
    #: Folder that relative references (cards, tables) start from.
    folder: Path | None = None
    card: StudyCard = field(init=False, repr=False)

    @classmethod
    def load(cls, name: str | Path, changes: Mapping[str, Any] | None = None, case: str | None = None) -> Self:
        """The study of a name or path, with values changed by dotted names.

        ``case``: of a campaign, only this case; ``changes`` are then laid over the case's own values.

        Raises
        ------
        InputError : no such study, or something wrong in it or in a card it names: file, field, what is allowed.
        """
        path = library.find("study", str(name))
        folder = path.parent.resolve()
        stem = folder.name if path.name == "study.toml" else path.stem
        changes = dict(changes or {})
        # Another table of cases comes before the case that is taken of it.
        first = changes if case is None else {key: changes.pop(key) for key in list(changes) if key == "cases"}
        loaded = cls(stem, all_changed(read_toml(path), first), path, folder)
        return loaded if case is None else loaded.case(case).replace(changes)

    def __post_init__(self) -> None:
        like = self.__dict__.pop("_like", None)
        try:
            if like is None:
                card = StudyCard.check(self.data, self.file)
            else:
                card = like.card.checked(like.data, self.data, self.file)
            object.__setattr__(self, "card", card)
        except InputError as error:
            raise self.as_written(error) from None
        self._share(like)
        _ = self.section, self.materials
        self._check_energy()
        if like is not None and self.new_section is like.new_section and self.sensors == like.sensors:
            self.__dict__["stated_places"] = like.stated_places
        _ = self.stated_places
        self._check_effects()

    def __getstate__(self) -> dict[str, Any]:
        """What was written, the section and the materials: the cards may have changed where it is opened again.

        The study's card is validated again: a user's own effect is in no importable module.
        """
        state = {name: self.__dict__[name] for name in ("name", "data", "file", "folder")}
        built = ("new_section", "section", "materials", "_material_data", "temperatures")
        return state | {name: self.__dict__[name] for name in built if name in self.__dict__}

    def __setstate__(self, state: Mapping[str, Any]) -> None:
        self.__dict__.update(state)
        object.__setattr__(self, "card", StudyCard.check(self.data, self.file))

    def _facts(self) -> Mapping[str, Any]:
        drive, section = self.card.drive, self.section
        mesh = self.card.mesh
        return {
            "title": self.title,
            "file": self.file or "not in a file",
            "section": f"{section.name}, {'half' if section.half else 'whole'}, regions {', '.join(section.regions)}",
            "drive": f"{', '.join(phase.name for phase in drive.phases)}: {drive.end:g} s from {drive.initial:g} degC",
            "strain law": self.card.mechanics.strain,
            "mesh": mesh.file or f"{mesh.mesher}, {mesh.size * 1e3:g} mm, {mesh.element}",
            "sensors": self.sensors,
            "effects": [effect.name for effect in self.effects],
            "measured": [Path(entry.table).name for entry in self.measured],
            "uncertain": f"{len(self.uncertainty)} numbers",
            **({"cases": self.card.cases} if self.is_campaign else {}),
        }

    def as_written(self, error: InputError) -> InputError:
        """The error in the file's own words: what a phase takes over from ``[drive]`` is wrong there."""
        drive = self.data.get("drive")
        if not isinstance(drive, Mapping) or not (error.field or "").startswith("drive.phases."):
            return error
        field = as_written(drive, str(error.field))
        return InputError(error.message, field=field, file=error.file)

    # -- what it is made of ------------------------------------------------------------------------------------------

    @functools.cached_property
    def section(self) -> Section:
        """The tyre's section, half or full as the mesh table says, worn as the study's effects say."""
        wear = [effect for effect in self.effects if effect.overrides("worn")]
        # Studies that share a new section share the worn one too: operators are assembled once per section.
        known = self.new_section.__dict__.setdefault("_worn", {})
        key = tuple((effect.name, *effect.values.items()) for effect in wear)
        if key not in known:
            section = self.new_section
            for effect in wear:
                section = effect.worn(section)
            known[key] = section
        worn: Section = known[key]
        return worn

    @functools.cached_property
    def new_section(self) -> Section:
        """The section before any wear."""
        from tyrefem.geometry import load

        try:
            built = load(self.data["section"], near=self.folder)
        except InputError as error:
            raise error if error.file else error.within(field="section", file=self.file) from None
        return built.as_full() if self.card.mesh.section == "full" else built

    @property
    def effects(self) -> tuple[Effect, ...]:
        """The study's effects that are not null."""
        return tuple(one for one in self.card.effects if not one.is_null)

    @functools.cached_property
    def materials(self) -> dict[str, MaterialCard]:
        """Region of the section -> material card."""
        regions = self.new_section.regions
        for region in self.data["materials"]:
            if region not in regions:
                message = f"unknown region '{region}'{nearest(str(region), regions)}"
                raise InputError(message, field="materials", file=self.file)
        found: dict[str, MaterialCard] = {}
        known, like = self.__dict__.pop("_known_materials", {}), self.__dict__.pop("_like_materials", None)
        read = self.__dict__["_material_data"] = {}
        for region in regions:
            if region not in self.data["materials"]:
                raise InputError(f"no material card for region '{region}'", field="materials", file=self.file)
            if region in known:
                found[region] = known[region]
                read[region] = like.__dict__["_material_data"][region]
                continue
            try:
                found[region], read[region] = self._material(region, like)
                check_cords_fit(found[region], self.new_section, region)
            except InputError as error:
                raise error if error.file else error.within(field=f"materials.{region}", file=self.file) from None
        return found

    def _material(self, region: str, like: Study | None) -> tuple[MaterialCard, tuple[dict[str, Any], Path]]:
        """A card, and the data and file that it was made of."""
        reference = self.data["materials"][region]
        if like is not None and region in like.__dict__["_material_data"] and like.folder == self.folder:
            before, path = like.__dict__["_material_data"][region]
            data = library.over("material", reference, like.data["materials"][region], before)
            if data is not None:
                return like.materials[region].checked(before, data, path), (data, path)
        data, path, _ = library.load("material", reference, self.folder)
        return MaterialCard.check(data, path), (data, path)

    def warmed(self, temperatures: Mapping[str, float]) -> Self:
        """This study with the moduli that its cards have at the mean temperatures of the regions, degC.

        What it is made of is shared; it is for finding strain cycles, not for writing or changing.
        """
        study = object.__new__(type(self))
        study.__dict__.update(self.__dict__)
        cards = {region: card.warmed(temperatures[region]) for region, card in self.materials.items()}
        study.__dict__.update(materials=cards, temperatures=dict(temperatures))
        return study

    @functools.cached_property
    def warnings(self) -> tuple[InputWarning, ...]:
        """What can be run but is perhaps not meant, in the study, its section and its material cards."""
        return study_warnings(self.card, self.new_section, self.materials, self.file)

    @functools.cached_property
    def temperatures(self) -> Mapping[str, float] | None:
        """Mean temperature of each region that the moduli are at, degC; None: as the cards give them."""
        return None

    @property
    def title(self) -> str:
        """One line for people."""
        return self.card.title

    @property
    def sensors(self) -> Mapping[str, Sensor]:
        """Thermocouples by name."""
        return self.card.sensors

    @property
    def measured(self) -> tuple[MeasuredEntry, ...]:
        """The study's measured tables, their paths made whole."""
        folder = self.folder or Path()
        entries = self.card.measured
        return tuple(entry.model_copy(update={"table": folder / entry.table}) for entry in entries)

    @property
    def tolerance(self) -> float:
        """Time-integration error aimed at, K."""
        return self.card.numerics.tolerance

    @property
    def numerical_sd(self) -> float:
        """Standard deviation of a reading left by the mesh, K."""
        return self.card.numerics.mesh_sd

    @property
    def material_data(self) -> Mapping[str, tuple[Mapping[str, Any], Path]]:
        """Region -> its material card as written, changes laid over it, and the card's file."""
        _ = self.materials
        data: Mapping[str, tuple[Mapping[str, Any], Path]] = self.__dict__["_material_data"]
        return data

    @functools.cached_property
    def uncertain_numbers(self) -> tuple[UncertainNumber, ...]:
        """Every number with a standard deviation, from the cards and the study, also those that cannot matter.

        Raises
        ------
        InputError : a name in ``[uncertainty]`` that the study has not.
        """
        return uncertain_numbers(self)

    @functools.cached_property
    def uncertainty(self) -> dict[str, float]:
        """Dotted name of an uncertain number that can matter -> relative standard deviation."""
        return {number.key: number.sd for number in self.uncertain_numbers if not number.idle}

    def _share(self, like: Study | None) -> None:
        """Take over what another study has built, where the two do not differ."""
        if like is None:
            return
        if self.data["section"] != like.data["section"]:
            return
        if self.card.mesh.section == like.card.mesh.section:
            self.__dict__["new_section"] = like.new_section
        mine, theirs = self.data["materials"], like.data["materials"]
        self.__dict__["_like_materials"] = like
        self.__dict__["_known_materials"] = {
            region: like.materials[region] for region in like.materials if mine.get(region) == theirs[region]
        }

    def _check_energy(self) -> None:
        energy = self.card.mechanics.energy
        try:
            if energy is not None:
                energy.check_regions(self.new_section)
        except InputError as error:
            raise error.within(field="mechanics.energy", file=self.file) from None

    def _check_effects(self) -> None:
        for number, effect in enumerate(self.card.effects):
            problem = effect.problem(self)
            if problem is None and any(_same(effect, other) for other in self.card.effects[:number]):
                problem = "is given twice; give it once"
            if problem is not None:
                raise InputError(problem, field=f"effects.{effect.name}", file=self.file)
        excluded = self.card.diagnosis.exclude
        unknown = [name for name in excluded if name not in catalogue()] if excluded else []
        if unknown:
            wrong = f"unknown effects {quoted(unknown, catalogue())}; 'tyrefem list effects' names them all"
            raise InputError(wrong, field="diagnosis.exclude", file=self.file)

    @functools.cached_property
    def stated_places(self) -> Mapping[str, tuple[float, float]]:
        """(r, z) of every sensor as it was built in, m; refuses one outside the rubber."""
        found = {}
        for name, sensor in self.sensors.items():
            try:
                found[name] = self.section_place(sensor)
            except InputError as error:
                raise error.within(field=f"sensors.{name}", file=self.file) from None
        return found

    def section_place(self, sensor: Sensor) -> tuple[float, float]:
        """(r, z) of a sensor as it was built in, m; refuses one outside the rubber."""
        section = self.new_section
        if sensor.at is not None:
            r, z = sensor.at
            if not section.contains([[r, z]])[0]:
                s, depth = section.locate([[r, z]])
                raise InputError(
                    f"at (r, z) = ({r * 1e3:.1f}, {z * 1e3:.1f}) mm the sensor is outside the rubber; the nearest "
                    f"meridian point is s = {float(s[0]) * 1e3:.1f} mm, where the rubber is "
                    f"{float(section.rubber_thickness(s)[0]) * 1e3:.1f} mm thick (depth there "
                    f"{float(depth[0]) * 1e3:.1f} mm)"
                )
            return float(r), float(z)
        assert sensor.s is not None
        assert sensor.depth is not None
        length = section.line.length
        lowest = 0.0 if section.half else -length
        if not lowest <= sensor.s <= length:
            raise InputError(
                f"s = {sensor.s * 1e3:.1f} mm is off the section; allowed: {lowest * 1e3:.1f} to {length * 1e3:.1f} mm"
            )
        thickness = float(section.rubber_thickness([sensor.s])[0])
        if sensor.depth > thickness * (1 + 1e-9):
            raise InputError(
                f"depth = {sensor.depth * 1e3:.2f} mm is outside the rubber, which is {thickness * 1e3:.2f} mm thick "
                f"at s = {sensor.s * 1e3:.1f} mm"
            )
        r, z = section.place([sensor.s], [min(sensor.depth, thickness)])[0]
        return float(r), float(z)

    # -- change ------------------------------------------------------------------------------------------------------

    def replace(self, changes: Mapping[str, Any], like: Study | None = None) -> Self:
        """A new study with values changed by dotted names; units as text, as in a file.

        What another study, ``like`` (this one, if not given), has built is taken over where the two do not differ.

        Raises
        ------
        InputError : unknown name (says the nearest), or a value that is not allowed.
        """
        return self._with(all_changed(self.data, changes), self if like is None else like)

    def _with(self, data: Mapping[str, Any], like: Study) -> Self:
        study = object.__new__(type(self))
        study.__dict__.update(name=self.name, data=data, file=self.file, folder=self.folder, _like=like)
        study.__post_init__()
        return study

    def scaled(self, key: str, factor: float) -> Self:
        """A new study with the number at a dotted name times a factor, in every region that takes it from that card.

        An uncertain number that stands at several names (c10 and c01 of one compound) is moved as one.

        >>> radial = study("passenger-205-55r16").scaled("materials.body-ply.conductivity.value", 2.0)
        >>> radial.materials["turn-up"].conductivity.value == radial.materials["body-ply"].conductivity.value
        True
        """
        return self.replace(uncertain_number(self, key).changes(factor))

    def with_drive(self, changes: Mapping[str, Any]) -> Self:
        """A new study with other values in its ``[drive]`` table."""
        return self.replace({f"drive.{key}": value for key, value in changes.items()})

    def save(self, path: str | Path) -> Path:
        """Write the study as a TOML file that runs as it is.

        Files that the study names relative to its own folder are named by their whole path, if it is another folder.
        """
        import tomli_w

        from tyrefem.output import atomic_path

        path = Path(path)
        data = dict(self.data) if path.parent.resolve() == self.folder else self._portable()
        with atomic_path(path) as temporary:
            temporary.write_text(tomli_w.dumps(written(data)), encoding="utf-8")
        return path

    def _portable(self) -> dict[str, Any]:
        data: dict[str, Any] = copy.deepcopy(dict(self.data))
        folder = (self.folder or Path()).resolve()
        for holder, key in [(data, "cases"), (data.get("mesh", {}), "file")]:
            if isinstance(holder.get(key), str):
                holder[key] = str(folder / holder[key])
        for entry in data.get("measured", []):
            entry["table"] = str(folder / entry["table"])
        data["section"] = library.located("section", data["section"], self.folder)
        data["materials"] = {
            region: library.located("material", reference, self.folder)
            for region, reference in data["materials"].items()
        }
        return data

    # -- work --------------------------------------------------------------------------------------------------------

    def mesh(self) -> TyreMesh:
        """The section's mesh, as the study's ``[mesh]`` table asks."""
        from tyrefem.geometry import meshing

        choice = self.card.mesh
        try:
            if choice.file is not None:
                path = (self.folder or Path()) / choice.file
                return meshing.read_for(self.section, path, names=choice.names, axes=choice.axes, unit=choice.unit)
            return meshing.build(
                self.section, mesher=choice.mesher, size=choice.size, cell=choice.cell, through=choice.through
            )
        except InputError as error:
            raise error if error.file else error.within(field="mesh", file=self.file) from None

    @property
    def is_campaign(self) -> bool:
        """Does it name a table of cases?"""
        return self.card.cases is not None

    @property
    def cases_file(self) -> Path | None:
        """The table of cases, its path made whole; None: the study is no campaign."""
        return None if self.card.cases is None else (self.folder or Path()) / self.card.cases

    @property
    def cases(self) -> tuple[Case, ...]:
        """The rows of its table of cases.

        Raises
        ------
        InputError : it has no table, or the table is wrong.
        """
        if self.cases_file is None:
            raise InputError("the study has no 'cases' table", field="cases", file=self.file)
        return read_cases(self.cases_file)

    @property
    def case_names(self) -> tuple[str, ...]:
        """Names of its cases, in the table's order; none without a table."""
        return tuple(case.name for case in self.cases) if self.is_campaign else ()

    def case(self, name: str) -> Self:
        """One case of the study's table by its name, a study of its own.

        Raises
        ------
        InputError : the study has no table of cases, or none of that name (says the nearest); the case is wrong.

        >>> study("nasa-campaign").case("8pr-3270lbf-83psi-20mph").data["drive"]["load"]
        '3270 lbf'
        """
        by_name = {case.name: case for case in self.cases}
        if name not in by_name:
            raise InputError(f"no case '{name}'{nearest(name, by_name)}", file=self.cases_file)
        return self.case_study(by_name[name])

    def case_study(self, case: Case) -> Self:
        """The study of one row of its table; what is wrong with it is said with its line there."""
        try:
            changed = self.replace(case.changes)
            data = {key: value for key, value in changed.data.items() if key != "cases"}
            data["title"] = f"{case.name}: {case.note}" if case.note else case.name
            return replace(changed, name=case.name, data=data)
        except InputError as error:
            of_study = error.file is None or error.file == self.file
            reason = InputError(error.message, field=error.field) if of_study else error
            raise InputError(f"line {case.line}, case '{case.name}': {reason}", file=self.cases_file) from None


def _same(one: Effect, other: Effect) -> bool:
    return one.name == other.name and one.choice == other.choice


def study(name: str | Path, changes: Mapping[str, Any] | None = None, case: str | None = None) -> Study:
    """The study of a name or path, with values changed by dotted names: `Study.load`."""
    return Study.load(name, changes, case)
