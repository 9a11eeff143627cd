"""What is allowed at the meeting point: the project's own word, else the rule book's class.

A tolerance is compared with factor times sigma; the factor is a key of the rule book too.
"""

from __future__ import annotations

from collections.abc import Sequence

from surveyapp.core.tolerance import limits_for
from surveyapp.domain.penetration import Penetration, StatedTolerance
from surveyapp.domain.penetration_result import MissSigma, Tolerance
from surveyapp.domain.rulebook import Limit, RuleBook
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import joined, said, term

DEFAULT_FACTOR = 2.0
QUANTITIES = ("lateral", "longitudinal", "vertical")


def factor_of(
    plan: Penetration, book: RuleBook | None
) -> tuple[float, str, tuple[ResultWarning, ...]]:
    """Factor from sigma to prediction, where it comes from, and warnings."""
    if plan.factor is not None:
        return plan.factor, "project", ()
    if book is not None:
        found = limits_for(book, "penetration_factor", class_name=str(plan.tunnel))
        if found:
            limit, value = found[0]
            return value, f"{book.id}.{limit.id}", ()
    text = said(
        "neither the project nor a rule book states a factor: {default_factor:g} "
        "is taken; set factor in [penetration]",
        default_factor=DEFAULT_FACTOR,
    )
    return DEFAULT_FACTOR, "assumed", (ResultWarning("factor_assumed", text),)


def tolerance_of(
    plan: Penetration, book: RuleBook | None, length_km: float
) -> tuple[Tolerance | None, tuple[ResultWarning, ...]]:
    """Tolerance of every component, None where nobody states any.

    Parameters
    ----------
    plan : Penetration
    book : RuleBook or None
    length_km : float
        Of the drive between the starts, for limits that depend on it [km].
    """
    stated = plan.tolerance or StatedTolerance()
    own = (stated.lateral_m, stated.longitudinal_m, stated.vertical_m)
    ruled = [_ruled(plan, book, quantity, length_km) for quantity in QUANTITIES]
    warnings: list[ResultWarning] = []
    values: list[float | None] = []
    confirmed: list[bool] = []
    sources: list[str] = []
    for quantity, mine, limit in zip(QUANTITIES, own, ruled, strict=True):
        if mine is not None:
            values.append(mine)
            confirmed.append(True)
            sources.append(stated.source or "project")
            if limit is not None and abs(limit[1] - mine) > 1e-9:
                text = said(
                    "{quantity}: the project allows {mine:g} m, the rule book {limit:g} m "
                    "({id}); the project's is used",
                    quantity=quantity,
                    mine=mine,
                    limit=limit[1],
                    id=limit[0].id,
                )
                warnings.append(ResultWarning("tolerance_contradiction", text))
        elif limit is not None and book is not None:
            values.append(limit[1])
            confirmed.append(limit[0].confirmed)
            sources.append(f"{book.id}.{limit[0].id} ({limit[0].clause})")
        else:
            values.append(None)
            confirmed.append(True)
    if all(value is None for value in values):
        text = said("neither the project nor its rule book states a tolerance for this tunnel")
        return None, (ResultWarning("no_tolerance", text),)
    source = "; ".join(dict.fromkeys(sources))
    parts = (confirmed[0], confirmed[1], confirmed[2])
    found = Tolerance(values[0], values[1], values[2], source, all(parts), parts)
    if not found.confirmed:
        names = [q for q, sure in zip(QUANTITIES, parts, strict=True) if not sure]
        text = said(
            "the limit of {names} is not confirmed in a source: it only warns",
            names=joined(", ", [term(name) for name in names]),
        )
        warnings.append(ResultWarning("tolerance_unconfirmed", text))
    return found, tuple(warnings)


def _ruled(
    plan: Penetration, book: RuleBook | None, quantity: str, length_km: float
) -> tuple[Limit, float] | None:
    """Strictest limit of the rule book for this tunnel."""
    if book is None or quantity == "longitudinal":
        return None
    found: Sequence[tuple[Limit, float]] = limits_for(
        book, quantity, class_name=str(plan.tunnel), variables={"L": length_km}
    )
    return min(found, key=lambda item: item[1], default=None)


def judge(
    sigma: MissSigma, factor: float, tolerance: Tolerance | None
) -> tuple[bool | None, bool, tuple[ResultWarning, ...]]:
    """Whether the prediction passes, whether it fails a confirmed limit, and warnings."""
    if tolerance is None:
        return None, False, ()
    passed, confirmed_failure, judged, open_ones = True, False, 0, []
    names = zip(QUANTITIES, sigma.components(), tolerance.components(), strict=True)
    for i, (name, value, limit) in enumerate(names):
        if limit is None:
            continue
        if value is None:
            open_ones.append(name)
            continue
        judged += 1
        if factor * value > limit * (1.0 + 1e-12):
            passed = False
            confirmed_failure = confirmed_failure or tolerance.confirmed_parts[i]
    told: tuple[ResultWarning, ...] = ()
    if open_ones:
        text = said(
            "{open_ones}: a tolerance is stated and nothing to predict it from",
            open_ones=joined(", ", open_ones),
        )
        told = (ResultWarning("component_not_judged", text),)
    return (passed if judged else None), confirmed_failure, told
