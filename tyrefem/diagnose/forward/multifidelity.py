"""Readings at a point of a fit: by the reduced model of the drive if it is certified, else by simulation."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.diagnose.forward.evaluations import SIMULATION, Evaluations
from tyrefem.diagnose.forward.forward_model import FOLLOWED, NOT_FOLLOWED
from tyrefem.diagnose.forward.reduced_drive import Modes
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns.candidates import Members
from tyrefem.diagnose.unknowns.unknown import Unknown

Array = NDArray[np.float64]
Values = Mapping[Unknown, float]
Tick = Callable[[], None] | None
#: Parts of a Jacobian by a reduced model.
PARTS = 2


@dataclass(frozen=True)
class DriveCertificate:
    """Certificate of a drive's reduced model for a set of effects: its differences from fixed-step simulations.

    Parameters
    ----------
    members, number : the set of effects, and the number of the drive. allowed : largest accepted whitened norm.
    whitened_norm : largest whitened norm of the difference; infinite if the model cannot represent the effects.
    error : largest difference of a block mean, K. cases : number of compared points.
    """

    members: Members
    number: int
    allowed: float
    whitened_norm: float = 0.0
    error: float = 0.0
    cases: int = 0

    @property
    def good(self) -> bool:
        """Whether the model may be used for these effects at this drive."""
        return self.whitened_norm <= self.allowed

    def with_case(self, whitened_norm: float, error: float) -> DriveCertificate:
        """The certificate with one more point."""
        worst = max(whitened_norm, self.whitened_norm), max(error, self.error)
        return DriveCertificate(self.members, self.number, self.allowed, *worst, self.cases + 1)


@dataclass(eq=False)
class Predictions(Brief):
    """Predictions and sensitivities at the drives of a forward model, by reduced models where they are certified.

    The first point of every set of effects at every drive is also simulated with fixed steps; the difference gives the
    certificate. A set is simulated if its effects cannot be reduced, or if the difference exceeds the settings.
    The object is mutable: it collects the certificates.

    Parameters
    ----------
    modes : POD modes by drive; empty: simulations only.
    certificates : set and number of the drive -> certificate. reduced, simulated : points evaluated by either model.
    given_up : the reduced models failed at the best fit, and the search was repeated without them.
    """

    evaluations: Evaluations
    modes: Sequence[Modes] = ()
    certificates: dict[tuple[Members, int], DriveCertificate] = field(default_factory=dict)
    reduced: int = 0
    simulated: int = 0
    given_up: bool = False

    @functools.cached_property
    def simulating(self) -> Predictions:
        """The same predictions by simulations only; they count among these.

        With fifty unknowns and more a simulation and its tangents take no longer than a reduced model, and the
        temperatures at the sensors are known there.
        """
        return Predictions(self.evaluations)

    @property
    def settings(self) -> DiagnosisSettings:
        """Settings of the forward model."""
        return self.evaluations.model.settings

    def predict(
        self, queries: Sequence[tuple[Members, Values]], numbers: Sequence[int], tick: Tick = None
    ) -> list[list[Array]]:
        """Block means at some drives for every pair of a set and its values; NaN for an impossible tyre."""
        wanted = [(k, i) for k in range(len(queries)) for i in numbers]
        # A point without a certificate is simulated in any case: together with the reduced models, no worker waits.
        certain = [(k, i) for k, i in wanted if not self._is_certified(queries[k][0], i)]
        blocks, answers = self._by_model(queries, numbers, tick, certain)
        left = [pair for pair in wanted if pair not in blocks and pair not in answers]
        further = self.evaluations.of(SIMULATION, [(i, queries[k][1]) for k, i in left], tick)
        answers |= dict(zip(left, further, strict=True))
        self.simulated += len(answers)
        for (k, i), answer in answers.items():
            modal = blocks.get((k, i))
            if modal is not None and (
                not np.isfinite(modal).all() or self._certificate_after(queries[k][0], i, modal, answer).good
            ):
                continue
            blocks[k, i] = answer
        return [[blocks[k, i] for i in numbers] for k in range(len(queries))]

    def jacobians(
        self, queries: Sequence[tuple[Members, tuple[Unknown, ...], Values]], numbers: Sequence[int], tick: Tick = None
    ) -> list[list[Array]]:
        """Jacobians (n_blocks, n_unknowns) at some drives for every set with its unknowns and values."""
        wanted = [(k, i) for k in range(len(queries)) for i in numbers]
        modal = [(k, i) for k, i in wanted if self.modes and self._is_certified(queries[k][0], i)]
        tables = self._by_slopes(queries, modal, tick)
        # A model that holds here may not follow some of the further effects: only these are simulated.
        left = {(k, i): np.arange(len(queries[k][1])) for k, i in wanted if (k, i) not in tables}
        left |= {
            pair: columns
            for pair, jacobian in tables.items()
            if len(columns := np.flatnonzero(~np.isfinite(jacobian).all(axis=0)))
        }
        questions = [
            (i, tuple(queries[k][1][column] for column in columns), queries[k][2]) for (k, i), columns in left.items()
        ]
        for (k, i), jacobian in zip(left, self.evaluations.of("jacobian", questions, tick), strict=True):
            table = tables.setdefault((k, i), np.empty((len(jacobian), len(queries[k][1]))))
            table[:, left[k, i]] = jacobian
        return [[tables[k, i] for i in numbers] for k in range(len(queries))]

    def _by_slopes(
        self,
        queries: Sequence[tuple[Members, tuple[Unknown, ...], Values]],
        pairs: Sequence[tuple[int, int]],
        tick: Tick,
    ) -> dict[tuple[int, int], Array]:
        """(number of the query, number of the drive) -> Jacobian by the reduced model, where it can be used.

        Every Jacobian is computed in `PARTS`, which cost as much: three drives keep two processes busy. Their number
        does not depend on that of the processes, so that the numbers do not.
        """
        parts = [(k, i, slice(part, None, PARTS)) for k, i in pairs for part in range(PARTS)]
        questions = [(i, self.modes[i], queries[k][1][columns], queries[k][2]) for k, i, columns in parts]
        tables: dict[tuple[int, int], Array] = {}
        left_out: set[tuple[int, int]] = set()
        for (k, i, columns), (status, jacobian) in zip(
            parts, self.evaluations.of("reduced_jacobian", questions, tick), strict=True
        ):
            if status[0] != FOLLOWED:
                left_out.add((k, i))
            table = tables.setdefault((k, i), np.empty((len(jacobian), len(queries[k][1]))))
            table[:, columns] = jacobian
        return {pair: table for pair, table in tables.items() if pair not in left_out}

    def give_up(self) -> None:
        """Use no reduced models from here on: they failed at the best fit."""
        self.modes, self.given_up = (), True

    def error_at(self, members: Members, values: Values) -> float:
        """Largest difference from simulations, as a whitened norm, where reduced models gave the readings.

        0 where they gave none; infinite if a model has no answer at this point.
        """
        numbers = [
            i for i in range(len(self.evaluations.model.drives)) if self.modes and self._is_certified(members, i)
        ]
        modal, answers = self._by_model([(members, values)], numbers, None, [(0, i) for i in numbers])
        self.simulated += len(numbers)
        errors = [0.0]
        for i in numbers:
            row = modal.get((0, i))
            errors.append(
                np.inf if row is None else self._certificate_after(members, i, row, answers[0, i]).whitened_norm
            )
        return float(max(errors))

    def to_dict(self) -> dict[str, Any]:
        """Contents of `verdict.json` under "reduced"."""
        good = [certificate for certificate in self.certificates.values() if certificate.good]
        names = [drive.name for drive in self.evaluations.model.drives]
        return {
            "used": bool(good) and not self.given_up,
            "modes": {name: modes.V.shape[1] for name, modes in zip(names, self.modes, strict=False)},
            "points_by_reduced_models": self.reduced,
            "points_by_lean_simulations": self.simulated + self.simulating.simulated,
            "allowed_whitened": self.settings.reduced_allowed,
            "worst_whitened": max((certificate.whitened_norm for certificate in good), default=None),
            "worst_K": max((certificate.error for certificate in good), default=None),
            "certificates": [
                {
                    "effects": [member.key for member in certificate.members],
                    "run": names[certificate.number],
                    "used": certificate.good,
                    "points": certificate.cases,
                    "whitened": certificate.whitened_norm if certificate.cases else None,
                    "worst_K": certificate.error if certificate.cases else None,
                }
                for certificate in self.certificates.values()
            ],
        }

    def _by_model(
        self,
        queries: Sequence[tuple[Members, Values]],
        numbers: Sequence[int],
        tick: Tick,
        simulated: Sequence[tuple[int, int]],
    ) -> tuple[dict[tuple[int, int], Array], dict[tuple[int, int], Array]]:
        """(number of the query, number of the drive) -> block means by reduced models, where they can be used.

        Also those by simulations, at the places ``simulated``.
        """
        places = {i: [k for k, (members, _) in enumerate(queries) if self._is_allowed(members, i)] for i in numbers}
        places = {i: places_here for i, places_here in places.items() if places_here}
        by_models = [
            ("reduced", (i, self.modes[i], tuple(queries[k][1] for k in places_here)))
            for i, places_here in places.items()
        ]
        simulations = [(SIMULATION, (i, queries[k][1])) for k, i in simulated]
        answers = self.evaluations.together([*by_models, *simulations], tick and (lambda _: tick()))
        modal: dict[tuple[int, int], Array] = {}
        for (i, places_here), (status, blocks) in zip(places.items(), answers[: len(places)], strict=True):
            for k, state, row in zip(places_here, status, blocks, strict=True):
                if state == NOT_FOLLOWED:
                    members = queries[k][0]
                    self.certificates[members, i] = DriveCertificate(
                        members, i, self.settings.reduced_allowed, whitened_norm=np.inf, error=np.inf
                    )
                elif state == FOLLOWED:
                    modal[k, i] = row
        self.reduced += len(modal)
        return modal, dict(zip(simulated, answers[len(places) :], strict=True))

    def _is_allowed(self, members: Members, number: int) -> bool:
        """Whether there is a reduced model of the drive, and no certificate that rejects it for this set."""
        if not self.modes or not self.modes[number].V.shape[1]:
            return False
        known = self.certificates.get((members, number))
        return known is None or known.good

    def _is_certified(self, members: Members, number: int) -> bool:
        known = self.certificates.get((members, number))
        return known is not None and known.good

    def _certificate_after(self, members: Members, number: int, modal: Array, simulated: Array) -> DriveCertificate:
        """The certificate after one more point."""
        known = self.certificates.get((members, number)) or DriveCertificate(
            members, number, self.settings.reduced_allowed
        )
        whitened_norm = float(np.linalg.norm(self.evaluations.model.drives[number].whitened(modal - simulated)))
        error = float(np.abs(modal - simulated).max(initial=0.0))
        finite = np.isfinite(whitened_norm)
        certificate = known.with_case(whitened_norm if finite else np.inf, error if finite else np.inf)
        self.certificates[members, number] = certificate
        return certificate
