"""A field file as a traverse of a project: book, readings as read and tables, all of it planned."""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final

from surveyapp.core.fieldfile.precision import (
    FacePrecision,
    circle_precision,
    distance_precision,
    face_precision,
    zenith_precision,
)
from surveyapp.core.fieldfile.reduction import reduce_file
from surveyapp.core.network.collector import paused_collection
from surveyapp.domain.fieldfile import FieldFile, ImportResult, KnownPoint, ReducedSet
from surveyapp.domain.project import Project
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.files import shown
from surveyapp.io.guarded import UNSAFE_LETTERS, can_name_file, file_name_of, name_hint
from surveyapp.io.importers.fieldfiles.catalogue import importer_of
from surveyapp.io.importers.fieldfiles.gathering import ReadOptions
from surveyapp.io.importers.fieldfiles.lines import field_digest
from surveyapp.io.importing.stations import check_names, match_stations
from surveyapp.io.importing.texts import book_text, raw_text
from surveyapp.io.importing.writing import Additions, Content, FileCopy, stored_name, taken_files
from surveyapp.languages import said
from surveyapp_models.angles import RHO_ARCSEC

ASSUMED_ANGLE_ARCSEC: Final = 5.0
ASSUMED_MM: Final = 2.0
ASSUMED_PPM: Final = 2.0
ASSUMED_CENTRING_MM: Final = 1.0
"""Common class of total stations underground; told as an assumption wherever they are written."""


@dataclass(frozen=True, slots=True)
class ImportOptions:
    """What a surveyor tells about an import.

    Parameters
    ----------
    traverse : str or None
        Name of the traverse; None: the name of the file.
    fixed : tuple of str
        New stations that are fixed.
    sigma_angle_arcsec : float or None
        Standard deviation of an angle; None: from the faces, else assumed.
    sigma_distance : tuple of float or None
        Millimetres and ppm.
    read : ReadOptions
    """

    traverse: str | None = None
    fixed: tuple[str, ...] = ()
    sigma_angle_arcsec: float | None = None
    sigma_distance: tuple[float, float] | None = None
    read: ReadOptions = field(default_factory=ReadOptions)


@dataclass(frozen=True, slots=True)
class Planned:
    """What an import would write, and what it says about it."""

    result: ImportResult
    additions: Additions


def traverse_name(options: ImportOptions, file: Path) -> str:
    """Name of the traverse, fit for a file name.

    Raises
    ------
    SurveyError
        If a name that was told cannot be one of a file.
    """
    told = options.traverse
    if told is None:
        return file_name_of(file.stem.strip(" .")[:100], other="import")
    bad = told != told.strip() or told.startswith("-") or len(told) > 100
    if bad or not can_name_file(told):
        letters = UNSAFE_LETTERS
        expected = said("printable characters without {unsafe}, no dot in front", unsafe=letters)
        what, hint = "this is no name", name_hint(told)
        raise SurveyError(Problem(what, "traverse", shown(told), expected, hint))
    return told


def _composed(file: FieldFile) -> FieldFile:
    """Names in composed form (NFC): what looks the same is the same."""
    if all(p.at.isascii() and p.to.isascii() for p in file.pointings):
        return file

    def nfc(text: str) -> str:
        return unicodedata.normalize("NFC", text)

    pointings = tuple(replace(p, at=nfc(p.at), to=nfc(p.to)) for p in file.pointings)
    return replace(
        file,
        pointings=pointings,
        points=tuple(replace(point, name=nfc(point.name)) for point in file.points),
    )


def read_traverse_file(form: str, file: Path, options: ReadOptions) -> FieldFile:
    """Read a field file of a known format.

    Raises
    ------
    SurveyError
        For an unknown format and whatever is wrong with the file.
    """
    read = importer_of(form).pointings
    if read is None:
        raise SurveyError(
            Problem("this format holds no pointings", "import", shown(form), "a traverse file")
        )
    return _composed(read(file, options))


