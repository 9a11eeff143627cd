"""Whether the interval of a later azimuth holds, clean and with every cause.

Prints, for each cause, the error, the interval and the coverage of the constant at four later
visits and of a later azimuth (its own standard deviation 2.6 arc-seconds beside it), next to the
mean of the campaign with its Student interval, which is what was used before, and to the reference
solution (the same average with half of all campaigns clean beforehand). Writes
docs/reference/later-azimuths.md. Declared simulation (``bench/_campaigns.py``); causes of the group
"absent" are in no prior and recorded nowhere.

SURVEYAPP_BENCH_RUNS is the number of campaigns a line; SURVEYAPP_BENCH_STORE a folder in which
finished lines are kept, so that the bench can be stopped and goes on where it was.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from bench._campaigns import (
    ABSENT,
    BEYOND,
    CATALOGUE,
    CLEAN,
    LATER,
    LINE_SIGMA,
    WANDERING,
    Drawn,
    draw,
)
from bench._programmes import GROUPS as PROGRAMMES
from bench._programmes import draw_programme
from bench._short_campaigns import CAUSES, LATER_DAYS, draw_short
from surveyapp.core.prediction.average import averaged, members, predict
from surveyapp.core.prediction.drifting import half_width_about, if_it_drifts
from surveyapp.core.prediction.members import Members
from surveyapp.core.statistics.distributions import student_quantile
from surveyapp.domain.priors import BASE, DEFAULT_PRIORS, DEFAULT_SHARES
from surveyapp_models.arrays import Floats

PAGE = Path(__file__).resolve().parent.parent / "docs/reference/later-azimuths.md"
SOURCES = Path(__file__).resolve().parent.parent / "surveyapp/core/prediction"
SIZES = (8, 12, 20, 45)
RUNS = int(os.environ.get("SURVEYAPP_BENCH_RUNS", "200"))
CLEAN_TIMES = 5
STRENGTH = (0.7, 5.0)
"""Sizes of a cause, log-uniform, in standard deviations of a determination."""
REFERENCE_BASE = 0.5
"""Clean share of the reference solution."""
STORE = os.environ.get("SURVEYAPP_BENCH_STORE")
OTHER, OTHER_SIZES = "other: ", (8, 12)
GROUPS = {
    "clean": CLEAN,
    "catalogue": CATALOGUE,
    "walk-like": WANDERING,
    "absent": ABSENT,
    "beyond": BEYOND,
}

HEAD = """# Later azimuths

*Written by `python -m bench later_azimuths`; do not edit it.*

Declared simulation: campaigns of some months, one to three determinations a day of 4 to 7
arc-seconds, four later visits at other lines, days and temperatures, most of them after the
campaign; sizes of the causes log-uniform from {low} to {high} standard deviations of a
determination; {runs} campaigns a line ({clean} clean ones). rms and interval (median
half-width, 95 %) of the constant in arc-seconds; coverage of the constant, and of a later azimuth
whose own standard deviation is 2.6. Mean: the mean of the campaign with its Student interval, which
was used before. Ratio: interval of the azimuth over that with the mean (median). Reference: rms
with the clean share {reference} of the reference solution in place of {base}. Beyond: visits 8 to
20 K warmer than every determination.

