"""The result of a session, and closing it."""

from __future__ import annotations

from typing import Final

# result screen
RESULT_TITLE: Final = "{project}  {session}  result"
R_NO_LINE: Final = "no gyro north from this session"
R_TRUE: Final = "true azimuth, {reference}"
KEY_PDF: Final = "PDF"
KEY_OBSERVE: Final = "Observe"
KEY_NEW: Final = "New"
PDF_WRITTEN: Final = "written: {path}"
KEY_NEW_PROJECT: Final = "New project"
KEY_FOLDER: Final = "Folder"
KEY_PRACTISE: Final = "Practise"
KEY_MAKE: Final = "Make it"
KEY_FIELD: Final = "Next field"

# closing
SIGN_TITLE: Final = "Close and sign this session"
SIGN_MEANING: Final = (
    "Its book and its table are sealed in the ledger. Nothing is locked away:\n"
    "`surveyapp reopen` opens it again and keeps the reason."
)
SIGN_NAME: Final = "your name"
SIGN_KEYS: Final = "Enter signs   Escape does not"
SIGNED: Final = "closed and signed by {name}; files sealed: {files}; seal {head}"
PDF_AGAIN: Final = "PDF made again with the signature: {path}"
PDF_OUT_OF_DATE: Final = "the PDF on the disk is OUT OF DATE, it lacks the signature: {what}"
CLOSED_SESSION: Final = "READING ONLY: closed and signed"
KEY_SIGN: Final = "Close and sign"
