"""What scripts call: the same functions as the command line, on values instead of text.

Every function returns a frozen dataclass with ``to_dict()``, the JSON of the command of its name.
Each subject has a module of its own behind this one, which is all that scripts import.
"""

from __future__ import annotations

from surveyapp.api.batch import batch, batch_rows
from surveyapp.api.importing import export_survey, import_file
from surveyapp.api.instruments import follow_turn, read_instrument
from surveyapp.api.judgement import check, diagnose, diagnose_sensor, subjects
from surveyapp.api.network import (
    adjust,
    adjust_network,
    compass_rule,
    network,
    variance_components,
)
from surveyapp.api.office import (
    blank_form,
    close,
    compare,
    export_csv,
    export_gkf,
    export_json,
    export_zip,
    reopen,
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
    trial,
)
from surveyapp.api.pooling import diagnose_instrument
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
from surveyapp.api.sensors import LogOptions, calibrate, open_sensor_log
from surveyapp.api.shafts import has_shafts, shaft
from surveyapp.domain.adjustment import AdjustmentResult
from surveyapp.domain.calibration import Calibration
from surveyapp.domain.fieldfile import ImportResult
from surveyapp.domain.instrument import InstrumentCard
from surveyapp.domain.project import Project
from surveyapp.domain.results import Check, OrientationResult, Subject, Verdicts
from surveyapp.domain.subject import SubjectKeyword
from surveyapp.domain.traverse import Network
from surveyapp.errors import Problem, SurveyError

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
    "generator_of",
    "network",
    "adjust",
    "adjust_network",
    "compass_rule",
    "variance_components",
    "SubjectKeyword",
    "predict",
    "cluster_executor",
    "Trial",
    "has_breakthrough",
    "has_shafts",
    "trial",
    "shaft",
    "subjects",
    "check",
    "diagnose",
    "diagnose_sensor",
    "diagnose_instrument",
    "calibrate",
    "plan_fog_station",
    "plan_north_stops",
    "north",
    "spectrum",
    "motion",
    "open_sensor_log",
    "LogOptions",
    "batch",
    "batch_rows",
    "report",
    "report_text",
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
]
