"""The verdict beside discrepancy models: effects that act whatever else is wrong, though more is."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from typing import NamedTuple

from tyrefem.diagnose.beside.discrepancy import NONE
from tyrefem.diagnose.beside.free_heat import FreeHeat
from tyrefem.diagnose.beside.robustness import Robustness, UnderDiscrepancy
from tyrefem.diagnose.numbers import at_least, percent
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns.candidates import Candidate, Members
from tyrefem.diagnose.verdicts.verdict import CONFOUNDED, IDENTIFIED, NO_GAP, PARTLY, UNEXPLAINED, Judgement

#: Effects alone, without a discrepancy, are excluded below this probability.
NOT_EXCLUDED = 0.01


class Revision(NamedTuple):
    """A verdict with what else may be wrong, its ``reasons`` and ``doubts``, and ``members``, the effects that are part
    of the cause if it is "partly identified"."""

    verdict: str
    reasons: tuple[str, ...]
    doubts: tuple[str, ...]
    members: Members = ()

    def because(self, reason: str) -> Revision:
        """The same verdict with a further reason."""
        return self._replace(reasons=(*self.reasons, reason))

    def doubted(self, doubt: str) -> Revision:
        """Unexplained for a further reason."""
        sentence = f"{doubt[0].upper()}{doubt[1:]}."
        return Revision(UNEXPLAINED, (*self.reasons, doubt), (*self.doubts, sentence))


def beside_discrepancies(
    judgement: Judgement,
    robustness: Robustness,
    settings: DiagnosisSettings,
    *,
    law_replaced: bool = False,
    heat: FreeHeat | None = None,
) -> Revision:
    """The verdict with what else may be wrong, and the effects that are part of the cause.

    - *identified* stays if every member acts with at least 95 % probability, averaged over the discrepancy models by
      their probabilities. *confounded* stays unless the data exclude that effects alone are wrong (`NOT_EXCLUDED`).
    - *partly identified*: more is wrong than effects, and some act with at least 95 % probability beside every
      discrepancy model, with amounts that agree; beside the most probable model noise explains the misfit, and the
      held-out runs are predicted no worse with each of them than without it, and with all of them. Heat of unknown
      origin does not explain the data by itself.
      They act in all runs, as the strain energy may differ from run to run, too.
    - *unexplained*: more is wrong, and there is no such effect.

    ``law_replaced``: the study's strain law was wrong, and another one stands in its place; nothing is "identified".
    ``heat``: heat of unknown origin without and beside the effects that are about to be named.
    """
    leading, least = robustness.models[0], settings.named_probability
    revision = _questioned(judgement, robustness, least, law_replaced=law_replaced)
    if revision is None:
        return Revision(judgement.verdict, judgement.reasons, judgement.doubts)
    revision, members = _acting_anyway(revision, robustness, least)
    if not members or len([member for member in members if member not in leading.allowed]) > settings.largest:
        return revision
    held_out = tuple(member for member in members if _predicts_held_out(leading, (member,)))
    if len(held_out) > 1 and not _predicts_held_out(leading, held_out):
        held_out = ()
    if held_out != members:
        worse = _keys(member for member in members if member not in held_out)
        doubt = f"{worse} is not named: the held-out runs are predicted better without it"
        if not held_out:
            return revision.doubted(doubt)
        revision, members = revision.because(doubt), held_out
    keys = _keys(members)
    if heat is not None and heat.explains(settings.free_heat_lead):
        doubt = f"{keys} is not named: heat of unknown origin explains the data about as well"
        return revision.because(doubt) if revision.verdict == CONFOUNDED else revision.doubted(doubt)
    smallest = min(robustness.least(member.key) for member in members)
    reason = f"{keys} acts with {at_least(smallest)} probability whatever else is wrong"
    return revision.because(reason)._replace(verdict=PARTLY, members=members)


def _keys(members: Iterable[Candidate]) -> str:
    return " + ".join(member.key for member in members)


def _questioned(judgement: Judgement, robustness: Robustness, least: float, *, law_replaced: bool) -> Revision | None:
    """The verdict if more may be wrong than effects; None: the verdict on effects alone stays."""
    revision, leading = Revision(judgement.verdict, judgement.reasons, judgement.doubts), robustness.models[0]
    if judgement.verdict == NO_GAP:
        return None
    if judgement.verdict == IDENTIFIED:
        doubtful = [each for each in judgement.best.members if robustness.mean(each.key) < least]
        if doubtful:
            return revision.doubted(_doubt(robustness, doubtful[0]))
        return revision.doubted("the study's strain law is not that of the data") if law_replaced else None
    if judgement.verdict == CONFOUNDED:
        if leading.name == NONE:
            return None
        asked_for = f"the data ask for {leading.words} ({percent(leading.probability)})"
        if robustness.as_it_is < NOT_EXCLUDED:
            return revision.doubted(asked_for)
        return revision.because(f"{asked_for}, but do not exclude effects alone")
    return revision


def _acting_anyway(revision: Revision, robustness: Robustness, least: float) -> tuple[Revision, Members]:
    """The effects that act in all runs beside every discrepancy, and the verdict with the reasons against others."""
    leading = robustness.models[0]
    members = robustness.robust(leading.effects, least)
    for member in replace(robustness, laws=()).robust(leading.effects, least):
        if member not in members:
            law = min(robustness.counted, key=lambda law: law.named.get(member.key, 0.0))
            revision = revision.because(
                f"{member.key} is not named: with {law.words} it is less probable, or of the other sign"
            )
    for member in (member for member in members if member in robustness.idle):
        revision = revision.because(
            f"{member.key} is not named: beside the films' speed laws in full the data do not ask for it"
        )
    members = tuple(member for member in members if member not in robustness.idle)
    for member in filter(robustness.is_none, members):
        revision = revision.because(f"{member.key} is not named: its amount may as well be none")
    members = tuple(member for member in members if not robustness.is_none(member))
    single = tuple(member for member in members if member.runs)
    if not single:
        return revision, members
    runs = ", ".join(dict.fromkeys(run for each in single for run in each.runs))
    doubt = f"{_keys(single)} is not named: no other run tells it from what else differs in {runs}"
    members = tuple(member for member in members if member not in single)
    keeps = members or revision.verdict == CONFOUNDED
    return revision.because(doubt) if keeps else revision.doubted(doubt), members


def _doubt(robustness: Robustness, member: Candidate) -> str:
    """Why a member of an identified set is not needed beside a probable discrepancy."""
    against = min(robustness.models, key=lambda model: (model.named.get(member.key, 0.0) - 1) * model.probability)
    return (
        f"with {against.words}, for which the data speak ({percent(against.probability)}), "
        f"{member.key} acts with {percent(against.named.get(member.key, 0.0))} only"
    )


def _predicts_held_out(model: UnderDiscrepancy, members: Members) -> bool:
    """Whether the best fitted set with these effects predicts the held-out runs no worse than any set without one."""
    if all(math.isnan(fit.held_out) for fit in model.fits.values()):
        return True
    with_them, without = model.held_out(members)
    return with_them >= without
