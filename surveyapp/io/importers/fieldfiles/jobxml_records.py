"""Records of a JobXML field book, flat and in order: each with its line and the texts inside it.

A record is kept as texts by path (``Circle/Face``); what they mean is ``jobxml``. Entities and
document types are refused, names lose their namespace, nesting is bounded.
"""

from __future__ import annotations

import io
import os
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, Final

from surveyapp.errors import Problem, SurveyError
from surveyapp.io.importers.fieldfiles.lines import open_field_file
from surveyapp.languages import said

if TYPE_CHECKING:
    from xml.sax.handler import ContentHandler

RECORDS: Final = frozenset(
    {"PointRecord", "StationRecord", "TargetRecord", "AtmosphereRecord", "BackBearingRecord"}
)
_DEEPEST: Final = 64
_LONGEST_TEXT: Final = 10_000
_MOST_TEXTS: Final = 1000


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
    """Where the reading stands, and where the file is torn; each record is handed on at its end."""

    take: Callable[[Record], None]
    others: dict[str, int] = field(default_factory=dict)
    root: str = ""
    version: str = ""
    torn: tuple[int, str] | None = None
    _path: list[str] = field(default_factory=list)
    _current: Record | None = None
    _depth: int = 0
    _text: list[str] = field(default_factory=list)
    _length: int = 0

    def start(self, name: str, attributes: dict[str, str], line: int, where: str) -> None:
        """Take the start of an element."""
        name = name.rpartition(":")[2]
        self._path.append(name)
        self._clear()
        if len(self._path) > _DEEPEST:
            raise SurveyError(
                Problem(
                    "the elements are nested too deeply",
                    said("{where}, line {line}", where=where, line=line),
                    said("more than {deepest} levels", deepest=_DEEPEST),
                    "a JobXML field book",
                )
            )
        if len(self._path) == 1:
            self.root, self.version = name, attributes.get("version", "")
        if self._current is None and "FieldBook" in self._path[:-1]:
            if name in RECORDS:
                self._current = Record(name, line, attributes)
                self._depth = len(self._path)
            elif self._path[-2:-1] == ["FieldBook"] and len(self.others) < _MOST_TEXTS:
                self.others[name] = self.others.get(name, 0) + 1

    def characters(self, content: str) -> None:
        """Take text between tags."""
        if self._current is not None and self._length < _LONGEST_TEXT:
            self._text.append(content[:_LONGEST_TEXT])
            self._length += len(content)

    def _clear(self) -> None:
        self._text.clear()
        self._length = 0

    def end(self) -> None:
        """Take the end of an element."""
        if self._current is not None:
            if len(self._path) == self._depth:
                self.take(self._current)
                self._current = None
            elif len(self._current.texts) < _MOST_TEXTS:
                path = "/".join(self._path[self._depth :])
                self._current.texts.setdefault(path, "".join(self._text).strip())
        self._clear()
        self._path.pop()

    def unfinished(self) -> int | None:
        """Line of the record in which the file is torn."""
        return None if self._current is None else self._current.line


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


class _Watched(io.RawIOBase):
    """A file that tells how much of it has been read."""

    def __init__(self, stream: BinaryIO, progress: Callable[[float], None] | None) -> None:
        super().__init__()
        self._stream, self._progress, self._done = stream, progress, 0
        self._size = max(os.fstat(stream.fileno()).st_size, 1)

    def read(self, size: int = -1) -> bytes:
        """Read, and tell."""
        data = self._stream.read(size)
        self._done += len(data)
        if self._progress is not None:
            self._progress(min(1.0, self._done / self._size))
        return data


def read_records(
    file: Path, take: Callable[[Record], None], *, progress: Callable[[float], None] | None = None
) -> Records:
    """Hand on the records of a JobXML file one by one.

    Parameters
    ----------
    file : Path
    take : callable
        Gets each record at its end.
    progress : callable or None
        Told which part of the file has been read, 0 to 1.

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

    where = file.name
    records = Records(take)
    parser = make_parser()
    parser.forbid_dtd = True
    parser.setFeature(feature_external_ges, False)
    parser.setContentHandler(_handler(records, where))
    try:
        with open_field_file(file, where) as stream:
            parser.parse(_Watched(stream, progress))
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
        line = failure.getLineNumber() or 0
        if "invalid token" in failure.getMessage() and failure.getColumnNumber() == 0 and line > 1:
            line -= 1  # what was cut off is the end of the line before
        line = records.unfinished() or line
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
