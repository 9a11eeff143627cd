"""One session as rows of text."""

from __future__ import annotations

from surveyapp.core.observing.steps import current_step
from surveyapp.domain.project import Project
from surveyapp.domain.results import OrientationResult, SessionResult
from surveyapp.languages import translated
from surveyapp.tui import texts
from surveyapp.tui.views.form import angle_text, arcsec_text, number_text, sigma_text, small_text
from surveyapp_models.angles import AngleUnit

Pairs = list[tuple[str, str]]

SESSION_COLUMNS = (
    texts.COL_SESSION,
    texts.COL_METHOD,
    texts.COL_POINTS,
    texts.COL_NORTH,
    texts.COL_AZIMUTH,
    texts.COL_SIGMA,
)


def session_rows(project: Project, result: OrientationResult) -> list[tuple[str, ...]]:
    """Each session of the project in one row, also those without a result yet."""
    unit = project.angle_unit
    results = {session.id: session for session in result.sessions}
    whole = project.filing.project_closing is not None
    closed = {item.session for item in project.filing.closings}
    rows: list[tuple[str, ...]] = []
    for item in project.sessions:
        session = results.get(item.id)
        name = texts.CLOSED_MARK.format(id=item.id) if whole or item.id in closed else item.id
        if session is None:
            step = current_step(item.book, item.method)
            rows.append((name, translated(item.method), "", texts.STEP_NAMES[step], "", ""))
            continue
        main = session.main
        azimuth = None if main is None else main.gyro_azimuth
        rows.append(
            (
                name,
                translated(session.method),
                str(session.points_used),
                angle_text(session.gyro_north, unit),
                angle_text(azimuth, unit),
                sigma_text(azimuth if azimuth is not None else session.gyro_north),
            )
        )
    return rows


def session_details(session: SessionResult, unit: AngleUnit) -> Pairs:
    """Label and value of everything that is known of a session."""
    pairs: Pairs = [
        (texts.D_STATION, session.station),
        (texts.D_INSTRUMENT, session.instrument),
        (texts.D_PURPOSE, texts.PURPOSES.get(session.purpose, session.purpose)),
        (texts.D_ESTIMATOR, translated(session.estimator or "")),
        (texts.D_POINTS, f"{session.points_used}, {session.dof}"),
    ]
    if session.gyro_north is not None:
        north = f'{angle_text(session.gyro_north, unit)}  ±{sigma_text(session.gyro_north)}"'
        pairs.append((texts.COL_NORTH, north))
    pairs += _swing(session, unit)
    for target in session.targets:
        if target.line_reading is not None:
            label = texts.D_READING.format(target=target.target)
            reading = (
                f'{angle_text(target.line_reading, unit)}  ±{sigma_text(target.line_reading)}"'
            )
            pairs.append((label, reading))
        if target.gyro_azimuth is not None:
            label = texts.D_AZIMUTH.format(target=target.target)
            azimuth = (
                f'{angle_text(target.gyro_azimuth, unit)}  ±{sigma_text(target.gyro_azimuth)}"'
            )
            pairs.append((label, azimuth))
        if target.collimation is not None:
            pairs.append((texts.D_COLLIMATION, small_text(target.collimation)))
        if target.drift is not None:
            pairs.append((texts.D_DRIFT, small_text(target.drift)))
    return pairs


def _swing(session: SessionResult, unit: AngleUnit) -> Pairs:
    pairs: Pairs = []
    if session.interval95 is not None:
        pairs.append((texts.D_INTERVAL, f'±{arcsec_text(session.interval95)}"'))
    if session.sigma_source is not None:
        pairs.append((texts.D_SIGMA_SOURCE, translated(session.sigma_source)))
    if session.residual_rms is not None:
        pairs.append((texts.D_RMS, f'{arcsec_text(session.residual_rms)}"'))
    if session.amplitude is not None:
        pairs.append((texts.D_AMPLITUDE, small_text(session.amplitude).lstrip("+")))
    if session.damping_per_half_swing is not None:
        pairs.append((texts.D_DAMPING, number_text(session.damping_per_half_swing, 5)))
    if session.period_s is not None:
        pairs.append((texts.D_PERIOD, f"{number_text(session.period_s)} s"))
    zero = session.tape_zero
    if zero is not None:
        values = f"{number_text(zero.before_div, 3, sign=True)}, "
        values += f"{number_text(zero.after_div, 3, sign=True)} div"
        pairs.append((texts.D_ZERO, values))
        pairs.append((texts.D_ZERO_CORRECTION, small_text(zero.correction)))
    return pairs
