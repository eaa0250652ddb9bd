"""Heat of unknown origin: a regularised estimate of missing heat and flux by station of the meridian."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from tyrefem.brief import Brief
from tyrefem.diagnose.data.residuals import Residuals
from tyrefem.diagnose.fitting.fits import FittedSet, continued, first_fits
from tyrefem.diagnose.forward.multifidelity import Predictions
from tyrefem.diagnose.heat.over_time import HeatOverTime
from tyrefem.diagnose.heat.sources import UnknownSource
from tyrefem.diagnose.inference.evidence import posterior
from tyrefem.diagnose.unknowns.candidates import Candidate
from tyrefem.diagnose.unknowns.unknown import Unknown
from tyrefem.inputs.study import StudyData

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class UnknownHeat(Brief):
    """Missing heat and flux by station and run.

    Parameters
    ----------
    stations : (n,) m along the meridian. heat, heat_sd : (n_runs, n) W/m3. flux, flux_sd : (n_runs, n) W/m2.
    runs, speeds : names and top speeds (m/s) of the fitted runs.
    log_evidence : ln evidence of the data, comparable with the sets of effects.
    region, station : of the largest missing heat. watts : (n,) W, mean over the runs, by station.
    kind : "heat" inside (W/m3), or "flux" through the surface (W/m2).
    values, sd : x and standard deviation of all fitted unknowns, and of the patches (mean over the runs).
    held_out : ln p(held-out data | fitted data, heat) of the full model's fit; NaN without one, or without such runs.
    over_time : the sources by place, sign and course in time; None if they were not estimated.
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
    held_out: float = math.nan
    over_time: HeatOverTime | None = None

    @property
    def clear(self) -> tuple[UnknownSource, ...]:
        """The clear sources over time, see `HeatOverTime.clear`; empty if none were estimated."""
        return () if self.over_time is None else self.over_time.clear


def missing_heat(residuals: Residuals, unknown: Sequence[Unknown], about: FittedSet) -> UnknownHeat:
    """Heat of the patches in every fitted run, fitted with base numbers and sensors; priors regularise.

    Every patch has a part that all runs share, and a part for each run with half the standard deviation. The model is
    linear about x = 0 or about the fit ``about`` without patches; the one with the larger evidence counts. A fit
    without the missing heat may have distorted base numbers. About a fit with effects it is linear about this fit: at
    x = 0 their heat would count as missing. See `missing_heat_fitted`.
    """
    nuisance = residuals.unknowns[: residuals.nuisance]
    origin = residuals.linear(residuals.fitted)
    patch = origin.jacobian[:, origin.design.columns(unknown)]
    here = _Point(nuisance, origin.data, origin.jacobian[:, : residuals.nuisance], patch)
    there = _Point(about.unknowns, about.linear.data, about.linear.jacobian, patch)
    points = (there,) if about.members else (here, there)
    return max((_estimated(residuals, unknown, point) for point in points), key=lambda heat: heat.log_evidence)


def missing_heat_fitted(
    residuals: Residuals,
    predictions: Predictions,
    unknown: Sequence[Unknown],
    null: FittedSet,
    tick: Callable[[], None] | None = None,
) -> UnknownHeat:
    """The estimate of `missing_heat` about a fit of the full model with the few patches of `pursuit`.

    The patches give the place of the missing heat. The fit, with base numbers and sensors, gives its size.
    """
    chosen = pursuit(residuals, unknown)
    whole = (Candidate("not-in-the-catalogue", (), chosen),)
    (fit,) = first_fits(residuals, predictions, [whole], {whole: null} if null.close else {}, tick)
    if fit.worth_continuing:
        (fit,) = continued(residuals, predictions, [fit], tick)
    J = fit.linear.jacobian
    other = [number for number, each in enumerate(fit.unknowns) if each not in chosen]
    origin = residuals.linear(residuals.fitted)
    shared = origin.jacobian[:, origin.design.columns(unknown)].copy()
    for each in chosen:
        shared[:, unknown.index(each)] = J[:, fit.unknowns.index(each)]
    kept = tuple(fit.unknowns[number] for number in other)
    estimate = _estimated(residuals, unknown, _Point(kept, fit.linear.data, J[:, other], shared), chosen[0])
    return dataclasses.replace(estimate, values=fit.values, sd=fit.sd, held_out=fit.held_out)


def with_course(missing: UnknownHeat, over_time: HeatOverTime) -> UnknownHeat:
    """The missing heat with its sources over time; the larger of both evidences counts.

    Where the course in time counts, the prediction of the held-out runs by constant heat is dropped.
    """
    if over_time.log_evidence <= missing.log_evidence:
        return dataclasses.replace(missing, over_time=over_time)
    return dataclasses.replace(missing, over_time=over_time, log_evidence=over_time.log_evidence, held_out=math.nan)


