"""``surveyapp batch``: many projects, one row each; failures are told and do not stop it."""

from __future__ import annotations

import argparse
import sys

from surveyapp.cli.output import print_json


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("folders", metavar="DIR", nargs="+", help="project folders")
    parser.add_argument("-o", "--output", required=True, metavar="FILE.csv", help="table")
    parser.add_argument("--jobs", type=int, metavar="N", help="processes; else one a processor")
    parser.add_argument("--cluster", metavar="ADDRESS", help="on the cluster at this address")
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(options: argparse.Namespace) -> int:
    """Run the batch; 2 if a project failed, else 1 if a limit is not met."""
    from surveyapp import api

    jobs = None if options.jobs is None else max(1, options.jobs)
    with api.cluster_executor(options.cluster) as executor:
        result = api.batch(
            options.folders, options.output, executor=executor, jobs=jobs, progress=_progress
        )
    if options.json:
        print_json(result.to_dict())
    else:
        total = result.good + result.limit + result.failed
        print(
            f"{result.path}: {total} projects, {result.good} good, "
            f"{result.limit} with a limit not met, {result.failed} failed"
        )
    for path, problem in result.failures:
        print(f"failed: {path}: {problem}", file=sys.stderr)
    return 2 if result.failed else int(result.limit > 0)


def _progress(done: int, total: int, failed: int) -> None:
    """Progress on stderr: a line that moves on a terminal, else every tenth."""
    if sys.stderr.isatty():
        end = "\n" if done == total else ""
        print(f"\r{done} of {total}, {failed} failed", end=end, file=sys.stderr, flush=True)
    elif done == total or done % max(1, total // 10) == 0:
        print(f"{done} of {total}, {failed} failed", file=sys.stderr)
