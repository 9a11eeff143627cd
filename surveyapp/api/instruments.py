"""Total stations on the cable for scripts, re-exported by ``surveyapp.api``."""

from __future__ import annotations

import time
from collections.abc import Callable

from surveyapp.domain.instrument_reading import FollowedTurn, InstrumentReading

READINGS_PER_SECOND = 10.0


def read_instrument(
    where: str, *, distance: bool = False, timeout_s: float = 5.0
) -> InstrumentReading:
    """Read circle, zenith and, if wanted, a distance from a total station.

    Parameters
    ----------
    where : str
        ``protocol:port`` or ``protocol:port@baud``.
    distance : bool
        Whether a distance is measured.
    timeout_s : float
        How long an answer may take.

    Raises
    ------
    SurveyError
        No answer in time, another protocol or unit, a cable that was pulled out.
    """
    from surveyapp.io.instruments.cable import Cable
    from surveyapp.io.instruments.catalogue import instrument_port

    port = instrument_port(where)
    with Cable(port.port, baud=port.baud, timeout_s=timeout_s) as cable:
        return port.protocol.everything(cable) if distance else port.protocol.angles(cable)


def follow_turn(
    where: str,
    *,
    seconds: float = 30.0,
    timeout_s: float = 2.0,
    going: Callable[[int, float], bool] | None = None,
) -> FollowedTurn:
    """Read the circle ten times a second around a turning point and fit a parabola.

    Parameters
    ----------
    where : str
        ``protocol:port`` or ``protocol:port@baud``.
    seconds : float
        How long.
    timeout_s : float
        How long one answer may take.
    going : callable or None
        Told the number of readings and the latest [rad]; False ends it.

    Raises
    ------
    SurveyError
        As ``read_instrument``; readings that do not bend.
    """
    from surveyapp.core.observing.followed_turn import followed_turn
    from surveyapp.io.instruments.cable import Cable
    from surveyapp.io.instruments.catalogue import instrument_port

    port = instrument_port(where)
    moments: list[float] = []
    readings: list[float] = []
    with Cable(port.port, baud=port.baud, timeout_s=timeout_s) as cable:
        start = time.monotonic()
        while (begun := time.monotonic()) - start < seconds:
            reading = port.protocol.angles(cable)
            moments.append(0.5 * (begun + time.monotonic()) - start)
            readings.append(reading.hz)
            if going is not None and not going(len(readings), reading.hz):
                break
            rest = 1.0 / READINGS_PER_SECOND - (time.monotonic() - begun)
            if rest > 0.0:
                time.sleep(rest)
    return followed_turn(moments, readings)
