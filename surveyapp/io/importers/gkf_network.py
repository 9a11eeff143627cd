"""From the elements of a .gkf file to a network: clusters, units, covariances, statuses.

Every problem is collected in the document and raised together at the end.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from surveyapp.domain.observations import CorrelatedBlock, Observation, ObservationKind
from surveyapp.domain.traverse import Network
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import SurveyError
from surveyapp.io.importers.gkf_document import DEFAULTS, KINDS, MM, NEVER_MM, Cluster, GkfDocument
from surveyapp.io.importers.gkf_points import declared_only, network_point, without_idle
from surveyapp.languages import said, some

ANGLES = frozenset(
    {
        ObservationKind.DIRECTION,
        ObservationKind.ANGLE,
        ObservationKind.AZIMUTH,
        ObservationKind.ZENITH,
    }
)
TURNING = ANGLES - {ObservationKind.ZENITH}
_COORDINATE = {"e": ObservationKind.COORDINATE_E, "n": ObservationKind.COORDINATE_N}
_VECTOR = {"e": ObservationKind.VECTOR_E, "n": ObservationKind.VECTOR_N}


class _Builder:
    """Observations and blocks as they come; mutable, private to one reading."""

    def __init__(self, document: GkfDocument) -> None:
        self.document = document
        self.observations: list[Observation] = []
        self.blocks: list[CorrelatedBlock] = []
        self.sets: Counter[str] = Counter()
        self.face_right: list[int] = []
        self.sigma_apriori = self.parameter("sigma-apr", 10.0)
        self.distance_model = self._distance_model()
        self.default = {kind: self._default(name) for kind, name in DEFAULTS.items()}

    def parameter(self, name: str, default: float) -> float:
        text = self.document.parameters.get(name)
        if text is None:
            return default
        value = self.document.number(text, 0, f"Parameter {name}")
        return default if value is None else value

    def _default(self, name: str) -> float | None:
        text = self.document.defaults.get(name)
        return None if text is None else self.document.number(text, 0, name)

    def _distance_model(self) -> tuple[float, float, float] | None:
        text = self.document.defaults.get("distance-stdev")
        if text is None:
            return None
        values = [self.document.number(item, 0, "distance-stdev") for item in text.split()]
        numbers = [item for item in values if item is not None]
        if not 1 <= len(numbers) <= 3:
            self.document.problem("distance-stdev", 0, text, expected="one to three numbers a b c")
            return None
        a, b, c = (*numbers, *(0.0, 1.0)[len(numbers) - 1 :])
        return a, b, c

    def _default_sigma(self, kind: ObservationKind, value: float, unit: float) -> float | None:
        """Default standard deviation in radians or metres."""
        if kind in ANGLES:
            number = self.default[kind]
            return None if number is None else number * unit
        if self.distance_model is None or kind is ObservationKind.HEIGHT_DIFFERENCE:
            return None
        a, b, c = self.distance_model
        return float((a + b * (abs(value) / 1000.0) ** c) * MM)

    def cluster(self, cluster: Cluster) -> None:
        """Turn a cluster into observations and, with a banded matrix, a block."""
        if any(name == "direction" for name, _, _ in cluster.entries):
            self.sets[cluster.station] += 1
            cluster.set = str(self.sets[cluster.station])
        before = len(self.document.problems)
        for name, attributes, line in cluster.entries:
            if name == "vec":
                self._vector(cluster, attributes, line)
            elif name == "point":
                self._coordinates(cluster, attributes, line)
            else:
                self._single(cluster, name, attributes, line)
        if cluster.dim is not None and len(self.document.problems) == before:
            self._covariance(cluster)
        elif cluster.dim is None and cluster.element in ("coordinates", "vectors"):
            expected = "a <cov-mat> with their covariances"
            self.document.problem(
                "Without covariances", cluster.line, cluster.element, expected=expected
            )

    def _single(self, cluster: Cluster, name: str, attributes: dict[str, str], line: int) -> None:
        document, kind = self.document, KINDS[name]
        target = "fs" if kind is ObservationKind.ANGLE else "to"
        needed = [target, "val"] + (["bs"] if kind is ObservationKind.ANGLE else [])
        missing = [item for item in needed if item not in attributes]
        if missing:
            document.problem(
                said("<{name}> is incomplete", name=name),
                line,
                said("no {names}", names=", ".join(missing)),
                expected="these",
            )
            return
        if kind in ANGLES:
            read = document.angle(attributes["val"], line)
        else:
            number = document.number(attributes["val"], line, f"Value of <{name}>")
            read = None if number is None else (number, MM)
        if read is None:
            return
        value, unit = read
        sigma = self._sigma(cluster, kind, attributes, (value, unit, line))
        if sigma is None:
            return
        if kind in TURNING:
            value *= document.axes.turn
        elif kind is ObservationKind.ZENITH and math.pi < value < 2.0 * math.pi:
            value = 2.0 * math.pi - value  # read in face right
            self.face_right.append(line)
        heights = [
            document.number(attributes.get(key, default), line, key) or 0.0
            for key, default in (("from_dh", str(cluster.from_dh)), ("to_dh", "0"))
        ]
        self._add(
            cluster,
            unit * (document.axes.turn if kind in TURNING else 1.0),
            {
                "kind": kind,
                "at": attributes.get("from", cluster.station).strip(),
                "to": attributes[target].strip(),
                "value": value,
                "sigma": sigma,
                "back": attributes.get("bs", "").strip(),
                "set": cluster.set if kind is ObservationKind.DIRECTION else "",
                "hi": heights[0] if kind is not ObservationKind.HEIGHT_DIFFERENCE else 0.0,
                "ht": heights[1],
                "extern": attributes.get("extern", ""),
                "line": line,
                "length_m": self._section(kind, attributes, line),
            },
        )

    def _section(
        self, kind: ObservationKind, attributes: dict[str, str], line: int
    ) -> float | None:
        """Length of a levelled section [m]; ``dist`` is in kilometres."""
        if kind is not ObservationKind.HEIGHT_DIFFERENCE or "dist" not in attributes:
            return None
        length = self.document.number(attributes["dist"], line, "dist")
        if length is None or length > 0.0:
            return None if length is None else length * 1000.0
        found = attributes["dist"]
        self.document.problem("A section has no length", line, found, expected="kilometres above 0")
        return None

    def _sigma(
        self,
        cluster: Cluster,
        kind: ObservationKind,
        attributes: dict[str, str],
        read: tuple[float, float, int],
    ) -> float | None:
        """Standard deviation in radians or metres; 1 where a matrix is to come."""
        value, unit, line = read
        if "stdev" in attributes:
            number = self.document.number(attributes["stdev"], line, "stdev")
            return None if number is None else number * unit
        if cluster.dim is not None:
            return 1.0
        if kind is ObservationKind.HEIGHT_DIFFERENCE and "dist" in attributes:
            length = self._section(kind, attributes, line)
            return None if length is None else self.sigma_apriori * math.sqrt(length / 1e3) * MM
        sigma = self._default_sigma(kind, value, unit)
        if sigma is None:
            self.document.problem(
                "An observation has no standard deviation",
                line,
                "nothing",
                expected="stdev, a default in <points-observations> or a <cov-mat>",
            )
        return sigma

    def _add(self, cluster: Cluster, unit: float, values: dict[str, object]) -> None:
        observation = self.document.build(lambda: Observation(**values))  # type: ignore[arg-type]
        if observation is not None:
            cluster.members.append(len(self.observations))
            cluster.units.append(unit)
            self.observations.append(observation)

    def _vector(self, cluster: Cluster, attributes: dict[str, str], line: int) -> None:
        document = self.document
        heights = [
            document.number(attributes.get(key, "0"), line, key) or 0.0
            for key in ("from_dh", "to_dh")
        ]
        for axis, key in enumerate(("dx", "dy", "dz")):
            if key not in attributes:
                absent = said("no {key}", key=key)
                document.problem("<vec> is incomplete", line, absent, expected="dx, dy and dz")
                continue
            value = document.number(attributes[key], line, key)
            if value is None:
                continue
            kind, sign = ObservationKind.VECTOR_H, 1.0
            if axis < 2:
                component, sign = document.axes.component(axis)
                kind = _VECTOR[component]
            self._add(
                cluster,
                MM * sign,
                {
                    "kind": kind,
                    "at": attributes.get("from", "").strip(),
                    "to": attributes.get("to", "").strip(),
                    "value": value * sign,
                    "sigma": 1.0,
                    "hi": heights[0],
                    "ht": heights[1],
                    "extern": attributes.get("extern", ""),
                    "line": line,
                },
            )

    def _coordinates(self, cluster: Cluster, attributes: dict[str, str], line: int) -> None:
        for axis, key in enumerate(("x", "y", "z")):
            if key not in attributes:
                continue
            value = self.document.number(attributes[key], line, key)
            if value is None:
                continue
            kind, sign = ObservationKind.COORDINATE_H, 1.0
            if axis < 2:
                component, sign = self.document.axes.component(axis)
                kind = _COORDINATE[component]
            self._add(
                cluster,
                MM * sign,
                {
                    "kind": kind,
                    "at": attributes["id"].strip(),
                    "to": "",
                    "value": value * sign,
                    "sigma": 1.0,
                    "extern": cluster.extern,
                    "line": line,
                },
            )

    def _covariance(self, cluster: Cluster) -> None:
        document, size = self.document, len(cluster.members)
        if cluster.dim != size:
            document.problem(
                "The covariance matrix has a wrong size",
                cluster.line,
                said("dim {dim}", dim=cluster.dim),
                expected=said("{size}, the number of observations", size=size),
            )
            return
        matrix = _banded(document, cluster, size)
        if matrix is None:
            return
        units = np.array(cluster.units)
        matrix = matrix * units[:, None] * units[None, :]
        if not (np.diag(matrix) > 0.0).all():
            document.problem(
                "A variance is not positive", cluster.line, "", expected="variances above 0"
            )
            return
        for place, variance in zip(cluster.members, np.diag(matrix).tolist(), strict=True):
            self.observations[place] = replace(self.observations[place], sigma=variance**0.5)
        if cluster.band > 0 and np.count_nonzero(matrix) > size:
            rows = tuple(tuple(row) for row in matrix.tolist())
            try:
                self.blocks.append(CorrelatedBlock(tuple(cluster.members), rows))
            except SurveyError as refused:
                for item in refused.problems:
                    document.problem(
                        item.what, cluster.line, item.found, expected=item.expected, hint=item.hint
                    )


def _banded(document: GkfDocument, cluster: Cluster, size: int) -> NDArray[np.float64] | None:
    """Full symmetric matrix from the rows of its upper band."""
    texts = "".join(cluster.numbers).split()
    numbers = [document.number(text, cluster.line, "A covariance") for text in texts]
    if any(item is None for item in numbers):
        return None
    band = min(cluster.band, size - 1)
    expected = size * (band + 1) - band * (band + 1) // 2
    if len(numbers) != expected:
        document.problem(
            "The covariance matrix is incomplete",
            cluster.line,
            f"{len(numbers)}",
            expected=f"{expected}",
        )
        return None
    matrix = np.zeros((size, size))
    values = iter(numbers)
    for i in range(size):
        for j in range(i, min(i + band + 1, size)):
            matrix[i, j] = matrix[j, i] = float(next(values) or 0.0)
    return matrix


def _lines(lines: Sequence[int]) -> str:
    return some([str(line) for line in lines], 6)


def _reading_notes(builder: _Builder) -> list[ResultWarning]:
    """What was read otherwise than it is written."""
    notes = []
    if builder.face_right:
        places = _lines(builder.face_right)
        text = said(
            "zenith angles of face right, taken as 360 degrees minus: lines {places}", places=places
        )
        notes.append(ResultWarning("face_right", text))
    if builder.document.carried:
        text = said(
            "60 seconds or minutes carried over: lines {lines}",
            lines=_lines(builder.document.carried),
        )
        notes.append(ResultWarning("sixty_carried", text))
    return notes


def network_from(document: GkfDocument) -> Network:
    """Assemble the network of a document.

    Parameters
    ----------
    document : GkfDocument

    Returns
    -------
    Network

    Raises
    ------
    SurveyError
        All problems of the file.
    """
    builder = _Builder(document)
    for cluster in document.clusters:
        builder.cluster(cluster)
    observations, blocks, told = declared_only(document, builder.observations, builder.blocks)
    points = [network_point(document, entry) for entry in document.points.values()]
    used, warnings = without_idle([p for p in points if p is not None], observations)
    warnings += [*told, *_reading_notes(builder)]
    warnings += [
        ResultWarning(
            "unknown_attribute",
            said("{place}: {name} was not understood", place=document.where(line), name=name),
        )
        for name, line in document.unknown_attributes.items()
    ]
    if "ellipsoid" in document.parameters:
        text = "ellipsoidal reductions are not applied: reduce the observations first"
        warnings.append(ResultWarning("reductions_not_applied", text))
    actual = document.parameters.get("sigma-act", "aposteriori").strip()
    if actual not in ("aposteriori", "apriori"):
        document.problem("Unknown sigma-act", 0, actual, expected="aposteriori or apriori")
    tolerance = builder.parameter("tol-abs", 1000.0)
    probability = builder.parameter("conf-pr", 0.95)
    network = None
    try:
        network = Network(
            points=tuple(used),
            observations=tuple(observations),
            blocks=tuple(blocks),
            sigma_apriori=builder.sigma_apriori,
            confidence=probability,
            scaled_by_residuals=actual == "aposteriori",
            tolerance_m=None if tolerance >= NEVER_MM else tolerance * MM,
            name=document.name,
            description="".join(document.description).strip(),
            axes=document.axes.xy,
            left_handed=document.axes.left_handed,
            warnings=tuple(warnings),
        )
    except SurveyError as refused:
        if not document.problems:
            document.problems += refused.problems
    if document.problems or network is None:
        raise SurveyError(document.problems)
    return network
