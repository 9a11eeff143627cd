"""Single rows of the log are wrong: a knock, a lost bit, a spark; as in a compass log."""

from __future__ import annotations

from dataclasses import replace

from surveyapp_models.effects.compass import gross_error
from surveyapp_models.effects.effect import Coefficient

EFFECT = replace(
    gross_error.EFFECT,
    subject="tilt",
    coefficients=(Coefficient("error", "arcsec", 1.0, -1e6, 1e6, "reading too large by"),),
    confusable_with=("scale_nonlinearity",),
)
