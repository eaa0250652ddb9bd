"""The numbers of the effect ``standing-wave`` by the tyre's mechanics, where a drive comes near its critical speed."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from tyrefem.cache import Cache
from tyrefem.diagnose.unknowns.candidates import Candidate, CandidateSpace, Members
from tyrefem.diagnose.unknowns.unknown import Unknown
from tyrefem.errors import InputError, ResultWarning
from tyrefem.inputs.motion import motion_in
from tyrefem.inputs.study import StudyData
from tyrefem.materials.reads import FEM_ROLLING, values_read
from tyrefem.mechanics.footprint.pressed_tyre import inputs
from tyrefem.mechanics.rolling.amplification import Amplification, Onset, amplification
from tyrefem.mechanics.rolling.critical_speed import critical_speed, ring_speed

#: Name of the effect.
NAME = "standing-wave"
#: The rise is computed for speeds above this share of that of the ring: heat is then 15 % up in the 22x5.5 and in the
#: passenger tyre (45 and 32 m/s).
NEAR = 0.5
#: Standard deviation of the computed onset speed over itself: moduli are known to 30 %, a speed goes with their root.
SPREAD = 0.15


@dataclass(frozen=True)
class ComputedWave:
    """The effect's numbers; ``onset`` None: those of the catalogue. ``note``: in one sentence; empty: none."""

    onset: Onset | None = None
    note: str = ""

    def of_candidate(self, candidate: Candidate) -> Candidate:
        """A candidate with these numbers, if it is the effect: about the onset's speed, gains of the onset's size."""
        if candidate.name != NAME or self.onset is None:
            return candidate
        onset, unknowns = self.onset, []
        for unknown in candidate.unknowns:
            assert unknown.parameter is not None
            prior = unknown.parameter.prior
            if prior.amplitude:
                size = min(onset.gain, prior.high)
                unknowns.append(replace(unknown, sd=size, beside=(("critical_speed", _speed_in(candidate, onset)),)))
            else:
                speed = _speed_in(candidate, onset)
                low, high = prior.low - speed, prior.high - speed
                unknowns.append(replace(unknown, sd=SPREAD * speed, origin=speed, low=low, high=high))
        return replace(candidate, unknowns=tuple(unknowns))


def recorded_wave(candidates: Sequence[Candidate]) -> dict[str, float] | None:
    """The computed numbers that the effect has among some candidates, as plain data; None: those of the catalogue."""
    wave = next((candidate for candidate in candidates if candidate.name == NAME), None)
    if wave is None or (speed := _shape(wave).origin) is None:
        return None
    return {"gain": wave.amplitudes[0].sd, "critical_speed_m_s": speed}


def stored_wave(numbers: Mapping[str, float] | None) -> ComputedWave:
    """The wave with the numbers of `recorded_wave`."""
    if numbers is None:
        return ComputedWave()
    return ComputedWave(Onset(float(numbers["gain"]), float(numbers["critical_speed_m_s"]), math.nan))


def _speed_in(candidate: Candidate, onset: Onset) -> float:
    """The onset's speed within the effect's bounds, m/s."""
    prior = _shape(candidate).parameter
    assert prior is not None
    return min(max(onset.critical_speed, prior.prior.low), prior.prior.high)


def _shape(candidate: Candidate) -> Unknown:
    (shape,) = candidate.shapes
    return shape


@dataclass(frozen=True)
class WithWave:
    """A space of candidates whose standing wave has computed numbers."""

    space: CandidateSpace
    wave: ComputedWave

    def __call__(self, study: StudyData) -> Members:
        """The candidates of a study."""
        return tuple(self.wave.of_candidate(candidate) for candidate in self.space(study))


_KEPT: Cache[Amplification] = Cache(size=4)


def computed_wave(
    studies: Sequence[StudyData], candidates: Sequence[Candidate], tick: Callable[[str], None] | None = None
) -> ComputedWave:
    """The standing wave of the driven study that comes nearest to its critical speed.

    Computed (half a minute to two) where the effect is a candidate, a drive is faster than `NEAR` times the speed of
    waves on a ring under its belt's tension (`ring_speed`), and strains are by finite elements. Else, and where there
    is no solution or hardly a rise, the catalogue's numbers stay.

    Parameters
    ----------
    studies : the study with the drive of each measured run. candidates : effects that may be missing.
    """
    if not any(candidate.name == NAME for candidate in candidates):
        return ComputedWave()
    shares = [(_fastest(study) / ring, study) for study in studies if (ring := _ring(study)) > 0]
    share, study = max(shares, key=lambda pair: pair[0], default=(0.0, None))
    if study is None or share < NEAR:
        return ComputedWave()
    near = f"the drive reaches {share:.0%} of the speed of waves on the belt as a ring"
    generic = "the effect standing-wave has the general numbers of the catalogue"
    if study.card.mechanics.strain != "fem":
        return ComputedWave(None, f'{near}; {generic}: those of this tyre need mechanics.strain = "fem"')
    if tick is not None:
        tick("computing the standing wave")
    try:
        rise = _KEPT.get(_key(study), lambda: _rise(study))
    except InputError as error:
        return ComputedWave(None, f"{near}; {generic}, because its own could not be computed: {error.message}")
    onset = rise.onset
    if onset is None:
        return ComputedWave(None, f"{near}; {generic}, because the heat of this tyre hardly rises below its own")
    return ComputedWave(
        onset,
        f"{near}; the effect standing-wave has numbers computed from the mechanics of this tyre: onset at "
        f"{onset.critical_speed:.3g} m/s, gain {onset.gain:.2g}, factor of the heat within {onset.error:.2f}",
    )


def _fastest(study: StudyData) -> float:
    return max(motion_in(phase, share).speed for phase in study.card.drive.phases for share in (0.0, 1.0))


def _ring(study: StudyData) -> float:
    pressures = [phase.pressure.at(share) for phase in study.card.drive.phases for share in (0.0, 1.0)]
    return ring_speed(study, min(pressures))


def _key(study: StudyData) -> tuple[object, ...]:
    phase = study.card.drive.phases[0]
    driven = phase.pressure.start, repr(phase.load), repr(phase.deflection), phase.drum_diameter
    return inputs(study), repr(values_read(FEM_ROLLING, study.materials)), study.card.drive.initial, driven


def _rise(study: StudyData) -> Amplification:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResultWarning)
        critical = critical_speed(study)
        wave = critical.belt or critical.any_wave
        if wave is None:
            raise InputError("no wave stands below 200 m/s")
        return amplification(study, wave.speed)
