"""Reference page of the columns of a campaign, from the one tuple that holds them."""

from __future__ import annotations

from surveyapp.core.orientation.campaign_columns import COLUMNS
from surveyapp_models.effects import of_subject

HEAD = """# Columns of a campaign

*This page is generated from `COLUMNS` of `surveyapp/core/orientation/campaign_columns.py`; do not
edit it.*

What an effect of a campaign may read, your own as well, and where each value comes from. A gap is
NaN; an effect whose column has gaps is not tested, and that is told.

| column | unit | what it is | read by |
|---|---|---|---|
"""


def pages() -> dict[str, str]:
    """Text of the page by its path below docs/."""
    readers = {
        column.name: [
            f"`{effect.id}`"
            for effect in of_subject("campaign")
            if any(need.name == column.name for need in effect.needs)
        ]
        for column in COLUMNS
    }
    rows = [
        f"| `{c.name}` | {c.unit} | {c.meaning} | {', '.join(readers[c.name])} |" for c in COLUMNS
    ]
    return {"reference/campaign-columns.md": HEAD + "\n".join(rows) + "\n"}
