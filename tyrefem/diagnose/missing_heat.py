"""Heat of unknown origin: a regularised estimate of what is missing where nothing in the catalogue explains the gap."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.diagnose.evidence import fit
from tyrefem.diagnose.fit import polished, refined
from tyrefem.diagnose.fitted import Explained
from tyrefem.diagnose.linearised import Gap
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns import Candidate, Unknown, of_effect
from tyrefem.effects import catalogue
from tyrefem.inputs.study import StudyData

Array = NDArray[np.float64]


def patches(study: StudyData, settings: DiagnosisSettings) -> tuple[Unknown, ...]:
    """Unknown heat (while rolling) and unknown flux (always) at stations evenly spread from crown to bead."""
    length = study.section.line.length
    spacing = length / settings.stations
    known = catalogue()
    found: list[Unknown] = []
    for name, sd in (("missing-heat", settings.missing_heat), ("missing-flux", settings.missing_flux)):
        for number in range(settings.stations):
            station = round((number + 0.5) * spacing, 6)
            choice = (("station", f"{station!r} m"), ("width", f"{round(spacing * 0.6, 6)!r} m"))
            found += of_effect(known[name], choice, sd)
    return tuple(found)


@dataclass(frozen=True, eq=False)
class MissingHeat(Brief):
    """What is missing, patch by patch.

    Parameters
    ----------
    stations : (n,) m along the meridian. heat, heat_sd : (n_runs, n) W/m3. flux, flux_sd : (n_runs, n) W/m2.
    runs, speeds : names and fastest speeds (m/s) of the fitted runs. log_evidence : of the data, comparable with the
        sets'. region : where most of the missing heat is. watts : (n,) W, mean over the runs, by station.
    kind : "heat" inside (W/m3), or "flux" through the surface (W/m2).
    values, sd : every unknown fitted along, and the patches (mean over the runs): x and its standard deviation.
    """

    stations: Array
    heat: Array
    heat_sd: Array
    flux: Array
    flux_sd: Array
    runs: tuple[str, ...]
    speeds: Array
    log_evidence: float
    region: str
    station: float
    watts: Array
    values: dict[Unknown, float]
    sd: dict[Unknown, float]
    kind: str


def missing_heat(gap: Gap, unknown: Sequence[Unknown], about: Explained) -> MissingHeat:
    """The patches' heat in every fitted run, fitted together with base numbers and sensors; priors regularise.

    Every patch has a part that all runs share and one of its own in each run, of half the standard deviation. Taken in
    the linear model about the study as it is, or about ``about`` (a fit without it), whichever explains the data
    better: a fit that lacks what is missing may have bent base numbers far. See `missing_heat_fitted`.
    """
    nuisance = gap.unknowns[: gap.nuisance]
    origin = gap.linear(gap.fitted)
    patch = origin.jacobian[:, origin.columns(unknown)]
    here = _Point(nuisance, origin.data, origin.jacobian[:, : gap.nuisance], patch)
    found = [_estimated(gap, unknown, one) for one in (here, _Point(about.unknowns, about.data, about.jacobian, patch))]
    return max(found, key=lambda one: one.log_evidence)


def missing_heat_fitted(
    gap: Gap, unknown: Sequence[Unknown], null: Explained, tick: Callable[[], None] | None = None
) -> MissingHeat:
    """The same about a fit of the full model with the few patches that explain most, see `pursuit`.

    They say where the missing heat is; the fit, with base numbers and sensors, how much.
    """
    chosen = pursuit(gap, unknown)
    whole = (Candidate("not-in-the-catalogue", (), chosen),)
    first = refined(gap, [whole], tick, {whole: null} if null.close else {})
    one = polished(gap, first, tick)[0]
    other = [number for number, each in enumerate(one.unknowns) if each not in chosen]
    origin = gap.linear(gap.fitted)
    shared = origin.jacobian[:, origin.columns(unknown)].copy()
    for each in chosen:
        shared[:, unknown.index(each)] = one.jacobian[:, one.unknowns.index(each)]
    kept = tuple(one.unknowns[number] for number in other)
    found = _estimated(gap, unknown, _Point(kept, one.data, one.jacobian[:, other], shared), chosen[0])
    return dataclasses.replace(found, values=one.values, sd=one.sd)


def pursuit(gap: Gap, unknown: Sequence[Unknown]) -> tuple[Unknown, ...]:
    """The patches that explain the data best, one after the other while the evidence rises; at least one.

    Each is judged in the linear model about the study as it is, with a heat of its own in every run that may not be
    negative, so that a single source is not split into sources and sinks side by side.
    """
    linear = gap.linear(gap.fitted)
    n = gap.nuisance
    low, high = (np.array([getattr(one, which) for one in linear.unknowns[:n]]) for which in ("low", "high"))
    ends = np.cumsum([0, *(len(gap.whitened[i]) for i in gap.fitted)])

    def evidence(patches: Sequence[Unknown]) -> float:
        columns, sd = [linear.jacobian[:, :n]], [linear.sd[:n]]
        for one in patches:
            own = np.zeros((len(linear.data), len(ends) - 1))
            for run, (start, end) in enumerate(pairwise(ends)):
                own[start:end, run] = linear.jacobian[start:end, linear.place[one]]
            columns.append(own)
            sd.append(np.full(own.shape[1], gap.settings.source_spread * one.sd))
        J, more = np.hstack(columns), len(patches) * (len(ends) - 1)
        limits = np.concatenate([low, np.zeros(more)]), np.concatenate([high, np.full(more, np.inf)])
        return fit(J.T @ J, J.T @ linear.data, np.concatenate(sd), *limits).log_evidence

    chosen: list[Unknown] = []
    best = -np.inf
    while len(chosen) < gap.settings.most_sources:
        found = [(evidence([*chosen, one]), number) for number, one in enumerate(unknown) if one not in chosen]
        value, number = max(found)
        if chosen and value < best + gap.settings.source_gain:
            break
        best = value
        chosen.append(unknown[number])
    return tuple(chosen)


@dataclass(frozen=True, eq=False)
class _Point:
    """A linear model d = J x + P p + e of the fitted trials, with the patches' p."""

    unknowns: tuple[Unknown, ...]
    data: Array
    jacobian: Array
    patches: Array


