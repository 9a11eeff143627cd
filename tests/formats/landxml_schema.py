"""What LandXML-1.2 demands of the elements that are written: attributes, values, children.

Facts of the published schema in a table of our own (the schema itself is not shipped): mandatory
and further attributes with their enumerations, and which children an element may have.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from xml.etree.ElementTree import Element

SPACE = "{http://www.landxml.org/schema/LandXML-1.2}"
_ANGULAR = {"radians", "grads", "decimal degrees", "decimal dd.mm.ss"}
_LINEAR = {"millimeter", "centimeter", "meter", "kilometer"}
_DOUBLE = r"[-+]?(\d+(\.\d*)?|\.\d+)([eE][-+]?\d+)?"


@dataclass(frozen=True)
class Kind:
    """One element: a pattern or an enumeration for each attribute, None for any text."""

    demanded: dict[str, str | set[str] | None]
    further: dict[str, str | set[str] | None] = field(default_factory=dict)
    children: tuple[str, ...] = ()
    text: str = r"\s*"


SCHEMA = {
    "LandXML": Kind(
        {"date": r"\d{4}-\d\d-\d\d", "time": r"\d\d:\d\d:\d\d(\.\d+)?", "version": None},
        {"language": None, "readOnly": {"true", "false", "0", "1"}},
        ("Units", "CoordinateSystem", "Project", "Application", "CgPoints"),
    ),
    "Units": Kind({}, children=("Metric",)),
    "Metric": Kind(
        {
            "areaUnit": {"hectare", "squareMeter", "squareMillimeter", "squareCentimeter"},
            "linearUnit": _LINEAR,
            "volumeUnit": {"cubicMeter", "liter", "hectareMeter"},
            "temperatureUnit": {"celsius", "kelvin"},
            "pressureUnit": {"HPA", "milliBars", "mmHG", "millimeterHG"},
        },
        {"angularUnit": _ANGULAR, "directionUnit": _ANGULAR, "diameterUnit": _LINEAR},
    ),
    "CoordinateSystem": Kind({}, {"name": None, "desc": None, "epsgCode": None}),
    "Project": Kind({"name": None}, {"desc": None}),
    "Application": Kind({"name": None}, {"version": None, "desc": None, "manufacturer": None}),
    "CgPoints": Kind({}, {"name": None}, ("CgPoint",)),
    "CgPoint": Kind(
        {},
        {"name": None, "code": None, "desc": None},
        text=rf"\s*{_DOUBLE}(\s+{_DOUBLE}){{1,2}}\s*",
    ),
}
"""The text of a CgPoint is two or three numbers: north, east, elevation."""
DEMANDED_CHILDREN = {"LandXML": {"Units", "Application"}, "Units": {"Metric"}}


def faults(element: Element) -> list[str]:
    """Everything in which an element and what is inside differ from the schema."""
    name = element.tag.removeprefix(SPACE)
    kind = SCHEMA.get(name)
    if kind is None or element.tag != SPACE + name:
        return [f"{element.tag} is no element that is known"]
    found = [f"{name} has no {key}" for key in kind.demanded.keys() - element.attrib.keys()]
    allowed = {**kind.demanded, **kind.further}
    for key, value in element.attrib.items():
        rule = allowed.get(key)
        if key not in allowed:
            found.append(f"{name} has no attribute {key}")
        elif isinstance(rule, set) and value not in rule:
            found.append(f"{name} {key} is none of {sorted(rule)}: {value}")
        elif isinstance(rule, str) and re.fullmatch(rule, value) is None:
            found.append(f"{name} {key} is not {rule}: {value}")
    if re.fullmatch(kind.text, element.text or "") is None:
        found.append(f"{name} holds {element.text!r}")
    children = [child.tag.removeprefix(SPACE) for child in element]
    found += [f"{child} stands in {name}" for child in children if child not in kind.children]
    found += [
        f"{name} has no {child}" for child in DEMANDED_CHILDREN.get(name, set()) - {*children}
    ]
    return found + [fault for child in element for fault in faults(child)]
