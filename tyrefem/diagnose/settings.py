"""Every number that steers a diagnosis, in one frozen object, each with its meaning."""

from __future__ import annotations

from dataclasses import dataclass

from tyrefem.errors import InputError


@dataclass(frozen=True)
class DiagnosisSettings:
    """How a diagnosis works; what is true of the tyre stands in the study's ``[diagnosis]`` table instead.

    >>> from dataclasses import replace
    >>> replace(DiagnosisSettings(), largest=2).largest
    2

    Raises
    ------
    InputError : ``reduced`` is no choice, or a number of effects or looks that is not at least 1.
    """

    # -- what is tried
    #: Effects at most in a set.
    largest: int = 3
    #: Diagnoses at most, each of what the one before it has left.
    looks: int = 3
    #: "auto" lets reduced models of the drives predict for the fits where simulations confirm them; "never" does not.
    reduced: str = "auto"

    # -- prior
    #: Probability of one, two, three effects, given that there are any (estimate).
    size_shares: tuple[float, ...] = (0.75, 0.22, 0.03)
    #: Probability that the cause is not in the catalogue, given that there is any (estimate).
    outside_share: float = 0.05

    # -- readings and forward model
    #: Readings of one sensor in one run are averaged into so many blocks at most.
    blocks: int = 40
    #: Mesh, elements and time tolerance of the fit. One run with the study's own corrects what they leave, at x = 0.
    mesh_size: str = "3.5 mm"
    mesh_element: str = "P1"
    tolerance: str = "0.05 delta_degC"
    #: The fit's simulations give readings this often, s.
    readings_every: float = 5.0
    #: What a mesh leaves may be so many times smaller or larger than in the study as it is.
    mesh_error_scales: tuple[float, float] = (0.2, 5.0)

    # -- reduced models of the drives
    #: Rms that the modes leave out of the drive's fields, and of what every unknown does to them at one prior standard
    #: deviation, K.
    modes_left_out: float = 5e-4
    #: Modes at most.
    most_modes: int = 150
    #: Fields taken of the drive, and of every unknown's tangent.
    drive_fields: int = 30
    tangent_fields: int = 12
    #: Time tolerance of the reduced model, K; what it leaves is a hundredth of it.
    reduced_time_tolerance: float = 0.1
    #: Tyres marched together: all that a tangent needs, so that they have their steps in common.
    marched_together: int = 96
    #: Reduced model and simulation may be apart by this much, in the whitened norm of a drive's readings, as a fit's
    #: linear model may be: ln of the evidence changes by about as much times a normal number.
    reduced_allowed: float = 1.0

    # -- fit of one set
    #: The prediction of the linear model is good enough when it misses the simulation by this much (whitened norm).
    predicted_close: float = 1.0
    #: So far off, new tangents are taken.
    predicted_astray: float = 6.0
    #: A fit has converged when the linear model about it promises no more than this drop of the misfit.
    settled: float = 0.5
    #: A misfit that noise makes this seldom is not believed to be the smallest before tangents are taken where it is.
    seldom: float = 0.1
    #: With more misfit than this times the number of readings, a slow fit is given up ...
    far_off: float = 3.0
    #: ... slow meaning that a step leaves more than this share of the misfit.
    slow: float = 0.9
    #: Steps of a first fit; further steps and tangents of a fit that is carried on.
    first_steps: int = 4
    more_steps: int = 14
    more_tangents: int = 4
    #: Trust region: no unknown moves by more than so many prior sd in the first step.
    trust: float = 3.0
    #: A step that fails leaves this much of itself as the next radius; a good one widens it by the second.
    trust_shorter: float = 0.4
    trust_wider: float = 2.0
    #: With a smaller radius the fit stays where it is.
    trust_smallest: float = 0.01
    #: A fit with a misfit of so many times the number of readings nearly explains them.
    nearly: float = 1.3
    #: A misfit that noise makes with at least this probability is nothing unusual.
    usual: float = 0.01
    #: So many standard deviations beyond a bound that physics sets, and the fit counts as one that ends there.
    pressed: float = 2.0

    # -- search
    #: Single effects that are fitted whatever comes.
    singles: int = 4
    #: Sets fitted at once, and in all.
    batch: int = 4
    most_sets: int = 14
    #: Leading fits that are carried on to convergence after every batch; so often at most each.
    carried_sets: int = 2
    carried_times: int = 2
    #: A fit is not carried on where even the linear model promises no misfit below this times the number of readings.
    lost: float = 50.0
    #: A fit is not carried on twice with more misfit than this times the number of readings.
    doubted: float = 3.0
    #: The fit of no effect is carried on before anything else only with less misfit than this times the readings.
    none_carried: float = 10.0
    #: Heat of unknown origin ahead of every set of the catalogue by this much, nats: no more sets are fitted.
    hopeless: float = 500.0
    #: A set whose score is estimated so far below the best needs no fit, nats: when judged from the study as it is ...
    far: float = 12.0
    #: ... and when judged from the fit of a part of it.
    near: float = 3.0
    #: The exhaustive search refuses more sets than this.
    most_exhaustive: int = 300

    # -- heat of unknown origin
    #: Stations along the half meridian.
    stations: int = 7
    #: Prior of the missing heat, W/m3: a share of the hottest zone's hysteresis; of a missing flux, W/m2 (estimates).
    missing_heat: float = 4e4
    missing_flux: float = 400.0
    #: A single source may be so many times stronger than a patch of many; and so many sources are sought.
    source_spread: float = 3.0
    most_sources: int = 3
    #: A further source must raise the log evidence by this much.
    source_gain: float = 3.0
    #: Where the linear model puts it this far, or less, below the best set, it is fitted in the full model, nats.
    missing_near: float = 10.0

    # -- verdict and amended study
    #: A set is named when it is this probable.
    sure: float = 0.9
    #: Sets of joint probability up to this are reported.
    credible: float = 0.99
    #: A set is named only when nothing more is missing with at least this probability.
    whole: float = 0.5
    #: A misfit less probable than this, were the model right, is not accepted.
    improbable: float = 1e-4
    #: A correction of a base number or a sensor that moves no block mean by this much is left out, K.
    negligible: float = 0.2

    @property
    def of_simulations(self) -> tuple[object, ...]:
        """The settings that the answers of simulations depend on."""
        mesh = self.mesh_size, self.mesh_element, self.tolerance, self.readings_every, self.blocks
        fields = self.modes_left_out, self.most_modes, self.drive_fields, self.tangent_fields
        return (*mesh, *fields, self.reduced_time_tolerance, self.marched_together)

    def __post_init__(self) -> None:
        if self.reduced not in ("auto", "never"):
            raise InputError(f"reduced is 'auto' or 'never', not {self.reduced!r}")
        if not 1 <= self.largest <= len(self.size_shares):
            raise InputError(f"largest is a number of effects from 1 to {len(self.size_shares)}, not {self.largest!r}")
        if self.looks < 1:
            raise InputError(f"looks is at least 1, not {self.looks!r}")


#: As shipped.
DEFAULT = DiagnosisSettings()
