"""When a reading was taken: one unbroken clock for a session, whatever the computer's clock does.

Seconds come from a clock that never goes back and runs on while the computer sleeps; the wall
clock is asked once, when the session is opened. Setting it afterwards changes no reading.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Final

from surveyapp.domain.readings import Reading

NOTICED_S: Final = 2.0
"""A wall clock further off than this was set."""


@dataclass(frozen=True, slots=True)
class Stamp:
    """The moment of a reading.

    Parameters
    ----------
    time : datetime
        With UTC offset.
    elapsed_s : float
        Since the first row of the book.
    """

    time: datetime
    elapsed_s: float


def steady_seconds() -> float:
    """Seconds that never go back and that count while the computer sleeps, where it can tell."""
    boot = getattr(time, "CLOCK_BOOTTIME", None)
    return time.monotonic() if boot is None else time.clock_gettime(boot)


def local_now() -> datetime:
    """The wall clock with the UTC offset in force."""
    return datetime.now().astimezone()


class SessionClock:
    """Stamps the readings of one session.

    Parameters
    ----------
    rows : sequence of Reading
        What stands in the book: the clock goes on behind it.
    now : callable
        The wall clock.
    steady : callable
        Seconds that never go back.
    """

    __slots__ = ("_base", "_elapsed", "_now", "_start", "_steady", "set_back_s")

    def __init__(
        self,
        rows: tuple[Reading, ...],
        *,
        now: Callable[[], datetime] = local_now,
        steady: Callable[[], float] = steady_seconds,
    ) -> None:
        self._now, self._steady = now, steady
        self._start = steady()
        self._base = now()
        self._elapsed = max((r.elapsed_s for r in rows if r.elapsed_s is not None), default=0.0)
        self.set_back_s = 0.0
        dated = [row for row in rows if row.time is not None]
        both = [row for row in dated if row.elapsed_s is not None]
        last = (both or dated)[-1].time if dated else None
        if last is not None:
            gap = (self._base - last).total_seconds()
            if gap < -NOTICED_S:
                self.set_back_s = -gap
                self._base = last
            else:
                self._elapsed += max(gap, 0.0)

    def stamp(self) -> Stamp:
        """The present moment."""
        return self._at(self._steady() - self._start)

    def _at(self, seconds: float) -> Stamp:
        moment = self._base + timedelta(seconds=seconds)
        zone = self._now().tzinfo  # its offset changes in the night of the daylight-saving change
        return Stamp(moment.astimezone(zone), self._elapsed + seconds)

    def corrected(self, stamp: Stamp, seconds: float) -> Stamp:
        """A stamp moved by some seconds."""
        return Stamp(stamp.time + timedelta(seconds=seconds), stamp.elapsed_s + seconds)

    def wall_clock_off_s(self) -> float:
        """How far the wall clock has been set since the session was opened [s], 0 if it was not."""
        expected = self.stamp().time
        off = (self._now() - expected).total_seconds()
        return off if abs(off) > NOTICED_S else 0.0
