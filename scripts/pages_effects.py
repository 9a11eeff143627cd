"""Reference pages of the effects, one per subject, from the catalogue."""

from __future__ import annotations

from surveyapp_models.effects import CATALOGUE, Effect
from surveyapp_models.effects.effect import SUBJECTS

TITLES = {
    "reversal_run": "a reversal run",
    "campaign": "a campaign of constants and azimuths",
    "traverse": "a traverse",
    "compass": "a compass",
    "tilt": "a tilt sensor",
    "rate": "a rate sensor",
}
GENERATED = "*This page is generated from the catalogue of effects; do not edit it.*"


def pages() -> dict[str, str]:
    """Text of each page by its path below docs/."""
    result = {}
    for subject in SUBJECTS:
        effects = [effect for effect in CATALOGUE if effect.subject == subject]
        if effects:
            head = [f"# Effects of {TITLES[subject]}", "", GENERATED, ""]
            body = [line for effect in effects for line in section(effect)]
            result[f"reference/effects/{subject}.md"] = "\n".join([*head, *body]).rstrip() + "\n"
    return result


def section(effect: Effect) -> list[str]:
    """Lines of one effect."""
    lines = [f"## `{effect.id}`: {effect.title}", "", f"It looks as if {effect.symptom}.", ""]
    lines += ["| coefficient | unit | plausible range | meaning |", "|---|---|---|---|"]
    lines += [
        f"| {c.name} | {c.unit} | {c.low:g} to {c.high:g} | {c.meaning} |"
        for c in effect.coefficients
    ]
    lines += ["", "- Needs: " + "; ".join(f"`{c.name}` ({c.unit})" for c in effect.needs)]
    lines += [f"- Scanned: {g.name} [{g.unit}], {g.meaning}" for g in effect.grid]
    acts = {
        "midpoint": "moves the result",
        "amplitude": "changes the amplitude law of the swing",
        "observation": "spoils a single observation",
    }
    lines += [f"- Acts: {acts[effect.acts_on]}" + (" (a loss only)" if effect.one_sided else "")]
    if effect.per:
        lines += [f"- Belongs to: {effect.per}"]
    lines += [
        f"- Datum: {effect.datum}",
        f"- Source: {effect.source}",
        f"- Remedy: {effect.remedy}",
    ]
    if effect.confusable_with:
        lines += ["- Easily taken for: " + ", ".join(f"`{i}`" for i in effect.confusable_with)]
    return [*lines, f"- Told apart by: {effect.separate_by}", ""]
