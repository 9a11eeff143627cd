"""The keys of the session screen: one list for bindings, footer, palette and entry line."""

from __future__ import annotations

from surveyapp.tui import texts

KEYS = {
    "f1": ("help", texts.KEY_HELP, texts.LONG_HELP),
    "f2": ("other('kind')", texts.KEY_KIND, texts.LONG_KIND),
    "f3": ("other('face')", texts.KEY_FACE, texts.LONG_FACE),
    "f4": ("other('target')", texts.KEY_TARGET, texts.LONG_TARGET),
    "f5": ("missed", texts.KEY_MISSED, texts.LONG_MISSED),
    "f6": ("strike", texts.KEY_STRIKE, texts.LONG_STRIKE),
    "ctrl+z": ("undo", texts.KEY_UNDO, texts.LONG_UNDO),
    "f7": ("step(-1)", texts.KEY_PREVIOUS, texts.LONG_PREVIOUS),
    "f8": ("step(1)", texts.KEY_NEXT, texts.LONG_NEXT),
    "f9": ("instrument", texts.KEY_INSTRUMENT, texts.LONG_INSTRUMENT),
    "shift+f9": ("follow", texts.KEY_FOLLOW, texts.LONG_FOLLOW),
    "escape": ("leave", texts.KEY_LEAVE, texts.LONG_LEAVE),
    "ctrl+n": ("remark", texts.KEY_REMARK, texts.LONG_REMARK),
    "ctrl+o": ("typing_up", texts.KEY_TYPING_UP, texts.LONG_TYPING_UP),
    "ctrl+t": ("passage", texts.LONG_PASSAGE, texts.LONG_PASSAGE),
}
"""Action, name in the footer, name in the palette."""
ORDERED = {key: action for key, (action, *_) in KEYS.items()} | {"empty_space": "passage"}
"""Keys that the entry line works off in their order; the bindings show them and serve the rest."""
HIDDEN = ("undo", "remark", "typing_up", "passage", "instrument", "follow")
"""Actions for which 80 columns have no room; the palette and F1 name them."""
