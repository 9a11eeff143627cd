"""The pages of an adjusted traverse: blocks of the record, and the global test in a few words."""

from __future__ import annotations

from collections.abc import Sequence

from surveyapp.domain.adjustment import AdjustmentResult
from surveyapp.domain.results import Check
from surveyapp.languages import joined
from surveyapp.report.blocks import Block, Paragraph
from surveyapp.report.numbers import plain
from surveyapp.report.sections import checks as of_checks
from surveyapp.report.sections import traverse as section
from surveyapp.tui import texts
from surveyapp_models.angles import AngleUnit


def pages(
    result: AdjustmentResult, checks: Sequence[Check], unit: AngleUnit
) -> dict[str, tuple[Block, ...]]:
    """Blocks by the id of their page; lists have every row."""
    warnings = (Paragraph(joined(": ", (w.code, w.text)), "warning") for w in result.warnings)
    return {
        "adjustment": (
            section.facts(result),
            *section.closures(result),
            *section.shared(result, unit),
            *section.suspicions(result),
            *warnings,
        ),
        "points": (section.points(result),),
        "observations": (section.observation_table(result, unit, result.observations),),
        "checks": (of_checks.table(checks),),
    }


def state_text(result: AdjustmentResult) -> str:
    """The global test in a few words."""
    test = result.global_test
    if test.ratio is None:
        return texts.T_UNCONTROLLED
    word = {True: texts.MET, False: texts.NOT_MET, None: texts.OPEN}[test.passed]
    return texts.T_STATE.format(ratio=plain(test.ratio, 2), dof=result.dof, word=word)
