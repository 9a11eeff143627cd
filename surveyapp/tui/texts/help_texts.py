"""The longer half of the text catalogue: what F1 says of each step.

Pictures are drawn in plain characters so that every terminal shows them.
"""

from __future__ import annotations

from typing import Final

from surveyapp.core.observing.steps import Step
from surveyapp.languages import translated

CLOSE_HINT: Final = "Escape closes   Ctrl+P every action   F9 colours   Ctrl+Q quit"

_SETUP: Final = """\
Set up over the mark and level. Let the tripod settle. Read the level
along the sight (+ = target side low) and across it (+ = right side
low), in arc-seconds, and the temperature if you have it. None of
these is needed to go on.

        target
          |
      ____|____        F2  level along / level across / temperature
     |  gyro   |       F8  goes on to the sights
     |_________|
       /  |  \\
"""
_SIGHTS: Final = """\
Sight every target in face left, then back in face right. The prompt
names target and face; F3 takes the other face, F4 another target.
Typed in full once, minutes and seconds, or the seconds alone, are
enough afterwards: the degrees are taken from the last sight.

   face L   179-01-56           twice the collimation:
   face R   359-02-12           L - R + 180 degrees

Sights stand before or after the observation by their place in the
book. Once the first turning point is written, nothing can be added
before it any more.
"""
_ZERO: Final = """\
The rotor stands still and the tape swings freely: read the turning
points of the light mark on the scale, in divisions with their sign.
Three are needed, five are better. Before and after the observation:
the tape zero is interpolated between.

   -7.4 |------*-----|-----------*------| +11.4
               zero of the tape, (x1 + 2 x2 + x3)/4
"""
_RUN_UP: Final = """\
Clamp the gyro and start the rotor. Wait until the spin has settled: a
rotor that still warms up moves north slowly. You may note the supply:
24.1 V, 400 Hz, 320 mA. Then lower the gyro gently, so that it swings
a few degrees to either side.

   ~~~ spin up ~~~|---- steady ----|-- lower, F8 --
"""
_TRACKING: Final = """\
Follow the light mark with the fine motion, without haste and without
a jerk. Where it stands still it turns: read the circle there and type
the reading. The time is taken when you begin to type; add @-20 for 20
seconds ago, @08:15:30 for a moment.

   R   *           *           *      the larger reading is right, east
      / \\         / \\         / \\
     /   \\       /   \\       /   \\
  L *     \\_*__ /     \\__*__/

From the third point on the next one is forecast. A reading outside
its interval is asked for once. F5 a point not read, F6 strike, Ctrl+Z
undo. Take points until the interval is the wanted one: the screen
says ENOUGH.
"""
_AMPLITUDE: Final = """\
The alidade stays clamped. Type the circle reading of the clamp first
(F2 changes to it), then the turning points of the light mark on the
scale, in divisions with their sign.

   -9.2 |---*-----------|-----------*---| +8.6

From the second point on the next one is forecast: its side, its reading
with an interval, the time to it. A reading outside is asked for once.
F5 a point not read, F6 strike, Ctrl+Z undo. The screen says ENOUGH when
the interval of gyro north is the wanted one.
"""
_TRANSIT: Final = """\
The alidade stays clamped near north. Type the circle reading of the
clamp (F2), then press Space at the moment at which the mark passes
the zero of the scale. Read the turning points between the passages on
the scale (F2 changes the kind).

   Space     Space     Space
     |    *    |         |    *        * turning points on the scale
   --0---------0----*----0---------

The next transit is forecast from the first on: < goes to smaller, > to
larger readings. A transit you missed: F5 for each turning point that
went by, so that the count stays right. One pressed too late: strike it
(F6) and take the next; nothing takes its place.
"""
_AUTOMATIC: Final = """\
Start the measurement on the instrument and type what it delivers, one
round a row: the gyro azimuth of the line, or (F2) the circle reading
of gyro north, which needs sights of the target before and after.

From the second round on the screen tells the interval of the mean, what
two more rounds would make of it, and ENOUGH when it is the wanted one;
from the fourth on it names a round that stands out.
"""
_RESULT: Final = """\
F8 or Enter shows the result: gyro north, the gyro azimuth of each
target, the constant, and the grid azimuth with its sigma, every check
with its clause and verdict. The readings are all in the book; you may
still go back with F7.
"""

_BY_STEP: Final = {
    Step.SETUP: _SETUP,
    Step.SIGHTS_BEFORE: _SIGHTS,
    Step.ZERO_BEFORE: _ZERO,
    Step.RUN_UP: _RUN_UP,
    Step.ZERO_AFTER: _ZERO,
    Step.SIGHTS_AFTER: _SIGHTS,
    Step.RESULT: _RESULT,
}
_BY_METHOD: Final = {
    "tracking": _TRACKING,
    "amplitude": _AMPLITUDE,
    "transit": _TRANSIT,
    "automatic": _AUTOMATIC,
}


