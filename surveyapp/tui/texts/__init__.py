"""Every text that the screens show: a translation is a copy of this folder.

One module a group of screens; whoever shows a text writes ``texts.NAME`` and need not know which.
Texts with braces are filled by ``str.format``. No text is made anywhere else in ``surveyapp.tui``.
"""

from surveyapp.tui.texts.common import *
from surveyapp.tui.texts.exchange import *
from surveyapp.tui.texts.forms import *
from surveyapp.tui.texts.penetration import *
from surveyapp.tui.texts.project import *
from surveyapp.tui.texts.result import *
from surveyapp.tui.texts.sensors import *
from surveyapp.tui.texts.session import *
