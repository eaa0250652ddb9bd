"""Comparison of strain laws in one study: strain energy by region, and temperatures."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.inputs.loading import TrR64
from tyrefem.inputs.study_plugins import plugin_summary
from tyrefem.mechanics.point_energies import GaussPoints
from tyrefem.mechanics.strain_cycle import StrainCycle, Zone
from tyrefem.mechanics.strain_laws import strain_laws
from tyrefem.requirements import Requirements
from tyrefem.simulation.run import run

if TYPE_CHECKING:
    import pandas as pd

    from tyrefem.geometry.meshing.mesh import TyreMesh
    from tyrefem.inputs.loading import LoadCase
    from tyrefem.inputs.study import StudyData
    from tyrefem.simulation.result import ResultData

Array = NDArray[np.float64]
TOTAL = "whole tyre"
#: Requirements of a comparison of strain laws on a study.
NEEDS = Requirements("a comparison of strain laws")


@dataclass(frozen=True, eq=False)
class LawOutcome:
    """Results of a study with one strain law.

    Parameters
    ----------
    law : name of the law. result : the study's run with the law. phase, knot : load case of the largest deflection.
    """

    law: str
    result: ResultData
    phase: int
    knot: int

    @property
    def cycle(self) -> StrainCycle:
        """The strain cycle of the load case."""
        return self.result.tyre.schedule.cycles[self.phase][self.knot]

    @property
    def deflection(self) -> float:
        """Deflection in the load case, m: from the load law, or from the pressed footprint."""
        return self.result.tyre.schedule.cases[self.phase][self.knot].deflection

    def heating_density(self, part: Zone, points: Array) -> Array:
        """U that heats, J/m3, at points (2, n) of a part; for ``fem``, the sum of all harmonics."""
        zones = {zone.name for zone in self.cycle.zones}
        return np.asarray(self.cycle.energy_density(part.name if part.name in zones else part.region, points))

    def energy_density(self, part: Zone, points: Array) -> Array:
        """Strain energy of the largest change within a revolution, J/m3, at points (2, n) of a part."""
        if getattr(self.cycle, "footprint", None) is None:
            return self.heating_density(part, points)
        gauss, largest = self._largest
        return gauss.interpolate(largest, part.region, points)

    @functools.cached_property
    def _largest(self) -> tuple[GaussPoints, Array]:
        from tyrefem.mechanics.footprint.strain_harmonics import StrainHarmonics

        cycle: Any = self.cycle
        return GaussPoints.of(cycle.tyre.body.rings), StrainHarmonics(cycle.footprint).largest_energy()

    @property
    def temperatures(self) -> dict[str, float]:
        """Highest temperature of the run; sensors and contained air at its end, degC."""
        last = self.result.readings.iloc[-1].drop("time_s")
        hottest = float(self.result.extremes.iloc[0]["temperature_degC"])
        return {"hottest": hottest, **{str(name): float(value) for name, value in last.items()}}


@dataclass(frozen=True, eq=False)
class LawComparison:
    """A study with several strain laws, made by `compare_laws`; ``refused``: law -> reason why it has no solution."""

    study: StudyData
    outcomes: tuple[LawOutcome, ...]
    refused: dict[str, str]

    @property
    def parts(self) -> tuple[Zone, ...]:
        """Parts with energies: the NASA report's regions I to V if the section has arcs, else its regions."""
        section = self.study.section
        if _has_arcs(self.study):
            from tyrefem.mechanics.arcs import report_zones

            return report_zones(section.line.shoulder_s)
        return tuple(Zone(region, region, region) for region in section.regions)

    @property
    def case(self) -> LoadCase:
        """The drive's load case with the largest deflection."""
        first = self.outcomes[0]
        return first.result.tyre.schedule.cases[first.phase][first.knot]

    @property
    def load_law_deflection(self) -> float | None:
        """Deflection by the study's load law, m; finite elements compute another. None: the law needs a rating."""
        case, law, rating = self.case, self.study.card.mechanics.load_law, self.study.section.rating
        if case.contact is None:
            return case.deflection
        if isinstance(law, TrR64) and rating is None:
            return None
        return law.deflection(case.load, case.pressure, rating)

    @functools.cached_property
    def mesh(self) -> TyreMesh:
        """The study's mesh with the parts as subdomains."""
        return self.study.mesh().with_zones({part.name: (part.region, part.start, part.end) for part in self.parts})

    @functools.cached_property
    def volumes(self) -> dict[str, float]:
        """Part -> volume of the whole tyre, m3."""
        return {part.name: float(self.mesh.ring_points(part.name)[1].sum()) for part in self.parts}

    @functools.cached_property
    def energies(self) -> dict[str, dict[str, float]]:
        """Law -> part -> strain energy of the largest change, J of the whole tyre; ``whole tyre``: their sum."""
        return self._integrals("energy_density")

    @functools.cached_property
    def heating(self) -> dict[str, dict[str, float]]:
        """As `energies`, for the U that heats: pi U tan d is lost per revolution."""
        return self._integrals("heating_density")

    def _integrals(self, density: str) -> dict[str, dict[str, float]]:
        integrals = {}
        for outcome in self.outcomes:
            of_law = {}
            for part in self.parts:
                points, weights = self.mesh.ring_points(part.name)
                of_law[part.name] = float(getattr(outcome, density)(part, points) @ weights)
            integrals[outcome.law] = of_law | {TOTAL: sum(of_law.values())}
        return integrals

    def table(self) -> pd.DataFrame:
        """``kind``, ``name``, ``unit`` and a column per law, of deflection, energies, coefficients, temperatures."""
        import pandas as pd

        rows: list[dict[str, Any]] = []

        def add(kind: str, name: str, unit: str, values: list[float]) -> None:
            laws = [outcome.law for outcome in self.outcomes]
            rows.append({"kind": kind, "name": name, "unit": unit, **dict(zip(laws, values, strict=True))})

        add("deflection", "deflection", "m", [law_outcome.deflection for law_outcome in self.outcomes])
        volume = self.volumes | {TOTAL: sum(self.volumes.values())}
        for name in volume:
            add("energy", name, "J", [self.energies[law_outcome.law][name] for law_outcome in self.outcomes])
        for name in volume:
            add(
                "density",
                name,
                "J/m3",
                [self.energies[law_outcome.law][name] / volume[name] for law_outcome in self.outcomes],
            )
        for name in volume:
            add("heating", name, "J", [self.heating[law_outcome.law][name] for law_outcome in self.outcomes])
        resistances = [law_outcome.result.rolling_resistance for law_outcome in self.outcomes]
        add("coefficient", "cold", "1", [law_outcome.cold_coefficient for law_outcome in resistances])
        add("coefficient", "at the end", "1", [law_outcome.coefficient for law_outcome in resistances])
        temperatures = [law_outcome.temperatures for law_outcome in self.outcomes]
        for name in temperatures[0]:
            add("temperature", name, "degC", [law_outcome[name] for law_outcome in temperatures])
        return pd.DataFrame(rows)

    def summary(self) -> dict[str, Any]:
        """All results in SI, temperatures in degC."""
        from tyrefem.output import versions

        first, case, laws = self.outcomes[0], self.case, {}
        for outcome in self.outcomes:
            energies, heating = self.energies[outcome.law], self.heating[outcome.law]
            whole, *regions = outcome.result.extreme_rows
            hottest = max(regions, key=lambda row: row["temperature_degC"])
            laws[outcome.law] = {
                "deflection_m": outcome.deflection,
                "energy_J": energies,
                "mean_energy_J_m3": {name: energies[name] / volume for name, volume in self.volumes.items()},
                "heating_energy_J": heating,
                "cold_coefficient": outcome.result.rolling_resistance.cold_coefficient,
                "coefficient": outcome.result.rolling_resistance.coefficient,
                "temperatures_degC": outcome.temperatures,
                "hottest": whole | {"region": hottest["region"]},
            }
        return {
            "study": self.study.name,
            "title": self.study.title,
            "phase": self.study.card.drive.phases[first.phase].name,
            "load_N": case.load,
            "pressure_Pa": case.pressure,
            "load_law_deflection_m": self.load_law_deflection,
            "loss_convention": self.study.card.mechanics.loss_convention,
            "parts": {part.name: {"region": part.region, "title": part.title} for part in self.parts},
            "volume_m3": self.volumes,
            "laws": laws,
            "refused": self.refused,
            "mesh": self.mesh.summary(),
            "versions": versions(),
            **plugin_summary(self.study, list(laws)),
        }


