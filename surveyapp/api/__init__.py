"""What scripts call: the same functions as the command line, on values instead of text.

Every function returns a frozen dataclass with ``to_dict()``, the JSON of the command of its name.
Each subject has a module of its own behind this one, which is all that scripts import.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any, Final

from surveyapp.api.batch import batch, batch_rows
from surveyapp.api.closing import close, reopen
from surveyapp.api.demonstrating import demo_sensors
from surveyapp.api.importing import export_survey, import_file
from surveyapp.api.instruments import follow_turn, read_instrument
from surveyapp.api.judgement import check, diagnose, subjects
from surveyapp.api.network import (
    adjust,
    adjust_network,
    compass_rule,
    data_snooping,
    network,
    variance_components,
)
from surveyapp.api.office import (
    blank_form,
    compare,
    export_csv,
    export_gkf,
    export_json,
    export_zip,
    report,
    report_text,
)
from surveyapp.api.orientation import (
    Source,
    compute,
    demo,
    generator_of,
    orient,
    plan,
    unfinished,
)
from surveyapp.api.penetration import (
    Trial,
    cluster_executor,
    has_breakthrough,
    predict,
    record_step,
    trial,
)
from surveyapp.api.pooling import diagnose_instrument
from surveyapp.api.programmes import (
    begin_programme,
    finish_programme,
    programme_state,
    programmes,
    record_programme,
)
from surveyapp.api.project import (
    SOFTWARE,
    Folder,
    model,
    models,
    new_project,
    open_project,
    simulate,
)
from surveyapp.api.rate import motion, north, plan_fog_station, plan_north_stops, spectrum
from surveyapp.api.sensor_diagnosis import diagnose_log, diagnose_sensor
from surveyapp.api.sensor_files import add_sensor_log, preview_sensor_log, sensor_pictures
from surveyapp.api.sensors import (
    LogOptions,
    allan,
    calibrate,
    compensate,
    filter_log,
    open_sensor_log,
)
from surveyapp.api.shafts import has_shafts, shaft
from surveyapp.api.sheets import write_sheets
from surveyapp.domain.adjustment import AdjustmentResult
from surveyapp.domain.calibration import Calibration
from surveyapp.domain.fieldfile import ImportResult
from surveyapp.domain.instrument import InstrumentCard
from surveyapp.domain.project import Project
from surveyapp.domain.results import Check, OrientationResult, Subject, Verdicts
from surveyapp.domain.subject import SubjectKeyword
from surveyapp.domain.traverse import Network
from surveyapp.errors import Problem, SurveyError

if TYPE_CHECKING:
    from surveyapp.api.sensors import OpenedLog
    from surveyapp.core.comparison import DemonstratedSample
    from surveyapp.core.network.bowditch import CompassResult
    from surveyapp.core.network.snooping import SnoopingResult
    from surveyapp.core.network.variance_components import VarianceComponent
    from surveyapp.core.plan import StationPlan
    from surveyapp.core.sensors.rate.fog_station_plan import FogStationPlan
    from surveyapp.core.sensors.rate.stop_plan import StopPlan
    from surveyapp.diagnosis.sensors.diagnosis import SensorDiagnosis
    from surveyapp.domain.chart import SensorPictures
    from surveyapp.domain.demonstrated import DemonstratedSensor
    from surveyapp.domain.filing import (
        BatchResult,
        BatchRow,
        ClosingResult,
        ComparisonResult,
        ExportResult,
        MadeProject,
    )
    from surveyapp.domain.instrument_reading import FollowedTurn, InstrumentReading
    from surveyapp.domain.line_spectrum import LineSpectrum
    from surveyapp.domain.log_preview import LogPreview
    from surveyapp.domain.motion import Motion
    from surveyapp.domain.noise import AllanResult, FilterResult
    from surveyapp.domain.north import NorthResult
    from surveyapp.domain.penetration_result import Prediction
    from surveyapp.domain.programme import Programme, ProgrammeResult, ProgrammeState
    from surveyapp.domain.records import Listing
    from surveyapp.domain.results import (
        AngleResult,
        CombinedResult,
        ConstantResult,
        LineResult,
        SessionResult,
    )
    from surveyapp.domain.shaft_result import ShaftResult
    from surveyapp.domain.warning import ResultWarning
    from surveyapp.io.simulated import SimulatedFiles
    from surveyapp.report.written import ReportResult, SheetsResult
    from surveyapp.workflows.choosing import Diagnosable
    from surveyapp.workflows.compensating import CompensationResult
    from surveyapp.workflows.computing import Computed
    from surveyapp.workflows.diagnosing import Diagnosed
    from surveyapp.workflows.diagnosing_sensor import SensorDiagnosed
    from surveyapp.workflows.pooling import InstrumentDiagnosis

_TYPES: Final = {
    "SensorDiagnosis": "surveyapp.diagnosis.sensors.diagnosis",
    "CombinedResult": "surveyapp.domain.results",
    "CompensationResult": "surveyapp.workflows.compensating",
    "FilterResult": "surveyapp.domain.noise",
    "AllanResult": "surveyapp.domain.noise",
    "AngleResult": "surveyapp.domain.results",
    "BatchResult": "surveyapp.domain.filing",
    "BatchRow": "surveyapp.domain.filing",
    "ClosingResult": "surveyapp.domain.filing",
    "ComparisonResult": "surveyapp.domain.filing",
    "CompassResult": "surveyapp.core.network.bowditch",
    "Computed": "surveyapp.workflows.computing",
    "ConstantResult": "surveyapp.domain.results",
    "DemonstratedSample": "surveyapp.core.comparison",
    "DemonstratedSensor": "surveyapp.domain.demonstrated",
    "Diagnosable": "surveyapp.workflows.choosing",
    "Diagnosed": "surveyapp.workflows.diagnosing",
    "ExportResult": "surveyapp.domain.filing",
    "SnoopingResult": "surveyapp.core.network.snooping",
    "FogStationPlan": "surveyapp.core.sensors.rate.fog_station_plan",
    "FollowedTurn": "surveyapp.domain.instrument_reading",
    "InstrumentDiagnosis": "surveyapp.workflows.pooling",
    "InstrumentReading": "surveyapp.domain.instrument_reading",
    "LineResult": "surveyapp.domain.results",
    "LineSpectrum": "surveyapp.domain.line_spectrum",
    "Listing": "surveyapp.domain.records",
    "LogPreview": "surveyapp.domain.log_preview",
    "MadeProject": "surveyapp.domain.filing",
    "Motion": "surveyapp.domain.motion",
    "NorthResult": "surveyapp.domain.north",
    "OpenedLog": "surveyapp.api.sensors",
    "Prediction": "surveyapp.domain.penetration_result",
    "Programme": "surveyapp.domain.programme",
    "ProgrammeResult": "surveyapp.domain.programme",
    "ProgrammeState": "surveyapp.domain.programme",
    "ReportResult": "surveyapp.report.written",
    "ResultWarning": "surveyapp.domain.project",
    "SensorDiagnosed": "surveyapp.workflows.diagnosing_sensor",
    "SensorPictures": "surveyapp.domain.chart",
    "SessionResult": "surveyapp.domain.results",
    "ShaftResult": "surveyapp.domain.shaft_result",
    "SheetsResult": "surveyapp.report.written",
    "SimulatedFiles": "surveyapp.io.simulated",
    "StationPlan": "surveyapp.core.plan",
    "StopPlan": "surveyapp.core.sensors.rate.stop_plan",
    "VarianceComponent": "surveyapp.core.network.variance_components",
}
"""Types of results by the module that holds them: a script that names one imports it then."""


def __getattr__(name: str) -> Any:
    """Types of results, found when they are asked for: nothing is loaded for the others."""
    if name not in _TYPES:
        raise AttributeError(f"surveyapp.api has no {name}")
    return getattr(importlib.import_module(_TYPES[name]), name)


__all__ = [
    "Folder",
    "Source",
    "SOFTWARE",
    "open_project",
    "new_project",
    "simulate",
    "models",
    "model",
    "plan",
    "unfinished",
    "compute",
    "orient",
    "demo",
    "demo_sensors",
    "generator_of",
    "network",
    "adjust",
    "adjust_network",
    "compass_rule",
    "variance_components",
    "data_snooping",
    "SubjectKeyword",
    "predict",
    "cluster_executor",
    "Trial",
    "has_breakthrough",
    "record_step",
    "has_shafts",
    "trial",
    "shaft",
    "subjects",
    "check",
    "diagnose",
    "diagnose_sensor",
    "allan",
    "diagnose_instrument",
    "calibrate",
    "filter_log",
    "compensate",
    "diagnose_log",
    "plan_fog_station",
    "plan_north_stops",
    "north",
    "spectrum",
    "motion",
    "open_sensor_log",
    "LogOptions",
    "preview_sensor_log",
    "add_sensor_log",
    "sensor_pictures",
    "programmes",
    "begin_programme",
    "programme_state",
    "record_programme",
    "finish_programme",
    "batch",
    "batch_rows",
    "report",
    "report_text",
    "write_sheets",
    "blank_form",
    "close",
    "reopen",
    "compare",
    "read_instrument",
    "follow_turn",
    "import_file",
    "export_survey",
    "export_csv",
    "export_gkf",
    "export_json",
    "export_zip",
    "AdjustmentResult",
    "SheetsResult",
    "SnoopingResult",
    "ImportResult",
    "Calibration",
    "InstrumentCard",
    "Project",
    "Check",
    "Subject",
    "Verdicts",
    "OrientationResult",
    "Network",
    "Problem",
    "SurveyError",
    "AngleResult",
    "BatchResult",
    "BatchRow",
    "ClosingResult",
    "CombinedResult",
    "ComparisonResult",
    "CompassResult",
    "Computed",
    "ConstantResult",
    "DemonstratedSample",
    "Diagnosable",
    "Diagnosed",
    "ExportResult",
    "FogStationPlan",
    "FollowedTurn",
    "InstrumentDiagnosis",
    "InstrumentReading",
    "LineResult",
    "LineSpectrum",
    "Listing",
    "MadeProject",
    "Motion",
    "SensorDiagnosed",
    "StopPlan",
    "NorthResult",
    "OpenedLog",
    "Prediction",
    "ReportResult",
    "ResultWarning",
    "SessionResult",
    "ShaftResult",
    "SimulatedFiles",
    "StationPlan",
    "VarianceComponent",
    "AllanResult",
    "FilterResult",
    "CompensationResult",
    "SensorDiagnosis",
    "LogPreview",
    "SensorPictures",
    "DemonstratedSensor",
    "Programme",
    "ProgrammeResult",
    "ProgrammeState",
]
