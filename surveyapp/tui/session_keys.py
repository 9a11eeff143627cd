"""The keys of the session screen: one list for bindings, footer, palette and entry line."""

from __future__ import annotations

from surveyapp.tui import texts

KEYS = {
    "f1": ("help", texts.KEY_HELP),
    "f2": ("other('kind')", texts.KEY_KIND),
    "f3": ("other('face')", texts.KEY_FACE),
    "f4": ("other('target')", texts.KEY_TARGET),
    "f5": ("missed", texts.KEY_MISSED),
    "f6": ("strike", texts.KEY_STRIKE),
    "ctrl+z": ("undo", texts.KEY_UNDO),
    "f7": ("step(-1)", texts.KEY_PREVIOUS),
    "f8": ("step(1)", texts.KEY_NEXT),
    "escape": ("leave", texts.KEY_LEAVE),
}
ORDERED = {key: action for key, (action, _) in KEYS.items()} | {"empty_space": "passage"}
"""Keys that the entry line works off in their order; the bindings show them and serve the rest."""
HIDDEN = ("undo",)
"""Actions for which 80 columns have no room; the palette and F1 name them."""
