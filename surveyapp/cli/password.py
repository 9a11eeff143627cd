"""The password of an encrypted key, asked for at the terminal and never shown or kept."""

from __future__ import annotations

import getpass
import sys

from surveyapp.errors import Problem, SurveyError


def asked_password() -> str:
    """Ask for the password of a key.

    Raises
    ------
    SurveyError
        If there is no terminal to ask at.
    """
    if not sys.stdin.isatty():
        what = "this key is encrypted, and there is no terminal to ask for its password"
        raise SurveyError(Problem(what, "--key"))
    return getpass.getpass("password of the key: ")