def pursuit(residuals: Residuals, unknown: Sequence[Unknown]) -> tuple[Unknown, ...]:
    """The patches that explain the data best, added one at a time while the evidence rises; at least one.

    The evidence is that of the linear model about x = 0, with one heat per patch and run. A patch is a source or a sink
    in all runs, so that a single source is not split into neighbouring sources and sinks.
    """
    linear = residuals.linear(residuals.fitted)
    n = residuals.nuisance
    low, high = (np.array([getattr(patch, which) for patch in linear.design.unknowns[:n]]) for which in ("low", "high"))
    ends = np.cumsum([0, *(len(residuals.whitened[i]) for i in residuals.fitted)])

    def evidence(patches: Sequence[tuple[Unknown, int]]) -> float:
        columns, sd = [linear.jacobian[:, :n]], [linear.design.sd[:n]]
        for patch, sign in patches:
            of_runs = np.zeros((len(linear.data), len(ends) - 1))
            for run, (start, end) in enumerate(pairwise(ends)):
                of_runs[start:end, run] = sign * linear.jacobian[start:end, linear.design.place[patch]]
            columns.append(of_runs)
            sd.append(np.full(of_runs.shape[1], residuals.settings.source_spread * patch.sd))
        J, more = np.hstack(columns), len(patches) * (len(ends) - 1)
        limits = np.concatenate([low, np.zeros(more)]), np.concatenate([high, np.full(more, np.inf)])
        return posterior(J.T @ J, J.T @ linear.data, np.concatenate(sd), *limits).log_evidence

    chosen: list[tuple[Unknown, int]] = []
    best = -np.inf
    while len(chosen) < residuals.settings.most_sources:
        left = [patch for patch in unknown if all(patch != other for other, _ in chosen)]
        gains = [
            (evidence([*chosen, (patch, sign)]), number, sign) for number, patch in enumerate(left) for sign in (1, -1)
        ]
        value, number, sign = max(gains)
        if chosen and value < best + residuals.settings.source_gain:
            break
        best = value
        chosen.append((left[number], sign))
    return tuple(patch for patch, _ in chosen)


@dataclass(frozen=True, eq=False)
class _Point:
    """A linear model d = J x + P p + e of the fitted trials, with the patches' p."""

    unknowns: tuple[Unknown, ...]
    data: Array
    jacobian: Array
    patches: Array


def _estimated(
    residuals: Residuals, unknown: Sequence[Unknown], about: _Point, chosen: Unknown | None = None
) -> UnknownHeat:
    runs = residuals.runs
    shared, of_runs = about.patches, []
    ends = np.cumsum([len(residuals.whitened[i]) for i in residuals.fitted])
    for end, i in zip(ends, residuals.fitted, strict=True):
        wide = np.zeros_like(shared)
        rows = slice(end - len(residuals.whitened[i]), end)
        wide[rows] = shared[rows]
        of_runs.append(wide)
    n, k = len(about.unknowns), len(unknown)
    J = np.hstack([about.jacobian, shared, *of_runs])
    sd_patch = np.array([each.sd for each in unknown])
    sd = np.concatenate([[each.sd for each in about.unknowns], sd_patch, *[sd_patch / 2 for _ in of_runs]])
    low = np.concatenate([[each.low for each in about.unknowns], np.full(k * (1 + len(of_runs)), -np.inf)])
    high = np.concatenate([[each.high for each in about.unknowns], np.full(k * (1 + len(of_runs)), np.inf)])
    solution = posterior(J.T @ J, J.T @ about.data, sd, low, high)
    means, spreads = [], []
    for number in range(len(of_runs)):
        at = n + k * (number + 1) + np.arange(k)
        both = n + np.arange(k)
        means.append(solution.mean[both] + solution.mean[at])
        C = solution.covariance
        variance = np.diag(C)[both] + np.diag(C)[at] + 2 * C[both, at]
        spreads.append(np.sqrt(np.maximum(variance, 0.0)))
    mean, spread = np.array(means), np.array(spreads)
    half = k // 2
    study = residuals.study
    stations = np.array([float(dict(each.choice)["station"].split()[0]) for each in unknown[:half]])
    width = float(dict(unknown[0].choice)["width"].split()[0])
    watts = _watts(study, stations, width, mean[:, :half].mean(axis=0), mean[:, half:].mean(axis=0))
    first = int(np.argmax(_score(mean, spread, half))) if chosen is None else unknown.index(chosen)
    worst = first % half
    s, depth = np.array([stations[worst]]), study.section.rubber_thickness([stations[worst]]) / 2
    drives = [residuals.driven(i).card.drive for i in residuals.fitted]
    return UnknownHeat(
        stations,
        mean[:, :half],
        spread[:, :half],
        mean[:, half:],
        spread[:, half:],
        tuple(runs[i].name for i in residuals.fitted),
        np.array([drive.top_speed for drive in drives]),
        solution.log_evidence - float(about.data @ about.data) / 2,
        str(study.section.region_at(s, depth)[0]),
        float(stations[worst]),
        watts,
        dict(zip((*about.unknowns, *unknown), map(float, [*solution.mean[:n], *mean.mean(axis=0)]), strict=True)),
        dict(zip((*about.unknowns, *unknown), map(float, [*solution.sd[:n], *spread.mean(axis=0)]), strict=True)),
        _kind(mean, spread, half) if chosen is None else "heat" if first < half else "flux",
    )


def _kind(mean: Array, spread: Array, half: int) -> str:
    """Kind of the patch with the largest ratio of mean to standard deviation."""
    ratio = np.abs(mean.mean(axis=0)) / spread.mean(axis=0)
    return "heat" if ratio[:half].max() >= ratio[half:].max() else "flux"


def _score(mean: Array, spread: Array, half: int) -> Array:
    """Significance of the missing heat and flux at each station, in standard deviations."""
    ratio = mean.mean(axis=0) / spread.mean(axis=0)
    return np.hypot(ratio[:half], ratio[half:])


def _watts(study: StudyData, stations: Array, width: float, heat: Array, flux: Array) -> Array:
    """Missing heat of the tyre by station, W: heat times volume plus flux times surface, of both halves.

    A patch is exp(-((s - station)/width)^2 / 2) between crown and bead, of the radius and thickness at its station.
    """
    section = study.section
    along = width * math.sqrt(2 * math.pi) * (
        ndtr((section.line.length - stations) / width) - ndtr(-stations / width)
    )  # fmt: skip
    radius = section.line.position(stations)[:, 0]
    thickness = np.asarray(section.rubber_thickness(stations))
    ring = 2 * np.pi * radius * along * 2
    return np.asarray(ring * (heat * thickness + flux))
