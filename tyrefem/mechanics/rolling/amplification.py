"""How heat and strain cycle of the footprint rise with the speed, below a tyre's critical speed."""

from __future__ import annotations

import functools
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.errors import InputError, ResultWarning
from tyrefem.mechanics.footprint.loss import RevolutionLoss
from tyrefem.mechanics.rolling.press import press
from tyrefem.threads import one_thread

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData
    from tyrefem.mechanics.footprint.press import Pressed

Array = NDArray[np.float64]
#: Speeds over the critical speed; the first is that of the reference, where inertia does nothing.
SHARES = (0.02, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95)
#: Speeds that are added below the first one without a solution.
MORE = 4
#: Width of the onset of the effect ``standing-wave`` over its critical speed.
ONSET = 0.1


@dataclass(frozen=True)
class Rise:
    """A tyre at a speed, over the same tyre without inertia.

    Parameters
    ----------
    speed : m/s. resistance : energy lost per metre, N.
    loss : energy lost in a revolution over that of the slow tyre's strains with the same tan delta.
    strain : amplitude of the strain cycle over that of the slow tyre: root of the ratio of sum e_n : C' : e_n.
    limited : what the press says of waves that only loss limits; empty: none.
    """

    speed: float
    resistance: float
    loss: float
    strain: float
    limited: str = ""


@dataclass(frozen=True)
class Onset:
    """The effect ``standing-wave`` that comes nearest to a computed rise of the loss.

    1 + gain z log(1 + exp((v/v_c - 1)/z)), z = `ONSET`. ``error``: largest deviation of this factor.
    """

    gain: float
    critical_speed: float
    error: float

    def factor(self, speed: Array) -> Array:
        """The effect's factor at speeds, m/s."""
        u = (np.asarray(speed) / self.critical_speed - 1) / ONSET
        return np.asarray(1 + self.gain * ONSET * np.logaddexp(0.0, u))

    @classmethod
    def of(cls, speeds: Array, factors: Array) -> Onset:
        """Least squares of the factors; their logarithms, so that low speeds count too.

        >>> speeds = np.linspace(10, 80, 8)
        >>> fit = Onset.of(speeds, Onset(3.0, 70.0, 0.0).factor(speeds))
        >>> round(fit.gain, 3), round(fit.critical_speed, 2)
        (3.0, 70.0)
        """
        from scipy.optimize import least_squares

        speeds, factors = np.asarray(speeds), np.asarray(factors)

        def misfit(x: Array) -> Array:
            return np.asarray(np.log(cls(np.exp(x[0]), np.exp(x[1]), 0.0).factor(speeds) / factors))

        low, high = np.log([1e-3, 0.3 * speeds.max()]), np.log([100.0, 3.0 * speeds.max()])
        fits = [
            least_squares(misfit, np.log([gain, share * speeds.max()]), bounds=(low, high))
            for gain in (1.0, 10.0) for share in (0.7, 1.2)
        ]  # fmt: skip
        best = min(fits, key=lambda fit: float(fit.cost))
        onset = cls(float(np.exp(best.x[0])), float(np.exp(best.x[1])), 0.0)
        return cls(onset.gain, onset.critical_speed, float(np.abs(onset.factor(speeds) - factors).max()))


@dataclass(frozen=True, eq=False)
class Amplification(Brief):
    """Rise of heat and strain cycle with the speed. Made by `amplification`.

    Parameters
    ----------
    study : the study. pressure : Pa. temperature : degC of tan delta. load : N.
    rises : in order of speed. refused : the first speed without a solution, m/s, and why; None: all have one.
    """

    study: StudyData
    pressure: float
    temperature: float
    load: float
    rises: tuple[Rise, ...]
    refused: tuple[float, str] | None

    def _title(self) -> str:
        return f"of {self.study.name}"

    def _facts(self) -> Mapping[str, Any]:
        return {f"{rise.speed:.3g} m/s": f"{rise.loss:.3f}" for rise in self.rises}

    @functools.cached_property
    def onset(self) -> Onset | None:
        """The effect ``standing-wave`` nearest to the rise; None: the loss hardly rises, or at too few speeds."""
        speeds = np.array([rise.speed for rise in self.rises])
        factors = np.array([rise.loss for rise in self.rises])
        return Onset.of(speeds, factors) if len(speeds) >= 4 and factors.max() > 1.02 else None

    def summary(self) -> dict[str, Any]:
        """Results in SI as the keys state."""
        onset, refused = self.onset, self.refused
        return {
            "pressure_Pa": self.pressure,
            "temperature_degC": self.temperature,
            "load_N": self.load,
            "rises": self.rows(),
            "refused_m_s": refused and refused[0],
            "refused_because": refused and refused[1],
            "standing_wave": None
            if onset is None
            else {"gain": onset.gain, "critical_speed_m_s": onset.critical_speed, "largest_deviation": onset.error},
        }

    def rows(self) -> list[dict[str, Any]]:
        """Rows of the table, SI."""
        return [
            {
                "pressure_Pa": self.pressure,
                "temperature_degC": self.temperature,
                "load_N": self.load,
                "speed_m_s": rise.speed,
                "rolling_resistance_N": rise.resistance,
                "loss_factor": rise.loss,
                "strain_factor": rise.strain,
                "standing_wave_factor": None if self.onset is None else float(self.onset.factor(np.array(rise.speed))),
                "limited_by_loss_only": bool(rise.limited),
                "limited_because": rise.limited,
            }
            for rise in self.rises
        ]


