"""GNU Gama's XML (.gkf) as a network.

Reads the whole vocabulary of ``gama-local``: coordinate axes and angle direction, both angular
units, default standard deviations, points, all observation kinds, heights of instrument and
target, covariance matrices, control coordinates, vectors and the attribute ``extern``. Values
become true east, north and clockwise radians here and nowhere else. Entities are refused; a plain
document type is passed over.

Source: GNU Gama manual, ch. 2, XML input data format; schema gama-local.xsd 1.01.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from surveyapp.core.network.collector import paused_collection
from surveyapp.domain.traverse import Network
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.files import MAX_BYTES
from surveyapp.io.guarded import open_regular
from surveyapp.io.importers.gkf_document import GkfDocument
from surveyapp.io.importers.gkf_network import network_from
from surveyapp.languages import said

if TYPE_CHECKING:
    from xml.sax.handler import ContentHandler


def _handler(document: GkfDocument) -> ContentHandler:
    """Hands elements and their line to the document.

    SAX offers no other interface than a subclass, and importing it costs: hence made here.
    """
    from xml.sax.handler import ContentHandler
    from xml.sax.xmlreader import AttributesImpl, Locator

    class Handler(ContentHandler):
        locator: Locator | None = None

        def setDocumentLocator(self, locator: Locator) -> None:
            self.locator = locator

        def startElement(self, name: str, attrs: AttributesImpl) -> None:
            line = self.locator.getLineNumber() if self.locator is not None else 0
            document.start(name, dict(attrs.items()), line or 0)

        def endElement(self, name: str) -> None:
            document.end(name)

        def skippedEntity(self, name: str) -> None:
            line = self.locator.getLineNumber() if self.locator is not None else 0
            document.problem(
                "An entity that is not defined", line or 0, f"&{name};", expected="plain text"
            )

        def characters(self, content: str) -> None:
            document.text(content)

    return Handler()


def read_gkf(path: Path | str) -> Network:
    """Read a .gkf file.

    Parameters
    ----------
    path : Path or str

    Returns
    -------
    Network
        ``axes`` and ``left_handed`` remember how the file was written.

    Raises
    ------
    SurveyError
        All problems of the file together, with their lines.
    """
    path = Path(path)
    document = GkfDocument(str(path.name))
    with paused_collection():
        _parse(path, document)
        return network_from(document)


def _parse(path: Path, document: GkfDocument) -> None:
    from xml.sax import SAXParseException
    from xml.sax.handler import feature_external_ges

    from defusedxml.common import DefusedXmlException
    from defusedxml.sax import make_parser

    parser = make_parser()
    parser.forbid_external = False  # a plain document type is passed over, its file never opened
    parser.setFeature(feature_external_ges, False)
    parser.setContentHandler(_handler(document))
    try:
        with os.fdopen(open_regular(path, os.O_RDONLY, follow=True), "rb") as stream:
            if os.fstat(stream.fileno()).st_size > MAX_BYTES:
                raise OSError(f"it is larger than {MAX_BYTES // 1024**2} MB")
            parser.parse(stream)
    except OSError as failure:
        found = failure.strerror or str(failure)
        raise SurveyError(
            Problem("The file cannot be read", str(path), found, "a readable file")
        ) from None
    except DefusedXmlException:
        raise SurveyError(
            Problem(
                "The file defines entities or a document type",
                str(path),
                "a DTD or an entity",
                "plain gama-local XML",
                "Such definitions can read other files; remove them.",
            )
        ) from None
    except (LookupError, ValueError) as failure:
        raise SurveyError(
            Problem("The file's encoding is not known", path.name, str(failure), "text in UTF-8")
        ) from None
    except SAXParseException as failure:
        raise SurveyError(
            Problem(
                "The file is no well-formed XML",
                said("{name}, line {line}", name=path.name, line=failure.getLineNumber()),
                failure.getMessage(),
                "gama-local XML",
            )
        ) from None
