"""Numerical parameters of a diagnosis, each with its meaning."""

from __future__ import annotations

from dataclasses import dataclass
from numbers import Integral

from tyrefem.errors import InputError


@dataclass(frozen=True)
class DiagnosisSettings:
    """Numerical parameters of a diagnosis; assumptions about the tyre are in the study's ``[diagnosis]`` table.

    >>> from dataclasses import replace
    >>> replace(DiagnosisSettings(), largest=2).largest
    2

    Raises
    ------
    InputError : ``reduced`` is neither "auto" nor "never"; ``largest``, ``looks`` or ``odd_run_share`` is out of
        range.
    """

    # -- extent of the search
    #: Largest number of effects in a set.
    largest: int = 3
    #: Largest number of diagnoses; each further one is of the study amended by the one before.
    looks: int = 3
    #: "auto": certified reduced models of the drives predict readings for the fits; "never": only simulations do.
    reduced: str = "auto"

    # -- prior
    #: Probability of one, two, three effects, if any effect is missing (estimate).
    size_shares: tuple[float, ...] = (0.75, 0.22, 0.03)
    #: Probability that the cause is outside the catalogue, if there is a cause (estimate).
    outside_share: float = 0.05
    #: Probability that an effect of the day (road, sun, water, ambient) acts in one of the runs only, if it acts
    #: (estimate); 0: effects act in all runs.
    odd_run_share: float = 0.1

    # -- readings and forward model
    #: The noise of the readings' scatter replaces the stated noise if it differs by more than this (relative), and by
    #: three standard deviations of the estimate. 5 % of noise is 10 % of the misfit.
    noise_tolerance: float = 0.05
    #: Largest relative standard deviation of an estimated noise that may replace the stated one (230 readings).
    noise_sd: float = 0.1
    #: A sensor has noise of its own if it differs from the noise of all by more than this (relative).
    noise_own: float = 0.2
    #: Largest number of blocks into which the readings of one sensor in one run are averaged.
    blocks: int = 40
    #: Mesh, elements and time tolerance of the fit. A full run on the study's mesh corrects the readings at x = 0.
    mesh_size: str = "3.5 mm"
    mesh_element: str = "P1"
    tolerance: str = "0.05 delta_degC"
    #: Interval between two readings of the fit's simulations, s.
    readings_every: float = 5.0
    #: Limits of the factor that scales the mesh correction from x = 0 to other points.
    mesh_error_scales: tuple[float, float] = (0.2, 5.0)

    # -- reduced models of the drives
    #: Rms error of the modes in the drive's fields, and in the fields' change by one prior sd of every unknown, K.
    modes_left_out: float = 5e-4
    #: Largest number of modes.
    most_modes: int = 150
    #: Number of fields of the drive, and of fields of every unknown's tangent, for the modes.
    drive_fields: int = 30
    tangent_fields: int = 12
    #: Time tolerance of the reduced model, K; its actual time error is about a hundredth.
    reduced_time_tolerance: float = 0.1
    #: Largest number of tyres that are integrated as one batch, with common time steps.
    batch_size: int = 96
    #: Largest difference of reduced model and simulation, whitened norm of a drive's readings. The ln evidence changes
    #: by about this much times a standard normal number.
    reduced_allowed: float = 1.0
    #: Largest accepted difference at the best fit if the verdict is decided by many nats, and the smallest lead over
    #: the shift of the ln evidence by this difference.
    reduced_allowed_far: float = 5.0
    reduced_shift: float = 10.0

    # -- fit of one set
    #: Below this error (whitened norm) the prediction of the linear model is good enough.
    close_prediction: float = 1.0
    #: Above this error new tangents are taken.
    poor_prediction: float = 6.0
    #: Tangents count as taken at a point if no unknown has moved further since, prior sd.
    near_tangents: float = 0.4
    #: A fit has converged when the linear model predicts a smaller reduction of the misfit than this.
    least_reduction: float = 0.5
    #: If noise gives the misfit with a smaller probability than this, new tangents confirm that the fit has converged.
    doubtful_p: float = 0.1
    #: A slow fit ends if its misfit is larger than this times the number of readings.
    slow_misfit: float = 3.0
    #: A fit is slow if a step leaves more than this share of the misfit.
    slow_share: float = 0.9
    #: Steps of a first fit; further steps and tangents of a continued fit.
    first_steps: int = 4
    more_steps: int = 14
    more_tangents: int = 4
    #: Initial radius of the trust region, prior sd.
    trust: float = 3.0
    #: Factor on a failed step that gives the next radius; factor on the radius after a good step.
    trust_shorter: float = 0.4
    trust_wider: float = 2.0
    #: The fit ends when the radius is smaller than this.
    trust_smallest: float = 0.01
    #: A fit nearly explains the data if its misfit is smaller than this times the number of readings.
    close_misfit: float = 1.3
    #: Noise can explain a misfit if it gives it with at least this probability.
    usual_p: float = 0.01
    #: A fit counts as ending on a physical bound if its best value is this many standard deviations beyond it.
    beyond_bound: float = 2.0

    # -- search
    #: Number of single effects that are always fitted.
    singles: int = 4
    #: Number of sets that are fitted in one batch, and largest number in total.
    batch: int = 4
    most_sets: int = 14
    #: Number of leading fits that are continued to convergence after every batch; most continuations of each.
    continued_sets: int = 2
    most_continuations: int = 2
    #: A fit is continued only if the linear model predicts a misfit below this times the number of readings.
    continued_misfit: float = 50.0
    #: A fit is continued a second time only if its misfit is below this times the number of readings.
    continued_twice_misfit: float = 3.0
    #: The fit of no effect is continued first only if its misfit is below this times the number of readings.
    none_continued_misfit: float = 10.0
    #: The search ends if heat of unknown origin is ahead of every set of the catalogue by this, nats.
    outside_lead: float = 500.0
    #: A set is not fitted if its score, estimated about x = 0, is this far below the best, nats.
    far_score: float = 12.0
    #: The same for a score that is estimated about the fit of a subset, nats.
    near_score: float = 3.0
    #: The best set without an effect that would be named is fitted if its estimate is at most this far below, nats. In
    #: one case the estimate of a strong effect in place of another was 18 nats too low. So often, if it gets ahead.
    name_score: float = 30.0
    name_rounds: int = 2
    #: Fits within this of the best are compared with sensitivities at their points, nats; most continuations of each.
    #: Sets beyond it have less than 1 % even if the evidences are 1.4 nats off.
    leading_score: float = 6.0
    most_settlings: int = 3
    #: Largest number of sets of the exhaustive search.
    most_exhaustive: int = 300

    # -- heat of unknown origin
    #: Stations along the half meridian.
    stations: int = 7
    #: Prior sd of the missing heat, W/m3 (a share of the hottest zone's hysteresis), and of the missing flux, W/m2
    #: (estimates).
    missing_heat: float = 4e4
    missing_flux: float = 400.0
    #: Prior sd of a single source over that of a patch; largest number of sources.
    source_spread: float = 3.0
    most_sources: int = 3
    #: Least gain of log evidence by a further source.
    source_gain: float = 3.0
    #: Heat of unknown origin is fitted with the full model if its score is at most this far below the best set, nats.
    missing_near: float = 10.0

    #: Knots in time of a run: while places are tried, and for the course of a chosen source.
    coarse_knots: int = 7
    fine_knots: int = 25

    # -- structural discrepancy
    #: Prior sd of ln(strain energy) at a place (laws of strain differ by 20 to 30 %), and the distance over which it is
    #: alike, share of the meridian's length; number of half waves along the meridian.
    energy_sd: float = 0.25
    energy_length: float = 0.25
    energy_modes: int = 7
    #: Factors on the prior sd of the strain energy that are tried where it is wrong by more than these priors expect.
    energy_widths: tuple[float, ...] = (3.0,)
    #: Prior sd of each run's own strain energy over that of all runs.
    energy_of_run: float = 0.3
    #: Prior sd of ln(thickness) of a region: gauges are off by 5 to 10 % (estimate).
    gauge_sd: float = 0.07
    #: Sizes of missing heat as a discrepancy, over its prior sd; equally probable, so evidence is their average.
    heat_widths: tuple[float, ...] = (1.0, 3.0, 10.0)
    #: An effect is not named beside a discrepancy if heat of unknown origin explains the data by itself, and the effect
    #: explains them better by less than this, nats. Sources at the stations miss places and layers by tens of nats.
    free_heat_lead: float = 40.0
    #: Sizes of a correlated discrepancy of the readings that are tried, K; it is alike over this share of a run.
    discrepancy_sizes: tuple[float, ...] = (0.5, 1.0, 2.0, 4.0)
    discrepancy_time: float = 0.3
    #: Steps of a fit beside a discrepancy; number of sets that are fitted beside it, at first and later.
    beside_steps: int = 6
    beside_sets: int = 4
    #: Probability, before any data, that the model is right but for the effects of the catalogue (estimate).
    right_model: float = 0.5

    # -- verdict and amended study
    #: A set is named if its members act with at least this probability. At 90 %, where it was, 2 of the 7 names of
    #: blind and calibration cases below 95 % were wrong, and none of the 219 others.
    named_probability: float = 0.95
    #: Effects that act with at least this probability are held against their rivals before anything is named; a cause
    #: outside the catalogue is stated with it.
    challenged_probability: float = 0.9
    #: Joint probability of the reported (credible) sets.
    credible_mass: float = 0.99
    #: A set is named only if no further effect is missing with at least this probability.
    alone_probability: float = 0.5
    #: A set is rejected if a correct model would give its misfit with a smaller probability than this.
    rejected_p: float = 1e-4
    #: A set is rejected if it corrects a base number, film or sensor by more than this, prior sd (6e-5 for each).
    largest_pull: float = 4.0
    #: A set is not named if another fitted set predicts the held-out runs better by more than this, nats. A right set
    #: falls behind a given other one by m nats with probability at most exp(-m): 0.7 %.
    held_out_margin: float = 5.0
    #: A correction of a base number or a sensor is left out if it changes every block mean by less than this, K.
    negligible: float = 0.2

    @property
    def of_simulations(self) -> tuple[object, ...]:
        """The settings that affect the results of simulations."""
        mesh = self.mesh_size, self.mesh_element, self.tolerance, self.readings_every, self.blocks
        fields = self.modes_left_out, self.most_modes, self.drive_fields, self.tangent_fields
        return (*mesh, *fields, self.reduced_time_tolerance, self.batch_size)

    def __post_init__(self) -> None:
        if not isinstance(self.reduced, str) or self.reduced not in ("auto", "never"):
            raise InputError(f"must be 'auto' or 'never', not {self.reduced!r:.60}", field="reduced")
        if not isinstance(self.largest, Integral) or not 1 <= self.largest <= len(self.size_shares):
            raise InputError(
                f"must be a number of effects from 1 to {len(self.size_shares)}, not {self.largest!r:.60}",
                field="largest",
            )
        if not 0 <= self.odd_run_share < 1:
            raise InputError(f"odd_run_share must be at least 0 and less than 1, not {self.odd_run_share!r}")
        if not isinstance(self.looks, Integral) or self.looks < 1:
            raise InputError(f"must be a whole number of at least 1, not {self.looks!r:.60}", field="looks")


#: Default settings.
DEFAULT = DiagnosisSettings()
