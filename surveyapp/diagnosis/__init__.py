"""Find the residual, name the effect, prove it: one engine for every subject.

``reversal_run`` and ``campaign`` make a ``Case`` of observations, ``diagnose`` returns a
``Diagnosis``, ``plain_words`` tells it to a surveyor.
"""

from __future__ import annotations

from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.engine import diagnose
from surveyapp.diagnosis.plain_words import plain_words
from surveyapp.diagnosis.result import Diagnosis
from surveyapp.diagnosis.subjects.campaign import CampaignDetermination, campaign
from surveyapp.diagnosis.subjects.reversal_run import TurningPoints, reversal_run

__all__ = [
    "CampaignDetermination",
    "Diagnosis",
    "Case",
    "TurningPoints",
    "campaign",
    "diagnose",
    "plain_words",
    "reversal_run",
]
