"""Probabilities of a diagnosis as text."""

from __future__ import annotations


def percent(probability: float) -> str:
    """A probability as text, never rounded to 0 or 100 %.

    >>> percent(0.99286), percent(0.99987), percent(0.99999), percent(0.0004), percent(0.62)
    ('99.3 %', '99.99 %', 'more than 99.99 %', 'less than 0.1 %', '62 %')
    """
    if probability < 1e-3:
        return "less than 0.1 %"
    for above, decimals in ((0.9999, None), (0.999, 2), (0.98, 1)):
        if probability > above:
            return "more than 99.99 %" if decimals is None else f"{100 * probability:.{decimals}f} %"
    return f"{100 * probability:.0f} %" if probability >= 0.1 else f"{100 * probability:.1f} %"
