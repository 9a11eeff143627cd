"""When an effect is named in a sensor log: the whole rule, with its numbers.

1. Every effect is compared with the model without it, each under its best noise of ``noise``:
   white, AR(1), a random walk. The difference of their BIC is what it gains.
2. The one that gains most is named if it gains ``MARGIN``, and no other comes within ``NEAR`` of it
   that is no longer wanted once it is in the model; else none is, and both are told as not
   separable.
3. So on, up to ``MOST_EFFECTS``; an effect that a later one makes needless goes again.
4. ``doubts``: what a record cannot tell from the field of its room is not named after all; where
   the place is known, from any static field along its path (``room``).

The engine of short records has a rule of its own (``compare``, ``wandering``): it weighs some ten
observations, whose gain is bounded by their number, where here some hundred block means stand and
a wrong one gains 12 to 30 under noise that wanders. The shapes of that noise are the same
(``wander_shapes``).
"""

from __future__ import annotations

from typing import Final

MARGIN: Final = 12.0
"""BIC that an effect must gain over the best model without it: odds of e^6."""

NEAR: Final = 6.0
"""Effects whose BIC differs by less cannot be told apart."""

MOST_EFFECTS: Final = 5

ROOM_GRADIENT_UT: Final = 3.0
"""What the field of a room changes over the reach of an arm: without the attitude an effect on
the size of the field that is smaller cannot be told from it (BROAD 01: 1.3 uT); nor, without the
place, a switch: a carrier that is lifted has another field until it is put down."""

SIZE_MARGIN: Final = 40.0
"""BIC that an effect on the size of the field, or without the place, must gain where what remains
is not white: in simulated records walks of 6 uT reach 12 to 30, rooms without the place 23. With
the place a switch must gain as much beside the room: dipoles .6 m from the path, whose field is not
all of the fourth degree, reach 14 to 40, a switch of 1.5 uT gains 450."""
