"""``surveyapp filter FILE``: a filter, the deviation before and after at each time, and its lag."""

from __future__ import annotations

import argparse

from surveyapp.cli.curves import log_plot
from surveyapp.cli.output import heading, paragraph, print_json, table
from surveyapp.cli.sensor_options import add_log_arguments, log_options, progress_bar, shown
from surveyapp.domain.noise import FilterResult

NAMES = ("kalman", "sage-husa", "particle")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("source", metavar="FILE", help="log, or project folder with --sensor")
    parser.add_argument(
        "--filter",
        dest="name",
        default="kalman",
        choices=(*NAMES, "all"),
        help="default kalman; all: three filters in one plot",
    )
    parser.add_argument("--column", metavar="C", help="which column, where there are several")
    parser.add_argument("--q", type=float, metavar="V", help="variance of the state's step")
    parser.add_argument("--r", type=float, metavar="V", help="variance of a reading")
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="default 1")
    parser.add_argument("-o", dest="out", metavar="OUT.csv", help="raw and filtered series")
    add_log_arguments(parser)
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(options: argparse.Namespace) -> int:
    """Filter and print."""
    from surveyapp import api

    names = NAMES if options.name == "all" else (options.name,)
    results = [
        api.filter_log(
            options.source,
            name=name,
            sensor=options.sensor,
            log=log_options(options),
            column=options.column,
            q=options.q,
            r=options.r,
            seed=options.seed,
            out=options.out if len(names) == 1 else None,
            allow_outside=options.allow_outside,
            progress=progress_bar(),
        )
        for name in names
    ]
    if options.json:
        documents = [result.to_dict() for result in results]
        print_json(
            documents[0]
            if len(documents) == 1
            else {"schema": "surveyapp.filter/1", "filters": documents}
        )
        return 0
    for result in results:
        _print(result)
    _print_plot(results)
    return 0


def _print(result: FilterResult) -> None:
    print(heading(f"{result.filter} on {result.column}, q {result.q:.4g}, r {result.r:.4g}"))
    rows = [
        [f"{tau:g}", shown(before), shown(after), f"{ratio:.4f}"]
        for tau, before, after, ratio in zip(
            result.before.taus_s,
            result.before.deviation,
            result.after.deviation,
            result.deviation_ratio,
            strict=True,
        )
    ]
    print(table(["tau s", f"raw {result.unit}", "filtered", "ratio"], rows))
    print()
    rows = [
        [b.symbol, b.name, shown(b.value), shown(a.value), b.unit, a.reason or ""]
        for b, a in zip(result.before.coefficients, result.after.coefficients, strict=True)
    ]
    print(table(["", "coefficient", "before", "after", "unit", "why not"], rows))
    lags = ", ".join(
        f"{name.replace('_', ' ')}: {'never' if lag is None else f'{lag:.0f}'}"
        for name, lag in result.step_lag_90_samples.items()
    )
    print(paragraph(f"samples until 90 % of a step is followed: {lags}"))
    if result.resamplings is not None:
        print(paragraph(f"resamplings: {result.resamplings} of {result.before.n} samples"))
    for warning in result.warnings:
        print(paragraph(f"{warning.code}: {warning.text}"))
    print()


def _print_plot(results: list[FilterResult]) -> None:
    first = results[0]
    curves = [("o", "raw", first.before.taus_s, first.before.deviation)]
    curves += [
        (result.filter[0], result.filter, result.after.taus_s, result.after.deviation)
        for result in results
    ]
    print(log_plot(curves, x="s", y=f"Allan deviation, {first.unit}"))
