"""Whether the instrument stood level enough for itself: level rows against the card."""

from __future__ import annotations

from surveyapp.core.orientation.whole_project import Orientation
from surveyapp.core.swing.levelling import tilt_of
from surveyapp.domain.results import Check
from surveyapp.domain.subject import Subject
from surveyapp_models.angles import RHO_ARCSEC


def levelling_checks(orientation: Orientation) -> list[Check]:
    """Largest tilt of each session that read both levels, against the limit of its card."""
    checks = []
    for item in orientation.sessions:
        tilt = tilt_of(item.session.book, tape_zero=False)
        if tilt is None:
            continue
        card = orientation.project.instrument(item.session.instrument).card
        largest = max(abs(tilt.along), abs(tilt.across)) * RHO_ARCSEC
        limit = None if card.valid.level is None else card.valid.level * RHO_ARCSEC
        checks.append(
            Check(
                rule="levelling.tilt",
                clause=f"card {card.id}, range.level_arcsec",
                value=largest,
                limit=limit,
                confirmed=False,
                passed=None if limit is None else largest <= limit,
                unit="arcsec",
                where=item.session.id,
                text=(
                    f'tilt along {tilt.along * RHO_ARCSEC:+.1f}", across '
                    f'{tilt.across * RHO_ARCSEC:+.1f}", compensated in the sights'
                ),
                subject=Subject.session(item.session.id),
            )
        )
    return checks