_HOME: Final = """\
Up and Down choose, Enter opens. A project is a folder of plain text
that you may edit with any editor; a sample is opened as your own copy.

    project.toml       stations, instruments, sessions, rule book
    observations/      one field book a session: a line is a reading
    results/           the record as PDF; may always be made anew

   new project --> new session --> observe --> result --> PDF, sign

Practice does the same on a simulated instrument, and tells the truth
afterwards.
"""
_NEW_PROJECT: Final = """\
Tab goes to the next field, F8 makes the folder. Only a name is needed;
everything else may be added later, here or in project.toml.

Stations, one a line, typed, pasted, or the path of a CSV file:

   3083, 431630.663, 3811452.311, 812.4     name, east, north, height
   or  name, lat, lon, h  as the first line, then degrees

Grid: part of its name or the EPSG code. Where the stations lie decides
which grids are offered; Down and Enter take one.
Instrument: its card brings the known values. Constant: true minus
gyro in arc-seconds and its sigma, where it is known beforehand.
"""
_NEW_SESSION: Final = """\
One set-up on one station makes one session. Tab goes to the next
field, F8 begins. The id names the field book: observations/<id>.csv.

            target
              *           more targets may be sighted later with F4
             /
   station  o -- the gyro stands here

Purpose calibration: the azimuth of the line is known, and the session
gives the instrument constant. Wanted 95 %: the screen says ENOUGH when
gyro north is known that well.
"""
_PROJECT: Final = """\
1 to 5 show the pages, Up and Down a row, and what is known of it
stands below or beside. O or Enter goes on with a session exactly where
its field book stands.

   readings --> gyro north --> gyro azimuth + constant = true azimuth
   true azimuth - deflection - convergence - (T-t) = grid azimuth

Verdicts are words: met, NOT MET, warning (a limit that nobody has
confirmed), open (nothing to compare with). D asks what the model
lacks, T shows the adjusted traverses, P the breakthrough, S the shafts,
F5 reads the folder again. E edits the session's book in your own
editor ($EDITOR), Shift+E project.toml, C corrects stations, instruments
and sessions in a form. I imports, X exports.
"""
_CORRECT: Final = """The fields hold what stands in project.toml. Change what is wrong, F8
writes it; an empty field takes the value away. Comments in the file
stay. What would make the project unusable, or change a session that is
closed, is refused and said.
"""
_RESULT_PAGE: Final = """\
From the reading to the azimuth, one correction a line with its value,
its sigma and where it comes from; then what the sigma is made of, with
what would improve it most; the constant through time; every check with
value, limit, clause and verdict.

   line reading - gyro north = gyro azimuth
   + constant   = true azimuth
   - deflection - convergence - (T-t) = grid azimuth

F4 writes the record as PDF and shows its path. F6 closes and signs:
book and table are sealed, nothing is locked away. Escape goes back.
"""
_DIAGNOSIS: Final = """\
Choose a run, an instrument or a traverse: the engine looks for what
the model lacks, names it or says why it cannot, and proves it on
readings that did not choose it. A writes what it named into the
project, after a question; F5 asks again.

   residuals   + - + - + -      amplitude channel: side times residual
               + + + - - -      midpoint channel: Schuler means
"""
_BREAKTHROUGH: Final = """\
How far two headings will miss each other. 1 to 4 show the plan, the
budget, the evaluation and the six steps.

What if? A adds the gyro side that gains most, X takes it away again,
R observes every gyro side from both ends, S adds an independent
survey, W better angles (5/7 of the sigma), G a better gyro (2/3).
The number in the title changes at once. Nothing is written, but by D
on the page of the steps: it records that a step is done.

        ■──●──G──●──●◯●──●──G──●──■
        A            K            B
"""

_SHAFTS: Final = """\
The orientation through shafts. 1 to 4 show the azimuth with its
checks, the swings of the wires with their rest, the connecting
triangles, and the checks of the plumbing. T shows the next shaft.

          C ──────── A ── B      gamma at C is small
"""

