"""Rule books applied: quantities, formulas of limits, what an orientation answers of them.

``measures`` is imported where it is used: it takes the whole orientation with it, and who only
reads a rule book needs none of that.
"""

from __future__ import annotations

from surveyapp.core.tolerance.evaluate import Measured, limits_for, rule_book_checks
from surveyapp.core.tolerance.quantities import QUANTITIES, Quantity

__all__ = ["QUANTITIES", "Measured", "Quantity", "limits_for", "rule_book_checks"]