def _estimated(gap: Gap, unknown: Sequence[Unknown], about: _Point, chosen: Unknown | None = None) -> MissingHeat:
    trials = gap.lab.bench.trials
    shared, own = about.patches, []
    ends = np.cumsum([len(gap.whitened[i]) for i in gap.fitted])
    for end, i in zip(ends, gap.fitted, strict=True):
        wide = np.zeros_like(shared)
        rows = slice(end - len(gap.whitened[i]), end)
        wide[rows] = shared[rows]
        own.append(wide)
    n, k = len(about.unknowns), len(unknown)
    J = np.hstack([about.jacobian, shared, *own])
    sd_patch = np.array([one.sd for one in unknown])
    sd = np.concatenate([[one.sd for one in about.unknowns], sd_patch, *[sd_patch / 2 for _ in own]])
    low = np.concatenate([[one.low for one in about.unknowns], np.full(k * (1 + len(own)), -np.inf)])
    high = np.concatenate([[one.high for one in about.unknowns], np.full(k * (1 + len(own)), np.inf)])
    solution = fit(J.T @ J, J.T @ about.data, sd, low, high)
    means, spreads = [], []
    for number in range(len(own)):
        at = n + k * (number + 1) + np.arange(k)
        both = n + np.arange(k)
        means.append(solution.mean[both] + solution.mean[at])
        C = solution.covariance
        variance = np.diag(C)[both] + np.diag(C)[at] + 2 * C[both, at]
        spreads.append(np.sqrt(np.maximum(variance, 0.0)))
    mean, spread = np.array(means), np.array(spreads)
    half = k // 2
    study = gap.lab.bench.study
    stations = np.array([float(dict(one.choice)["station"].split()[0]) for one in unknown[:half]])
    watts = _watts(study, stations, mean[:, :half].mean(axis=0), mean[:, half:].mean(axis=0))
    first = int(np.argmax(_score(mean, spread, half))) if chosen is None else unknown.index(chosen)
    worst = first % half
    s, depth = np.array([stations[worst]]), study.section.rubber_thickness([stations[worst]]) / 2
    drives = [gap.lab.bench.driven(study, i).card.drive for i in gap.fitted]
    return MissingHeat(
        stations,
        mean[:, :half],
        spread[:, :half],
        mean[:, half:],
        spread[:, half:],
        tuple(trials[i].name for i in gap.fitted),
        np.array([max(max(phase.speed.start, phase.speed.end) for phase in drive.phases) for drive in drives]),
        solution.log_evidence - float(about.data @ about.data) / 2,
        str(study.section.region_at(s, depth)[0]),
        float(stations[worst]),
        watts,
        dict(zip((*about.unknowns, *unknown), map(float, [*solution.mean[:n], *mean.mean(axis=0)]), strict=True)),
        dict(zip((*about.unknowns, *unknown), map(float, [*solution.sd[:n], *spread.mean(axis=0)]), strict=True)),
        _kind(mean, spread, half) if chosen is None else "heat" if first < half else "flux",
    )


def _kind(mean: Array, spread: Array, half: int) -> str:
    """Where the surest patch is."""
    ratio = np.abs(mean.mean(axis=0)) / spread.mean(axis=0)
    return "heat" if ratio[:half].max() >= ratio[half:].max() else "flux"


def _score(mean: Array, spread: Array, half: int) -> Array:
    """How surely something is missing at each station: heat and flux together, in standard deviations."""
    ratio = mean.mean(axis=0) / spread.mean(axis=0)
    return np.hypot(ratio[:half], ratio[half:])


def _watts(study: StudyData, stations: Array, heat: Array, flux: Array) -> Array:
    """Missing heat of the whole tyre by station, W: patch height times ring volume and surface of its stretch."""
    section = study.section
    spacing = section.line.length / len(stations)
    radius = section.line.position(stations)[:, 0]
    thickness = np.asarray(section.rubber_thickness(stations))
    ring = 2 * np.pi * radius * spacing * 2
    return np.asarray(ring * (heat * thickness + flux))
