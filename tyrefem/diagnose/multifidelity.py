"""What the sensors read at a point of a fit: by a drive's reduced model where it is certified, else by simulation."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.diagnose.candidates import Members
from tyrefem.diagnose.evaluations import Evaluations
from tyrefem.diagnose.forward_model import FOLLOWED, NOT_FOLLOWED
from tyrefem.diagnose.reduced_forward import Modes
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns import Unknown

Array = NDArray[np.float64]
Values = Mapping[Unknown, float]
Tick = Callable[[], None] | None


@dataclass(frozen=True)
class DriveCertificate:
    """What simulations say of a drive's reduced model with a set of effects, at points it had not learnt.

    Parameters
    ----------
    members, number : which effects, which trial. apart : largest whitened norm of what is between the two; infinite
        where the model cannot follow. error : largest difference of a block mean, K. cases : points.
    """

    members: Members
    number: int
    allowed: float
    apart: float = 0.0
    error: float = 0.0
    cases: int = 0

    @property
    def good(self) -> bool:
        """May the model speak for these effects at this drive?"""
        return self.apart <= self.allowed

    def with_case(self, apart: float, error: float) -> DriveCertificate:
        """After one more point."""
        worst = max(apart, self.apart), max(error, self.error)
        return DriveCertificate(self.members, self.number, self.allowed, *worst, self.cases + 1)


@dataclass(eq=False)
class Predictions(Brief):
    """Predictions and tangents at the drives of a forward model, each by the cheapest model that may answer.

    The first point of every set of effects at every drive is simulated on fixed steps as well: that is the
    certificate. Where a model cannot follow a set's effects, or is off by more than the settings allow, the set stays
    with the simulation. This object keeps the certificates, so it changes while it answers.

    Parameters
    ----------
    modes : of every trial's drive; none: simulations only.
    certificates : set and trial -> what is known. reduced, simulated : how many points either answered.
    given_up : the models were off at the best fit, which was then found without them.
    """

    evaluations: Evaluations
    modes: Sequence[Modes] = ()
    certificates: dict[tuple[Members, int], DriveCertificate] = field(default_factory=dict)
    reduced: int = 0
    simulated: int = 0
    given_up: bool = False

    @property
    def settings(self) -> DiagnosisSettings:
        """Those of the forward model."""
        return self.evaluations.model.settings

    def predict(
        self, asking: Sequence[tuple[Members, Values]], numbers: Sequence[int], tick: Tick = None
    ) -> list[list[Array]]:
        """Block means of some trials for every set and its point; NaN where no tyre can be so."""
        blocks = self._by_model(asking, numbers, tick)
        fresh = {
            (place, i) for (place, i), row in blocks.items()
            if (asking[place][0], i) not in self.certificates and np.isfinite(row).all()
        }  # fmt: skip
        left = [(k, i) for k in range(len(asking)) for i in numbers if (k, i) not in blocks or (k, i) in fresh]
        answers = self.evaluations.of("predict", [(i, asking[k][1]) for k, i in left], tick)
        self.simulated += len(left)
        for (k, i), answer in zip(left, answers, strict=True):
            if (k, i) in fresh and self._tried(asking[k][0], i, blocks[k, i], answer).good:
                continue
            blocks[k, i] = answer
        return [[blocks[k, i] for i in numbers] for k in range(len(asking))]

    def jacobians(
        self, asking: Sequence[tuple[Members, tuple[Unknown, ...], Values]], numbers: Sequence[int], tick: Tick = None
    ) -> list[list[Array]]:
        """(n_blocks, n_unknowns) of some trials for every set, its unknowns and its point."""
        wanted = [(k, i) for k in range(len(asking)) for i in numbers]
        modal = [(k, i) for k, i in wanted if self.modes and self._known_good(asking[k][0], i)]
        answers = self.evaluations.of("reduced_jacobian", [(i, self.modes[i], *asking[k][1:]) for k, i in modal], tick)
        tables = {
            pair: jacobian for pair, (status, jacobian) in zip(modal, answers, strict=True) if status[0] == FOLLOWED
        }
        left = [pair for pair in wanted if pair not in tables]
        tables |= zip(left, self.evaluations.of("jacobian", [(i, *asking[k][1:]) for k, i in left], tick), strict=True)
        return [[tables[k, i] for i in numbers] for k in range(len(asking))]

    def confirmed(self, members: Members, values: Values) -> bool:
        """Is a point that matters what the simulation says, at every drive where the model spoke for it?"""
        numbers = [i for i in range(len(self.evaluations.model.drives)) if self.modes and self._known_good(members, i)]
        modal = self._by_model([(members, values)], numbers, None)
        answers = self.evaluations.of("predict", [(i, values) for i in numbers])
        self.simulated += len(numbers)
        pairs = [(i, modal.get((0, i)), answer) for i, answer in zip(numbers, answers, strict=True)]
        return all(row is not None and self._tried(members, i, row, answer).good for i, row, answer in pairs)

    def to_dict(self) -> dict[str, Any]:
        """For `verdict.json`."""
        good = [certificate for certificate in self.certificates.values() if certificate.good]
        names = [drive.name for drive in self.evaluations.model.drives]
        return {
            "used": bool(good) and not self.given_up,
            "modes": {name: modes.V.shape[1] for name, modes in zip(names, self.modes, strict=False)},
            "points_by_reduced_models": self.reduced,
            "points_by_lean_simulations": self.simulated,
            "allowed_whitened": self.settings.reduced_allowed,
            "worst_whitened": max((certificate.apart for certificate in good), default=None),
            "worst_K": max((certificate.error for certificate in good), default=None),
            "certificates": [
                {
                    "effects": [member.key for member in certificate.members],
                    "run": names[certificate.number],
                    "used": certificate.good,
                    "points": certificate.cases,
                    "whitened": certificate.apart if certificate.cases else None,
                    "worst_K": certificate.error if certificate.cases else None,
                }
                for certificate in self.certificates.values()
            ],
        }

    def _by_model(
        self, asking: Sequence[tuple[Members, Values]], numbers: Sequence[int], tick: Tick
    ) -> dict[tuple[int, int], Array]:
        """(place, trial) -> block means by the models, of what they may be asked and can follow."""
        places = {i: [k for k, (members, _) in enumerate(asking) if self._may(members, i)] for i in numbers}
        places = {i: places_here for i, places_here in places.items() if places_here}
        questions = [(i, self.modes[i], tuple(asking[k][1] for k in places_here)) for i, places_here in places.items()]
        modal: dict[tuple[int, int], Array] = {}
        for (i, places_here), (status, blocks) in zip(
            places.items(), self.evaluations.of("reduced", questions, tick), strict=True
        ):
            for k, state, row in zip(places_here, status, blocks, strict=True):
                if state == NOT_FOLLOWED:
                    members = asking[k][0]
                    self.certificates[members, i] = DriveCertificate(
                        members, i, self.settings.reduced_allowed, apart=np.inf, error=np.inf
                    )
                elif state == FOLLOWED:
                    modal[k, i] = row
        self.reduced += len(modal)
        return modal

    def _may(self, members: Members, number: int) -> bool:
        """May the model be asked: is it there, and has nothing been said against it?"""
        if not self.modes or not self.modes[number].V.shape[1]:
            return False
        known = self.certificates.get((members, number))
        return known is None or known.good

    def _known_good(self, members: Members, number: int) -> bool:
        known = self.certificates.get((members, number))
        return known is not None and known.good

    def _tried(self, members: Members, number: int, modal: Array, simulated: Array) -> DriveCertificate:
        """The certificate after one more point."""
        known = self.certificates.get((members, number)) or DriveCertificate(
            members, number, self.settings.reduced_allowed
        )
        apart = float(np.linalg.norm(self.evaluations.model.drives[number].whitened(modal - simulated)))
        error = float(np.abs(modal - simulated).max(initial=0.0))
        finite = np.isfinite(apart)
        certificate = known.with_case(apart if finite else np.inf, error if finite else np.inf)
        self.certificates[members, number] = certificate
        return certificate
