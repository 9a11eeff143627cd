"""Records of a JobXML field book, flat and in order: each with its line and the texts inside it.

A record is kept as texts by path (``Circle/Face``); what they mean is ``jobxml``. Entities and
document types are refused, names lose their namespace, nesting is bounded.
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from surveyapp.errors import Problem, SurveyError

if TYPE_CHECKING:
    from xml.sax.handler import ContentHandler

RECORDS: Final = frozenset(
    {"PointRecord", "StationRecord", "TargetRecord", "AtmosphereRecord", "BackBearingRecord"}
)
_DEEPEST: Final = 64
_LONGEST_TEXT: Final = 10_000


@dataclass(slots=True)
class Record:
    """One record of the field book."""

    kind: str
    line: int
    attributes: dict[str, str]
    texts: dict[str, str] = field(default_factory=dict)

    def text(self, path: str) -> str:
        """Text at a path, empty where there is none."""
        return self.texts.get(path, "")


@dataclass(slots=True)
class Records:
    """Everything up to the end or to the place where the file is torn."""

    found: list[Record] = field(default_factory=list)
    others: dict[str, int] = field(default_factory=dict)
    root: str = ""
    version: str = ""
    torn: tuple[int, str] | None = None
    _path: list[str] = field(default_factory=list)
    _current: Record | None = None
    _depth: int = 0
    _text: list[str] = field(default_factory=list)

    def start(self, name: str, attributes: dict[str, str], line: int, where: str) -> None:
        """Take the start of an element."""
        name = name.rpartition(":")[2]
        self._path.append(name)
        self._text.clear()
        if len(self._path) > _DEEPEST:
            raise SurveyError(
                Problem(
                    "the elements are nested too deeply",
                    f"{where}, line {line}",
                    f"more than {_DEEPEST} levels",
                    "a JobXML field book",
                )
            )
        if len(self._path) == 1:
            self.root, self.version = name, attributes.get("version", "")
        if self._current is None and "FieldBook" in self._path[:-1]:
            if name in RECORDS:
                self._current = Record(name, line, attributes)
                self._depth = len(self._path)
            elif len(self._path) >= 2 and self._path[-2] == "FieldBook":
                self.others[name] = self.others.get(name, 0) + 1

    def characters(self, content: str) -> None:
        """Take text between tags."""
        if self._current is not None and len(self._text) < _LONGEST_TEXT:
            self._text.append(content)

    def end(self) -> None:
        """Take the end of an element."""
        if self._current is not None:
            if len(self._path) == self._depth:
                self.found.append(self._current)
                self._current = None
            else:
                path = "/".join(self._path[self._depth :])
                self._current.texts.setdefault(path, "".join(self._text).strip())
        self._text.clear()
        self._path.pop()

    def unfinished(self) -> int | None:
        """Line of the record in which the file is torn."""
        return None if self._current is None else self._current.line

    def __iter__(self) -> Iterator[Record]:
        return iter(self.found)


def _handler(records: Records, where: str) -> ContentHandler:
    """SAX offers no other interface than a subclass, and importing it costs: hence made here."""
    from xml.sax.handler import ContentHandler
    from xml.sax.xmlreader import AttributesImpl, Locator

    class Handler(ContentHandler):
        locator: Locator | None = None

        def setDocumentLocator(self, locator: Locator) -> None:
            self.locator = locator

        def startElement(self, name: str, attrs: AttributesImpl) -> None:
            line = self.locator.getLineNumber() if self.locator is not None else 0
            records.start(name, dict(attrs.items()), line or 0, where)

        def endElement(self, name: str) -> None:
            records.end()

        def characters(self, content: str) -> None:
            records.characters(content)

    return Handler()


def read_records(data: bytes, where: str) -> Records:
    """Records of a JobXML file.

    Parameters
    ----------
    data : bytes
    where : str
        What messages call the file.

    Returns
    -------
    Records
        ``torn`` names line and reason where the file is not well-formed from some place on.

    Raises
    ------
    SurveyError
        For entities and document types, nesting without end, or a root that is none of JobXML.
    """
    from xml.sax import SAXParseException
    from xml.sax.handler import feature_external_ges

    from defusedxml.common import DefusedXmlException
    from defusedxml.sax import make_parser

    records = Records()
    parser = make_parser()
    parser.forbid_dtd = True
    parser.setFeature(feature_external_ges, False)
    parser.setContentHandler(_handler(records, where))
    try:
        parser.parse(io.BytesIO(data))
    except DefusedXmlException:
        raise SurveyError(
            Problem(
                "the file defines entities or a document type",
                where,
                "a DTD or an entity",
                "plain JobXML",
                "such definitions can read other files; remove them",
            )
        ) from None
    except SAXParseException as failure:
        line = records.unfinished() or failure.getLineNumber() or 0
        records.torn = (line, failure.getMessage())
    except (LookupError, UnicodeError, ValueError) as failure:
        raise SurveyError(Problem("the file cannot be decoded", where, str(failure)[:60])) from None
    if records.root != "JOBFile":
        raise SurveyError(
            Problem(
                "this is no JobXML file",
                where,
                f"<{records.root[:40]}>" if records.root else "no element",
                "a root <JOBFile> with a <FieldBook>",
            )
        )
    return records