def _sigmas(
    options: ImportOptions, sets: Sequence[ReducedSet]
) -> tuple[dict[str, object], list[ResultWarning]]:
    """Sigmas of the header: told, from the file itself, or assumed and told as such."""
    faces, zeniths = face_precision(sets), zenith_precision(sets)
    both = circle_precision(sets) if faces is None or zeniths is None else None
    lengths = distance_precision(sets)
    dof = _degrees(options, (faces, zeniths, both), lengths)
    if both is not None:
        faces = faces or both
        zeniths = zeniths or (both.direction, both.dof)
    angle, first = _angle_sigma(options.sigma_angle_arcsec, faces)
    zenith, more = _zenith_sigma(options.sigma_angle_arcsec, zeniths)
    distance, second = _distance_sigma(options.sigma_distance, lengths)
    centring = said(
        "{assumed_centring_mm:g} mm are assumed for centring and for the "
        "height of instrument and target, each once for a set-up",
        assumed_centring_mm=ASSUMED_CENTRING_MM,
    )
    table: dict[str, object] = {
        "sigma_angle_arcsec": float(angle),
        **({} if zenith is None else {"sigma_zenith_arcsec": zenith}),
        "sigma_distance": {"mm": float(distance[0]), "ppm": float(distance[1])},
        **({"sigma_dof": dof} if dof else {}),
        "centring_assumed": True,
        "centring_mm": {"instrument": ASSUMED_CENTRING_MM, "target": ASSUMED_CENTRING_MM},
        "sigma_height_mm": {"instrument": ASSUMED_CENTRING_MM, "target": ASSUMED_CENTRING_MM},
    }
    return table, [*first, *more, *second, ResultWarning("sigma_assumed", centring)]


def _degrees(
    options: ImportOptions,
    circles: tuple[FacePrecision | None, tuple[float, int] | None, FacePrecision | None],
    lengths: tuple[float, int] | None,
) -> dict[str, int]:
    """Degrees of freedom of the sigmas that the file itself gives, for the global test."""
    faces, zeniths, both = circles
    found: dict[str, int] = {}
    if options.sigma_angle_arcsec is None and both is not None:
        alone = [x for x in (faces and faces.dof, zeniths and zeniths[1]) if x]
        found["circles"] = min([both.dof, *alone])
    elif options.sigma_angle_arcsec is None:
        found |= {} if faces is None else {"angle": faces.dof}
        found |= {} if zeniths is None else {"zenith": zeniths[1]}
    if options.sigma_distance is None and lengths is not None:
        found["distance"] = lengths[1]
    return found


def _two_digits(value: float) -> float:
    """A standard deviation with two digits that count, and no less than anybody can point."""
    return max(float(f"{value:.2g}"), 0.01)


def _angle_sigma(
    told: float | None, faces: FacePrecision | None
) -> tuple[float, list[ResultWarning]]:
    warnings = []
    angle = told
    if angle is None and faces is not None:
        angle = _two_digits(faces.angle * RHO_ARCSEC)
        text = said(
            'sigma of an angle {angle:g}" from faces and sets ({dof} degrees of freedom)',
            angle=angle,
            dof=faces.dof,
        )
        warnings.append(ResultWarning("sigma_from_faces", text))
    elif angle is None:
        angle = ASSUMED_ANGLE_ARCSEC
        text = said(
            'sigma of an angle {angle:g}" is assumed: too few pairs of faces to estimate it',
            angle=angle,
        )
        warnings.append(ResultWarning("sigma_assumed", text + said(" (--sigma-angle tells it)")))
    return angle, warnings


def _zenith_sigma(
    told: float | None, scatter: tuple[float, int] | None
) -> tuple[float | None, list[ResultWarning]]:
    """Of a zenith angle; that of an angle holds where one was told or too little was observed."""
    if told is not None or scatter is None:
        return None, []
    zenith = _two_digits(scatter[0] * RHO_ARCSEC)
    text = said(
        'sigma of a zenith angle {zenith:g}" from faces and sets ({scatter} degrees of freedom)',
        zenith=zenith,
        scatter=scatter[1],
    )
    return zenith, [ResultWarning("sigma_from_faces", text)]