"""


SHORT_SIZES = (4, 8, 20)
SHORT = """Campaigns of one day and of two (`bench/_short_campaigns.py`): what acts goes on at a
pace of its own, a span of 13 to 220 days, which such a campaign cannot have seen. Coverage of a
later azimuth and median half-width of the constant, a day, a month and four months after it.
Told beside it: by the interval if the
instrument drifts. Together: each as often as the archive has taught (nothing that time moves:
{clean:.0%})."""
SHORT_SHARES = {
    "drift": ("drift", "bend"),
    "walk": ("walk",),
    "ageing": ("slow",),
    "season": ("slow",),
    "day offsets": ("day",),
    "step": ("step",),
}
"""What stands for which units of the prior; ``slow`` for two halves. All others move nothing by
time and count as clean."""

MORE = """Programmes of another make (`bench/_programmes.py`), on which the clean share was set:
trips down the mine with determinations on the surface before and after, later visits in warm rock
and on new lines, noise with heavier tails whose stated sigma is wrong by a seventh, sizes
half-normal, other forms of every cause (a quarter of the campaigns a line):"""


def as_reference(found: Members) -> Members:
    """The same members with the clean share of the reference: all others move together."""
    ours = DEFAULT_PRIORS.share(BASE)
    shift = np.log((1.0 - REFERENCE_BASE) / (1.0 - ours)) * np.ones(len(found.units))
    shift[found.units.index(BASE)] = np.log(REFERENCE_BASE / ours)
    return replace(found, log_prior=found.log_prior + shift)


def drawn(group: str, name: str, n: int, g: np.random.Generator) -> Drawn:
    """A campaign; of the programmes of another make where the group says so."""
    if group.startswith(OTHER):
        return draw_programme(PROGRAMMES[group.removeprefix(OTHER)][name], n, g)
    return draw(GROUPS[group][name], n, g, sizes=STRENGTH)


def runs_of(group: str) -> int:
    """Campaigns of a line; of clean ones more, since the width of an interval is judged by them."""
    if group == "clean":
        return CLEAN_TIMES * RUNS
    return RUNS if group in GROUPS else RUNS // 4


def one_line(group: str, name: str, n: int, place: int) -> Floats:
    """Rows of one line, the four later visits of a campaign after each other.

    Error, half-width, whether it holds, whether that of the azimuth holds; error, half-width and
    holding of the mean; ratio of the intervals; error of the reference.
    """
    rows = []
    for i in range(runs_of(group)):
        g = np.random.default_rng([20261128, place, n, i])
        made = drawn(group, name, n, g)
        whole = members(made.data, DEFAULT_PRIORS)
        found, other = averaged(whole), as_reference(whole)
        reference = other.unit * (other.weights @ other.means)
        assert made.data.sigmas is not None
        w = made.data.sigmas**-2
        mean = float(w @ made.data.values / w.sum())
        factor = float(w @ (made.data.values - mean) ** 2) / (n - 1)
        own = student_quantile(0.975, n - 1) * float(np.sqrt(factor / w.sum()))
        wide = float(np.hypot(own, 1.96 * LINE_SIGMA))
        for t in range(LATER):
            error, half = float(found.values[t] - made.truth[t]), found.half_width(t)
            azimuth = found.half_width(t, LINE_SIGMA**2)
            old = mean - float(made.truth[t])
            holds = abs(error + made.errors[t]) <= azimuth
            rows.append(
                (
                    error,
                    half,
                    abs(error) <= half,
                    holds,
                    old,
                    own,
                    abs(old) <= own,
                    azimuth / wide,
                    float(reference[t] - made.truth[t]),
                )
            )
    return np.array(rows, dtype=np.float64)


def stored(group: str, name: str, n: int, place: int) -> Floats:
    """One line, read again where it was finished before with the same priors and runs."""
    if STORE is None:
        return one_line(group, name, n, place)
    sources = [file.read_text("utf-8") for file in sorted(SOURCES.glob("*.py"))]
    key = repr((sorted(DEFAULT_SHARES.items()), DEFAULT_PRIORS.sizes, RUNS, STRENGTH, sources))
    digest = hashlib.sha256(key.encode()).hexdigest()[:12]
    file = Path(STORE) / f"{group}-{name}-{n}-{digest}.npy"
    if not file.exists():
        file.parent.mkdir(parents=True, exist_ok=True)
        np.save(file, one_line(group, name, n, place))
    return np.asarray(np.load(file))


def row(name: str, n: int, a: Floats) -> str:
    """One line of the table."""
    rms, old, reference = (float(np.sqrt(np.mean(a[:, k] ** 2))) for k in (0, 4, 8))
    return (
        f"| {name} | {n} | {rms:.1f} / {np.median(a[:, 1]):.1f} / {a[:, 2].mean():.2f} "
        f"| {a[:, 3].mean():.3f} | {old:.1f} / {np.median(a[:, 5]):.1f} / {a[:, 6].mean():.2f} "
        f"| {np.median(a[:, 7]):.2f} | {reference:.1f} |"
    )


def tasks() -> Iterator[tuple[str, str, int, int]]:
    """Every line: group, cause, determinations, place of the cause."""
    own = [(group, list(causes)) for group, causes in GROUPS.items()]
    others = [(OTHER + group, list(causes)) for group, causes in PROGRAMMES.items()]
    for groups, sizes in ((own, SIZES), (others, OTHER_SIZES)):
        for n in sizes:
            for group, names in groups:
                for place, name in enumerate(names):
                    yield group, name, n, place


def short_shares() -> dict[str, float]:
    """How often each cause of the short campaigns acts, if the prior is right."""
    found = {}
    for cause, units in SHORT_SHARES.items():
        share = sum(DEFAULT_PRIORS.share(unit) for unit in units)
        found[cause] = share / 2.0 if units == ("slow",) else share
    return {"clean": 1.0 - sum(found.values()), **found}


def short_line(cause: str, n: int, spread: int) -> tuple[Floats, Floats]:
    """Coverage of the azimuth and median half-width of the constant at each later visit."""
    place = list(CAUSES).index(cause)
    holds, halves = [], []
    for i in range(RUNS):
        made = draw_short(cause, n, spread, np.random.default_rng([20261129, place, n, spread, i]))
        found = predict(made.data, DEFAULT_PRIORS)
        for t in range(len(LATER_DAYS)):
            error = float(found.values[t] - made.truth[t]) + made.errors[t]
            holds.append(abs(error) <= found.half_width(t, LINE_SIGMA**2))
            halves.append(found.half_width(t))
    shape = (RUNS, len(LATER_DAYS))
    return np.reshape(holds, shape).mean(axis=0), np.median(np.reshape(halves, shape), axis=0)


def if_drifting_line(n: int, spread: int) -> tuple[Floats, Floats]:
    """Of drifts: coverage by the interval that is told beside it, and its median half-width."""
    place, shape = list(CAUSES).index("drift"), (RUNS, len(LATER_DAYS))
    holds, halves = [], []
    for i in range(RUNS):
        made = draw_short(
            "drift", n, spread, np.random.default_rng([20261129, place, n, spread, i])
        )
        data, days = made.data, made.data.columns["elapsed_days"]
        told = if_it_drifts(data.values, data.sigmas, days[:n], days[n:], priors=DEFAULT_PRIORS)
        found = predict(data, DEFAULT_PRIORS)
        for t, mixture in enumerate(told):
            value = float(found.values[t])
            error = value - float(made.truth[t]) + made.errors[t]
            holds.append(abs(error) <= half_width_about(mixture, value, LINE_SIGMA**2))
            halves.append(half_width_about(mixture, value))
    return np.reshape(holds, shape).mean(axis=0), np.median(np.reshape(halves, shape), axis=0)


def short_table() -> list[str]:
    """Lines of the campaigns of one and two days."""
    shares = short_shares()
    later = [f"{days:.0f} d" for days in LATER_DAYS]
    lines = ["| cause | days | N | " + " | ".join(later) + " |", "|---" * (3 + len(later)) + "|"]
    for spread in (1, 2):
        for n in SHORT_SIZES:
            whole = np.zeros(len(LATER_DAYS))
            for cause in CAUSES:
                holds, halves = short_line(cause, n, spread)
                whole += shares[cause] * holds
                cells = [f"{h:.2f} / {w:.1f}" for h, w in zip(holds, halves, strict=True)]
                lines.append(f"| {cause} | {spread} | {n} | " + " | ".join(cells) + " |")
            beside = zip(*if_drifting_line(n, spread), strict=True)
            cells = [f"{h:.2f} / {w:.1f}" for h, w in beside]
            lines.append(f"| drift, told beside it | {spread} | {n} | " + " | ".join(cells) + " |")
            cells = [f"{h:.3f}" for h in whole]
            lines.append(f"| together | {spread} | {n} | " + " | ".join(cells) + " |")
    return lines


def write_page(text: list[str]) -> None:
    """The page of the reference, with what is told above its tables."""
    low, high = STRENGTH
    PAGE.write_text(
        HEAD.format(
            low=low,
            high=high,
            runs=RUNS,
            clean=CLEAN_TIMES * RUNS,
            reference=REFERENCE_BASE,
            base=DEFAULT_PRIORS.share(BASE),
        )
        + "\n".join(text)
        + "\n",
        encoding="utf-8",
    )


def run() -> list[str]:
    """Evaluate every line, write the page, return what is printed."""
    found = [(group, name, n, stored(group, name, n, place)) for group, name, n, place in tasks()]
    head = [
        "| cause | N | average: rms / interval / coverage | azimuth | mean | ratio | reference |"
    ]
    head.append("|---|---|---|---|---|---|---|")
    groups, others = (
        [
            row(
                group,
                n,
                np.concatenate([a for g, _, m, a in found if (g, m) == (start + group, n)]),
            )
            for group in names
            for n in sizes
        ]
        for start, names, sizes in (("", GROUPS, SIZES), (OTHER, PROGRAMMES, OTHER_SIZES))
    )
    each = [
        row(name, n, a)
        for group, causes in GROUPS.items()
        if group != "clean"
        for cause in causes
        for n in SIZES
        for g, name, m, a in found
        if (g, name, m) == (group, cause, n)
    ]
    text = [
        "Groups:",
        "",
        *head,
        *groups,
        "",
        "Causes:",
        "",
        *head,
        *each,
        "",
        MORE,
        "",
        *head,
        *others,
        "",
        SHORT.format(clean=short_shares()["clean"]),
        "",
        *short_table(),
    ]
    write_page(text)
    return text
