"""Many projects at once, with any executor of ``concurrent.futures``: one row a project.

A project that cannot be computed is a row with its problem, never the end of the batch. Rows come
in the order of the folders, and only a few chunks are under way at any time, so that memory does
not grow with their number.
"""

from __future__ import annotations

import csv
import io
import os
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import ExitStack
from itertools import islice
from pathlib import Path
from typing import Final

from surveyapp.api.orientation import orient
from surveyapp.api.project import Folder
from surveyapp.domain.filing import BATCH_COLUMNS, BatchResult, BatchRow
from surveyapp.domain.records import not_a_formula
from surveyapp.domain.results import LineResult, to_arcsec, to_degrees
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.guarded import ON_WINDOWS
from surveyapp.languages import said
from surveyapp.workflows.spreading import ATTEMPTS, is_lost

CHUNK: Final = 16
"""Projects a task: a tenth of a second of work or more, against which its transport is nothing."""
_MOST_ON_WINDOWS: Final = 61
"""Processes that a pool may have there; ``ProcessPoolExecutor`` refuses more."""
_AHEAD: Final = 3
"""Tasks under way for every worker."""

RowsDone = Callable[[int, int, int], None]


def batch_row(path: str) -> BatchRow:
    """Row of one project; never raises for a project that cannot be used."""
    try:
        result = orient(path)
    except SurveyError as error:
        more = f" (and {len(error.problems) - 1} more)" if len(error.problems) > 1 else ""
        return BatchRow(path, "failed", problem=f"{error.problems[0]}{more}")
    except Exception as fault:  # one project's fault of ours must not end the night's batch
        return BatchRow(path, "failed", problem=f"internal fault: {type(fault).__name__}: {fault}")
    checks = result.checks
    return BatchRow(
        path=path,
        status="good" if result.passed else "limit",
        name=result.project,
        sessions=len(result.sessions),
        lines=len(result.lines),
        azimuths="; ".join(_azimuth(line) for line in result.lines),
        met=sum(check.passed is True for check in checks),
        not_met=sum(check.passed is False and check.confirmed for check in checks),
        unanswered=sum(check.passed is None for check in checks),
        warnings=len(result.warnings),
        input_sha256=result.input_sha256,
    )


def _azimuth(line: LineResult) -> str:
    final = line.grid_azimuth or line.true_azimuth or line.gyro_azimuth
    kind = "grid" if line.grid_azimuth else "true" if line.true_azimuth else "gyro"
    sigma = to_arcsec(final.sigma)
    spread = "" if sigma is None else f" ± {sigma:.1f}"
    return f"{line.station}-{line.target} {kind} {to_degrees(final.value):.6f}{spread}"


def batch_chunk(paths: Sequence[str]) -> list[BatchRow]:
    """Rows of several projects: one task of an executor."""
    return [batch_row(path) for path in paths]


def batch_rows(
    folders: Sequence[Folder], *, executor: Executor | None = None, jobs: int | None = None
) -> Iterator[BatchRow]:
    """Rows of many projects, in order, as they are ready.

    Parameters
    ----------
    folders : sequence of path
    executor : Executor or None
        Any of ``concurrent.futures``, or one that a cluster's client gives.
    jobs : int or None
        Without an executor: number of processes; 1 computes here; None: one a processor.
    """
    paths = [str(folder) for folder in folders]
    chunks = (paths[i : i + CHUNK] for i in range(0, len(paths), CHUNK))
    workers = jobs if jobs is not None else (os.cpu_count() or 1)
    workers = min(workers, _MOST_ON_WINDOWS) if ON_WINDOWS else workers
    if executor is None and (workers <= 1 or len(paths) <= 1):
        for chunk in chunks:
            yield from batch_chunk(chunk)
        return
    with ExitStack() as stack:
        pool = executor or stack.enter_context(ProcessPoolExecutor(workers))
        waiting: deque[tuple[list[str], Future[list[BatchRow]]]] = deque()
        for chunk in islice(chunks, _AHEAD * workers):
            waiting.append((chunk, _submitted(pool, chunk)))
        while waiting:
            done, future = waiting.popleft()
            yield from _rows_of(done, future, pool)
            for chunk in islice(chunks, 1):
                waiting.append((chunk, _submitted(pool, chunk)))


def _submitted(pool: Executor, paths: list[str]) -> Future[list[BatchRow]]:
    """Task of a pool; where the pool takes no more, a future that says so."""
    try:
        return pool.submit(batch_chunk, paths)
    except RuntimeError as fault:
        future: Future[list[BatchRow]] = Future()
        future.set_exception(fault)
        return future


def _rows_of(paths: list[str], future: Future[list[BatchRow]], pool: Executor) -> list[BatchRow]:
    """Rows of a task; one that was lost with its worker is given away again.

    Where nobody brings it back, each of its projects is told: they are not computed here, because
    one of them may be what killed the worker.
    """
    fault: Exception | None = None
    for _ in range(ATTEMPTS):
        try:
            return future.result()
        except Exception as error:
            fault = error
            if not is_lost(error):
                break
        future = _submitted(pool, paths)
    text = f"the worker was lost: {type(fault).__name__}"
    return [BatchRow(path, "failed", problem=text) for path in paths]


def batch(
    folders: Sequence[Folder],
    output: Folder,
    *,
    executor: Executor | None = None,
    jobs: int | None = None,
    progress: RowsDone | None = None,
) -> BatchResult:
    """Orient many projects and write one row of CSV a project.

    Parameters
    ----------
    folders : sequence of path
    output : path
        CSV to be written; rows are on disk as they come.
    executor, jobs
        As for ``batch_rows``.
    progress : callable or None
        Called with the number done, the number of all, and the number failed.

    Raises
    ------
    SurveyError
        If the output cannot be written. Projects that fail do not raise.
    """
    from surveyapp.io.outputs import check_output

    counts = {"good": 0, "limit": 0, "failed": 0}
    failures: list[tuple[str, str]] = []
    path = Path(output)
    check_output(path)
    try:
        with path.open("w", encoding="utf-8", newline="") as stream:
            stream.write(_line(BATCH_COLUMNS))
            for done, row in enumerate(batch_rows(folders, executor=executor, jobs=jobs), 1):
                counts[row.status] += 1
                if row.status == "failed":
                    failures.append((row.path, row.problem))
                stream.write(_line([not_a_formula(str(x)) for x in row.to_dict().values()]))
                if progress is not None:
                    progress(done, len(folders), len(failures))
    except OSError as error:
        raise SurveyError(
            Problem(
                said(
                    "the table could not be written ({strerror})", strerror=error.strerror or error
                ),
                str(path),
            )
        ) from None
    return BatchResult(
        str(path), counts["good"], counts["limit"], counts["failed"], tuple(failures)
    )


def _line(cells: Sequence[str]) -> str:
    stream = io.StringIO()
    csv.writer(stream, lineterminator="\n").writerow(cells)
    return stream.getvalue()
