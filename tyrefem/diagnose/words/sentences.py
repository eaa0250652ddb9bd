"""The verdict in sentences: its paragraph, after a better strain law, before priors, noise and further looks."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tyrefem.diagnose.verdicts.prior_sensitivity import prior_words
from tyrefem.diagnose.verdicts.verdict import IDENTIFIED, UNEXPLAINED
from tyrefem.diagnose.words.looks import again_words
from tyrefem.diagnose.words.strain_laws import law_sentences
from tyrefem.diagnose.words.verdict_texts import VERDICT_TEXTS

if TYPE_CHECKING:
    from tyrefem.diagnose.diagnosis import DiagnosisData


def verdict_words(d: DiagnosisData) -> tuple[str, ...]:
    """The verdict in a few sentences, the most important first."""
    again = again_words(d) if d.verdict == IDENTIFIED else ()
    priors = () if d.verdict == UNEXPLAINED else prior_words(d.prior_sensitivity, d.verdict, d.named_effects)
    conformal = () if d.conformal is None else (d.conformal.words(d.judgement.ranking),)
    paragraph = VERDICT_TEXTS[d.verdict].paragraph(d)
    return (*law_sentences(d), *paragraph, *conformal, *priors, *noise_words(d), *again)


def noise_words(d: DiagnosisData) -> tuple[str, ...]:
    """What the readings say of their noise, if it is not the stated one; empty otherwise."""
    stated, scatter, used = d.stated_noise, d.noise_of_data, d.noise
    if abs(used - stated) > 0.01 * stated:
        return (
            f"The readings scatter by {scatter:.2g} K; the stated noise is {stated:.2g} K. "
            f"The diagnosis uses {used:.2g} K.",
        )
    if d.correlated_noise and scatter < stated:
        return (
            f"Neighbouring readings share noise: they scatter by {scatter:.2g} K. The stated noise, {stated:.2g} K, "
            "is kept; if it is too large, misfits go unnoticed.",
        )
    return ()