def compared_laws() -> tuple[str, ...]:
    """The laws that compute a strain cycle without further inputs, in the order of the columns."""
    return tuple(name for name, law in strain_laws().items() if law.compared)


def compare_laws(study: StudyData | str, laws: tuple[str, ...] | None = None) -> LawComparison:
    """Run a study with several strain laws; all other inputs, including tan delta, are the same.

    By default, ``arcs`` is left out if the section has no arcs. A law without a solution is kept in ``refused`` with
    the reason.

    Raises
    ------
    InputError : the study is a campaign, it never rolls under load, or no law has a solution.

    >>> brief = {"drive.duration": "60 s", "mesh.size": "12 mm", "numerics.tolerance": "0.5 delta_degC"}
    >>> from tyrefem import study
    >>> comparison = compare_laws(study("nasa-22x5.5-8pr", brief), laws=("arcs",))
    >>> sorted(comparison.energies["arcs"])
    ['I', 'II', 'III', 'IV', 'V', 'whole tyre']
    """
    from tyrefem.inputs.study import study as load_study

    chosen = load_study(study) if isinstance(study, str) else study
    NEEDS.check(chosen)
    outcomes, refused = [], {}
    last: InputError | None = None
    laws = laws or compared_laws()
    for law in laws:
        if law == "arcs" and len(laws) > 1 and not _has_arcs(chosen):
            continue
        try:
            outcomes.append(_outcome(chosen, law))
        except InputError as error:
            refused[law], last = str(error.message), error
    if not outcomes:
        assert last is not None
        raise last
    return LawComparison(chosen, tuple(outcomes), refused)


def _outcome(study: StudyData, law: str) -> LawOutcome:
    result = run(study.replace({"mechanics.strain": law}))
    phase, knot = result.tyre.schedule.most_deflected
    if not result.tyre.schedule.cases[phase][knot].deflection > 0:
        raise InputError("the tyre is never under load: no strain cycle to compare", field="drive.load")
    return LawOutcome(law, result, phase, knot)


def _has_arcs(study: StudyData) -> bool:
    from tyrefem.mechanics.arc_stiffness import ARC_REGIONS

    section = study.section
    return hasattr(section.line, "sidewall_radius") and set(ARC_REGIONS) <= set(section.regions)