def check(study: StudyData) -> None:
    """Raise `InputError` if the study's strains are not by finite elements."""
    if study.card.mechanics.strain != "fem":
        raise InputError(
            f"the rise of the heat needs strains by finite elements, not {study.card.mechanics.strain!r}: "
            'set mechanics.strain = "fem"',
            field="mechanics.strain",
            file=study.file,
        )


@one_thread()
def amplification(
    study: StudyData,
    critical: float,
    *,
    pressure: float | None = None,
    temperature: float | None = None,
    speeds: Sequence[float] | None = None,
) -> Amplification:
    """Roll a study's tyre at speeds below a critical one, with inertia and the cards' loss, in linear motion.

    Each speed is a press with ``[mechanics] rolling = true`` (`turning.turn`) under the load of the drive's first
    phase. Its loss is compared with that of the strains of a slow tyre, with tan delta at the same frequencies: what
    is left is what inertia does.

    Parameters
    ----------
    critical : critical speed, m/s. pressure : Pa; by default that of the first phase.
    temperature : degC of tan delta; by default the drive's initial one.
    speeds : m/s; by default shares of the critical speed, and four more below the first speed without a solution.

    Raises
    ------
    InputError : strains that are not by finite elements; a tyre without loss; errors of `press` at the lowest speed.

    >>> from tyrefem import study
    >>> tyre = study("nasa-22x5.5-8pr", {"mesh.size": "16 mm", "mechanics.strain": "fem"})
    >>> rise = amplification(tyre, 84.0, speeds=[1.0, 30.0, 60.0])
    >>> [round(each.loss, 1) for each in rise.rises]
    [1.0, 1.1, 1.4]
    """
    check(study)
    turning = study.replace({"mechanics.rolling": True, "mechanics.motion": "linear"})
    pressing = {} if pressure is None else {"pressure": pressure}
    warm = study.card.drive.initial if temperature is None else temperature
    wanted = sorted(critical * share for share in SHARES) if speeds is None else sorted(speeds)
    slow, _ = _turned(turning, wanted[0], pressing)
    rises, refused = _rises(turning, slow, wanted, pressing, warm)
    if refused is not None and speeds is None and rises:
        more = np.linspace(rises[-1].speed, refused[0], MORE + 2)[1:-1].tolist()
        others, earlier = _rises(turning, slow, more, pressing, warm)
        rises, refused = rises + others, earlier or refused
    return Amplification(study, slow.tyre.pressure, warm, slow.footprint.load, tuple(rises), refused)


def _rises(
    study: StudyData, slow: Pressed, speeds: Sequence[float], pressing: Mapping[str, Any], temperature: float
) -> tuple[list[Rise], tuple[float, str] | None]:
    """The rises up to the first speed without a solution, and this."""
    rises: list[Rise] = []
    for speed in speeds:
        try:
            tyre, limited = _turned(study, speed, pressing)
        except InputError as error:
            return rises, (speed, error.message)
        around = 2 * np.pi * tyre.footprint.rolling_radius
        lost, reference = (_lost(each, speed / around, temperature) for each in (tyre, slow))
        if reference == 0:
            message = f"the tyre loses nothing at {temperature:g} degC, so its heat does not rise: every tan delta is 0"
            raise InputError(message, field="materials", file=study.file)
        strain = float(np.sqrt(_energy(tyre) / _energy(slow)))
        rises.append(Rise(speed, lost / around, lost / reference, strain, limited))
    return rises, None


def _turned(study: StudyData, speed: float, pressing: Mapping[str, Any]) -> tuple[Pressed, str]:
    """The tyre at a speed, and what it warns of."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", ResultWarning)
        pressed = press(study, speed=speed, **pressing)
    return pressed, "; ".join(dict.fromkeys(str(warning.message) for warning in caught))


def _lost(tyre: Pressed, frequency: float, temperature: float) -> float:
    """Energy, J, that a tyre's strain cycle loses in a revolution, ``frequency`` revolutions per second, degC."""
    cards = {region: tyre.study.materials[region] for region in tyre.tyre.body.parts}
    speed = frequency * 2 * np.pi * tyre.footprint.rolling_radius
    loss = RevolutionLoss.of_cards(tyre.cycle, cards, speed, temperature)
    return loss.total(loss.density)


def _energy(tyre: Pressed) -> float:
    """Sum over the section and over the harmonics from the first on of e_n : C' : e_n, J per radian."""
    return float((tyre.cycle.storage_products[1:] * tyre.cycle.elements.weights).sum())
