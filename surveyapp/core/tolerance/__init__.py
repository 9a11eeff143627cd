"""Rule books applied: quantities, formulas of limits, what an orientation answers of them."""

from __future__ import annotations

from surveyapp.core.tolerance.evaluate import Measured, limits_for, rule_book_checks
from surveyapp.core.tolerance.measures import measure
from surveyapp.core.tolerance.quantities import QUANTITIES, Quantity

__all__ = ["QUANTITIES", "Measured", "Quantity", "limits_for", "measure", "rule_book_checks"]
