"""The earth's rate along the axis of a table, whichever way the axis leans.

A table leans by tenths of a degree, unknown against north. Along its axis the earth's rate is then
not that along the vertical: three tenths of a degree are up to .08 deg/h, which looks like a bias
that follows gravity. What comes round once a turn tells: across the axis the accelerometers show
gravity, the gyros the earth's rate, and the angle between gravity and the earth's axis is known
from the latitude. Of both only what comes round is used, so that biases do not matter.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from surveyapp.core.sensors.rate.table_log import Turned
from surveyapp.core.sensors.rate.turning import round_the_turn
from surveyapp.domain.sensor_log import STANDARD_GRAVITY_M_S2, SensorLog
from surveyapp_models.constants import EARTH_RATE

STEEP = 0.5
"""Share of gravity across the axis, 30 degrees, beyond which it is no table that leans."""


def axis_rate(
    log: SensorLog, turned: Sequence[Turned], axis: int, *, latitude: float
) -> tuple[float, bool]:
    """The earth's rate along a table's axis, upwards, and whether the axis was measured.

    With w and g what comes round of rate and specific force, in thousandths of which the unit's
    own errors do not matter, the rate is (W sin(latitude) G - w.g) / sqrt(G^2 - g.g); W and G are
    the earth's rate and gravity. Its error is that of w times the tilt.

    Parameters
    ----------
    log : SensorLog
        With the gyros; without accelerometers the axis is taken for vertical.
    turned : sequence of Turned
        Of one position.
    axis : int
        Body axis along the table's.
    latitude : float
        [rad]

    Returns
    -------
    rate : float
        [rad/s]
    measured : bool
    """
    level = EARTH_RATE * math.sin(latitude)
    across = ["xyz"[(axis + 1) % 3], "xyz"[(axis + 2) % 3]]
    forces = [f"acc_{a}_m_s2" for a in across]
    whole = [t.stretch for t in turned if t.whole]
    if not whole or not log.has(*forces):
        return level, False
    products, squares, counts = [], [], []
    for stretch in whole:
        force = np.array([round_the_turn(stretch, log.columns[c]) for c in forces])
        rate = np.array([round_the_turn(stretch, log.columns[f"gyr_{a}_rad_s"]) for a in across])
        products.append(0.5 * float(np.sum(rate * force)))
        squares.append(0.5 * float(np.sum(force * force)))
        counts.append(stretch.stop - stretch.start)
    product, square = np.average([products, squares], axis=1, weights=counts).tolist()
    share = square / STANDARD_GRAVITY_M_S2**2
    if not share < STEEP**2:
        return level, False
    along = (level - product / STANDARD_GRAVITY_M_S2) / math.sqrt(1.0 - share)
    return along, True
