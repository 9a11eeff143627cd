"""The catalogue of effects: one physical cause per file, one line per effect.

The catalogue is an explicit tuple. Nothing is found by itself: an effect that is not listed here
or handed over by the user does not exist.
"""

from __future__ import annotations

from surveyapp_models.effects import campaign, compass, rate, reversal_run, tilt, traverse
from surveyapp_models.effects.campaign import after_transport as _c_after_transport
from surveyapp_models.effects.campaign import circle_eccentricity as _c_circle_eccentricity
from surveyapp_models.effects.campaign import gyro_block as _c_gyro_block
from surveyapp_models.effects.campaign import humidity as _c_humidity
from surveyapp_models.effects.campaign import latitude as _c_latitude
from surveyapp_models.effects.campaign import line_offset as _c_line_offset
from surveyapp_models.effects.campaign import observer as _c_observer
from surveyapp_models.effects.campaign import pressure as _c_pressure
from surveyapp_models.effects.campaign import supply_voltage as _c_supply_voltage
from surveyapp_models.effects.campaign import temperature as _c_temperature
from surveyapp_models.effects.campaign import time_drift as _c_time_drift
from surveyapp_models.effects.campaign import transport_step as _c_transport_step
from surveyapp_models.effects.campaign import warm_up as _c_warm_up
from surveyapp_models.effects.compass import field_gradient as _m_field_gradient
from surveyapp_models.effects.compass import gross_error as _m_gross_error
from surveyapp_models.effects.compass import hard_iron as _m_hard_iron
from surveyapp_models.effects.compass import interference_step as _m_interference_step
from surveyapp_models.effects.compass import misalignment as _m_misalignment
from surveyapp_models.effects.compass import soft_iron as _m_soft_iron
from surveyapp_models.effects.compass import temperature as _m_temperature
from surveyapp_models.effects.effect import Effect, SubjectId
from surveyapp_models.effects.rate import bias_ramp as _s_bias_ramp
from surveyapp_models.effects.rate import flip_error as _s_flip_error
from surveyapp_models.effects.rate import g_sensitivity as _s_g_sensitivity
from surveyapp_models.effects.rate import gross_error as _s_gross_error
from surveyapp_models.effects.rate import interference_line as _s_interference_line
from surveyapp_models.effects.rate import magnetic_sensitivity as _s_magnetic_sensitivity
from surveyapp_models.effects.rate import scale_asymmetry as _s_scale_asymmetry
from surveyapp_models.effects.rate import temperature as _s_temperature
from surveyapp_models.effects.reversal_run import amplitude_asymmetry as _r_amplitude_asymmetry
from surveyapp_models.effects.reversal_run import damping_break as _r_damping_break
from surveyapp_models.effects.reversal_run import dry_friction as _r_dry_friction
from surveyapp_models.effects.reversal_run import gross_error as _r_gross_error
from surveyapp_models.effects.reversal_run import midpoint_drift as _r_midpoint_drift
from surveyapp_models.effects.reversal_run import midpoint_step as _r_midpoint_step
from surveyapp_models.effects.reversal_run import quadratic_drag as _r_quadratic_drag
from surveyapp_models.effects.reversal_run import secondary_oscillation as _r_secondary_oscillation
from surveyapp_models.effects.reversal_run import temperature as _r_temperature
from surveyapp_models.effects.reversal_run import warm_up as _r_warm_up
from surveyapp_models.effects.tilt import cross_axis as _l_cross_axis
from surveyapp_models.effects.tilt import gross_error as _l_gross_error
from surveyapp_models.effects.tilt import scale_nonlinearity as _l_scale_nonlinearity
from surveyapp_models.effects.tilt import temperature as _l_temperature
from surveyapp_models.effects.tilt import warm_up as _l_warm_up
from surveyapp_models.effects.traverse import angle_bias as _t_angle_bias
from surveyapp_models.effects.traverse import distance_constant as _t_distance_constant
from surveyapp_models.effects.traverse import distance_cyclic as _t_distance_cyclic
from surveyapp_models.effects.traverse import distance_scale as _t_distance_scale
from surveyapp_models.effects.traverse import distance_temperature as _t_distance_temperature
from surveyapp_models.effects.traverse import fixed_point as _t_fixed_point
from surveyapp_models.effects.traverse import gross_error as _t_gross_error
from surveyapp_models.effects.traverse import gyro_constant_shift as _t_gyro_constant_shift
from surveyapp_models.effects.traverse import lateral_refraction as _t_lateral_refraction
from surveyapp_models.effects.traverse import prism_constant as _t_prism_constant
from surveyapp_models.effects.traverse import station_centring as _t_station_centring

CATALOGUE: tuple[Effect, ...] = (
    _r_damping_break.EFFECT,
    _r_quadratic_drag.EFFECT,
    _r_dry_friction.EFFECT,
    _r_midpoint_drift.EFFECT,
    _r_midpoint_step.EFFECT,
    _r_warm_up.EFFECT,
    _r_secondary_oscillation.EFFECT,
    _r_temperature.EFFECT,
    _r_amplitude_asymmetry.EFFECT,
    _r_gross_error.EFFECT,
    _c_temperature.EFFECT,
    _c_latitude.EFFECT,
    _c_time_drift.EFFECT,
    _c_transport_step.EFFECT,
    _c_circle_eccentricity.EFFECT,
    _c_line_offset.EFFECT,
    _c_gyro_block.EFFECT,
    _c_warm_up.EFFECT,
    _c_observer.EFFECT,
    _c_pressure.EFFECT,
    _c_humidity.EFFECT,
    _c_supply_voltage.EFFECT,
    _c_after_transport.EFFECT,
    _t_distance_scale.EFFECT,
    _t_distance_constant.EFFECT,
    _t_distance_cyclic.EFFECT,
    _t_angle_bias.EFFECT,
    _t_lateral_refraction.EFFECT,
    _t_gyro_constant_shift.EFFECT,
    _t_distance_temperature.EFFECT,
    _t_prism_constant.EFFECT,
    _t_station_centring.EFFECT,
    _t_fixed_point.EFFECT,
    _t_gross_error.EFFECT,
    _s_g_sensitivity.EFFECT,
    _s_temperature.EFFECT,
    _s_bias_ramp.EFFECT,
    _s_scale_asymmetry.EFFECT,
    _s_flip_error.EFFECT,
    _s_magnetic_sensitivity.EFFECT,
    _s_interference_line.EFFECT,
    _s_gross_error.EFFECT,
    _m_hard_iron.EFFECT,
    _m_soft_iron.EFFECT,
    _m_misalignment.EFFECT,
    _m_temperature.EFFECT,
    _m_field_gradient.EFFECT,
    _m_interference_step.EFFECT,
    _m_gross_error.EFFECT,
    _l_cross_axis.EFFECT,
    _l_scale_nonlinearity.EFFECT,
    _l_temperature.EFFECT,
    _l_warm_up.EFFECT,
    _l_gross_error.EFFECT,
)


def of_subject(subject: SubjectId) -> tuple[Effect, ...]:
    """Effects of one subject in the order of the catalogue."""
    return tuple(effect for effect in CATALOGUE if effect.subject == subject)


__all__ = [
    "CATALOGUE",
    "Effect",
    "SubjectId",
    "campaign",
    "compass",
    "of_subject",
    "rate",
    "reversal_run",
    "tilt",
    "traverse",
]
