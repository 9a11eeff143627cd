"""Networks: approximate coordinates, adjustment, quality, closures, compass rule.

``adjust`` is the entrance; the linear algebra is ``surveyapp.core.leastsquares``.
"""

from surveyapp.core.network.adjustment import adjust

__all__ = ["adjust"]