_TRAVERSE: Final = """\
The traverse after the adjustment: plan with ellipses, closures and
global test, points with their sigmas, observations with residual and
test, checks. 1 to 5 show the pages, T the next traverse, F5 adjusts
again after an edit by hand. Nothing is changed here.

   # fixed     o adjusted, ellipse enlarged     G side with a gyro
"""
_PRACTICE: Final = """\
A simulated instrument with a hidden north. You observe it with the
same session screens; what you see beside the steps is its scale.

          v                 the mark moves as on a real scale
   |------+---|             circle or scale reading below it

Read where it turns, or press Space where it passes the zero. At 10 x a
half swing takes 20 seconds. The result shows truth against yours, and
what was hidden in the run.
"""
_IMPORT: Final = """\
Enter on a file shows what is understood of it: stations, sets, what was
left out, what must be told. F8 takes it into the project, all of it or
nothing; the file itself and its readings as read are kept.

Options stand in one line. traverse=NAME names the book;
station-code=21 says which code block opens a station (GSI); fix=A,B
fixes new stations; skip-damaged leaves damaged lines out. A table needs
its columns and units: at=Stn to=Tgt hz=HA unit.hz=gon. lines=1-50000
takes a part of a file that is too large for one traverse.
"""
_EXPORT: Final = """\
Choose a format; the file lies beside the project unless you say
otherwise. F8 writes it. A file that is there is never written over.
Coordinates are adjusted where that is possible; what was left out or
renamed is told.
"""
_SENSORS: Final = """\
The sensors that level, pre-orient or find north beside the gyro: their
logs, the cards that were written from them, and until when each holds.
Enter opens a log: calibration, noise, lines, motion, north, diagnosis.
A takes another log into the project. A card that does not hold today,
or that cannot be read, says so in its last column.

   log -> calibrate -> card -> compensate, or a session that names it
"""
_SENSOR_LOG: Final = """\
C calibrates, D asks which effect the calibration lacks, L the Allan
deviation, F a filter, S the spectrum, M the motion, N north, P the
plan of stops. Page 2 has the pictures, V shows the next one. X cancels
what is being computed. K writes the card after one question; nothing
else is written here.

Options stand in the line below, key=value each, as on the command
line: latitude=47.1 programme=six-position column=gyr_x_rad_s. Enter
in that line runs the last task again. A dash is not determined; the
warnings below the table say why.
"""
_ADD_LOG: Final = """\
Enter on a file shows its columns: what each was taken for, its unit,
its smallest and largest value. A unit with ? was not stated. What is
wrong stands first; F8 takes the log only when nothing is.

map.CANON=COLUMN names a column, unit.COLUMN=UNIT its unit (uT nT mG
m/s2 g rad/s deg/s deg/h arcsec deg rad LSB 1), scale.COLUMN=VALUE the
value of one count, rate-hz=F stands for a missing time. kind= is
compass, tilt, rate or fog-station. The log is copied into sensors/ and
pinned by its hash; one that lies in the project stays where it is.
"""
_PROGRAMME: Final = """\
The steps of a calibration, one below the other: + is done, ! was done
before its minutes were over, > is next. Enter writes down that a step
is done, or the reading that was typed; it is on the disk then. Up and
down choose another step, Ctrl+Z strikes the latest entry, which stays
in the file. Leave with Escape whenever you like, and go on later.

What is recorded by itself is found in the log: log=FILE names it, with
map.time_s=t and the like behind. The file may still be growing: the
steps follow it, with the turns that are whole. What the readings do not
yet determine stands below. F8 calibrates and writes the card; options
such as latitude=47.1 stand in the line before F8.
"""
PAGES: Final = {
    "ProgrammeScreen": ("A guided programme", _PROGRAMME),
    "SensorsScreen": ("Sensors", _SENSORS),
    "SensorLogScreen": ("A sensor log", _SENSOR_LOG),
    "AddLogScreen": ("Add a log", _ADD_LOG),
    "ImportScreen": ("Import", _IMPORT),
    "ExportScreen": ("Export", _EXPORT),
    "HomeScreen": ("Where to begin", _HOME),
    "NewProjectScreen": ("New project", _NEW_PROJECT),
    "NewSessionScreen": ("New session", _NEW_SESSION),
    "ProjectScreen": ("A project", _PROJECT),
    "ResultScreen": ("The result", _RESULT_PAGE),
    "CorrectScreen": ("Correct", _CORRECT),
    "DiagnosisScreen": ("What the model lacks", _DIAGNOSIS),
    "TraverseScreen": ("Traverses", _TRAVERSE),
    "PenetrationScreen": ("Breakthrough", _BREAKTHROUGH),
    "ShaftScreen": ("Shafts", _SHAFTS),
    "PractiseScreen": ("Practice", _PRACTICE),
}
"""Heading and words of each screen that is no step of an observation, by the name of its class."""


def help_of(step: Step, method: str) -> str:
    """The explanation of a step."""
    return translated(_BY_METHOD[method] if step is Step.SWING else _BY_STEP[step])


def page_of(screen: str) -> tuple[str, str] | None:
    """Heading and words of a screen, in the language in use; None where it has none."""
    page = PAGES.get(screen)
    return None if page is None else (translated(page[0]), translated(page[1]))


def close_hint() -> str:
    """What closes the page."""
    return translated(CLOSE_HINT)
