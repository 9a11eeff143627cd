"""What could not be told apart, why, and which observation would decide it."""

from __future__ import annotations

import numpy as np

from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.compare import added_signal, best_with
from surveyapp.diagnosis.fits import Fit
from surveyapp.diagnosis.loop import NOISE_WORDS, Search, noise_words
from surveyapp.diagnosis.result import Ambiguity
from surveyapp.languages import joined, said, term

MOST_OPTIONS = 8
"""Sets that are told; the ledger has them all."""
SEPARATING = {
    "quadratic": said("a longer record, or the same at another time of day"),
    "smooth": said("a longer record"),
    "long_oscillation": said("a record of at least twice that period"),
    "periodic": said("a record of at least twice that period"),
    "pulse": said("the book itself, or a second run: a touch that came and went does not repeat"),
    "step": said("a repetition on the first part"),
    "amplitude_step": said("a second run, followed evenly"),
    "amplitude_smooth": said("a second run, begun with another amplitude"),
    "outlier": said("the book itself, or a repetition"),
    "random_walk": said("more observations, or a second record: a wandering north does not repeat"),
    "amplitude_walk": said("a second run, followed evenly: irregular following does not repeat"),
    "ar1": said("more observations, or a second record: correlated noise does not repeat"),
}


def ambiguities(problem: Case, found: Search) -> tuple[Ambiguity, ...]:
    """What is left in the sets within the margin once the adopted names are taken out."""
    if not found.near:
        return ()
    options: dict[str, Fit] = {}
    for fit in found.near:
        rest = [i for i in fit.effects if i not in found.adopted]
        if rest:
            options.setdefault(" + ".join(rest), fit)
    if not options:
        return ()
    for _, reason in found.refused:
        for kind in NOISE_WORDS:
            noise = best_with(found.levels[-1], kind)
            if noise_words(problem, kind) in reason and noise is not None:
                options.setdefault(kind, noise)
    best = min(fit.bic for fit in found.near)
    options = dict(list(options.items())[:MOST_OPTIONS])
    fits = list(options.values())
    texts = []
    for fit in fits:
        for identity in fit.effects:
            text = _separating(problem, identity)
            if identity not in found.adopted and text and text not in texts:
                texts.append(text)
    return (
        Ambiguity(
            tuple(options),
            tuple(fit.bic - best for fit in fits),
            _collinearity(fits, found.adopted),
            joined("; ", texts),
        ),
    )


def _separating(problem: Case, identity: str) -> str:
    for effect in problem.effects:
        if effect.id == identity:
            return term(effect.separate_by)
    return SEPARATING.get(identity, "")


def _collinearity(fits: list[Fit], adopted: tuple[str, ...]) -> float | None:
    """Correlation of what the two best sets add, None where one of them is stochastic."""
    signals = []
    for fit in fits[:2]:
        if fit.noise is not None:
            return None
        signal = added_signal(fit)
        keep = [i for i, m in enumerate(fit.members) if m.candidate.id not in adopted]
        if not keep:
            return None
        signals.append(signal[:, keep].sum(axis=1))
    if len(signals) < 2:
        return None
    size = float(np.linalg.norm(signals[0]) * np.linalg.norm(signals[1]))
    return float(abs(signals[0] @ signals[1]) / size) if size > 0.0 else None