def _distance_sigma(
    told: tuple[float, float] | None, scatter: tuple[float, int] | None
) -> tuple[tuple[float, float], list[ResultWarning]]:
    if told is not None:
        return told, []
    if scatter is None:
        distance = (ASSUMED_MM, ASSUMED_PPM)
        text = said(
            "sigma of a distance {distance:g} mm + {distance2:g} ppm is assumed",
            distance=distance[0],
            distance2=distance[1],
        )
        return distance, [
            ResultWarning("sigma_assumed", text + said(" (--sigma-distance tells it)"))
        ]
    distance = (_two_digits(scatter[0] * 1000.0), 0.0)
    text = said(
        "sigma of a distance {distance:g} mm from faces and sets ({scatter} "
        "degrees of freedom): zero and scale of the instrument are not in it",
        distance=distance[0],
        scatter=scatter[1],
    )
    return distance, [ResultWarning("sigma_from_sets", text)]


def _all_points(read: FieldFile) -> dict[str, None]:
    return dict.fromkeys(name for p in read.pointings for name in (p.at, p.to))


def _header(
    name: str, book: str, read: FieldFile, sigmas: dict[str, object]
) -> tuple[str, dict[str, object]]:
    applied = {
        "atmosphere_applied": read.atmosphere_applied,
        "constant_applied": read.constant_applied,
    }
    said = {key: value for key, value in applied.items() if value is not None}
    return "traverse", {"name": name, "book": book, **sigmas, **said}


def _check_free(project: Project, name: str) -> None:
    if name in [item.name for item in project.traverses]:
        raise SurveyError(
            Problem(
                "the project has a traverse of this name",
                "traverse",
                shown(name),
                "a name that is free",
            )
        )


def _result(
    read: FieldFile,
    sets: Sequence[ReducedSet],
    places: tuple[str, str, str, str],
    counted: tuple[int, str],
) -> ImportResult:
    stored, name, book, raw = places
    rows, digest = counted
    return ImportResult(
        format=read.format,
        variant=read.variant,
        file=stored,
        sha256=digest,
        stations=(),
        traverse=name,
        book=book,
        raw=raw,
        rows=rows,
        readings=len(read.pointings),
        sets=tuple(sets),
        sessions=(),
        skipped=read.skipped,
        warnings=(),
        written=False,
    )


def plan_traverse(project: Project, form: str, file: Path, options: ImportOptions) -> Planned:
    """Everything that an import would write into a project.

    Parameters
    ----------
    project : Project
    form : str
        Id of an importer of pointings.
    file : Path
    options : ImportOptions

    Raises
    ------
    SurveyError
        Whatever is wrong with file, options or names; a book or traverse of that name.
    """
    with paused_collection():
        return _planned(project, form, file, options)


def _planned(project: Project, form: str, file: Path, options: ImportOptions) -> Planned:
    folder = Path(project.path)
    name = traverse_name(options, file)
    copied = FileCopy(file, field_digest(file))
    read = read_traverse_file(form, file, options.read)
    _check_free(project, name)
    points: dict[str, KnownPoint] = {point.name: point for point in read.points}
    names = list(_all_points(read))
    check_names(names, file.name)
    sets, told = reduce_file(read)
    stations, tables, station_warnings = match_stations(project, names, points, options.fixed)
    sigmas, sigma_warnings = _sigmas(options, sets)
    book, raw = f"observations/{name}.csv", f"imports/{name}.raw.csv"
    text, rows = book_text(sets)
    stored = stored_name(folder, copied, name)
    files: dict[str, Content] = {stored: copied, raw: raw_text(read), book: text}
    problems = taken_files(folder, files, parts=read.parts)
    if problems:
        raise SurveyError(problems)
    result = replace(
        _result(read, sets, (stored, name, book, raw), (rows, copied.sha256)),
        stations=tuple(stations),
        warnings=(*read.warnings, *told, *station_warnings, *sigma_warnings),
    )
    new_tables = [("station", table) for table in tables]
    return Planned(result, Additions(files, [*new_tables, _header(name, book, read, sigmas)]))
