"""Work in blocks over any ``concurrent.futures.Executor``: threads, processes, a cluster.

What a block gives depends on its number alone, so the result is the same whatever the number of
workers, and a block that was lost with its worker is computed again.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future
from typing import TypeVar

Block = TypeVar("Block")
Result = TypeVar("Result")

ATTEMPTS = 3
"""How often a block is given away before it is computed here."""


def spread(
    work: Callable[[Block], Result], blocks: Sequence[Block], executor: Executor | None
) -> Iterator[Result]:
    """Results of all blocks in their order.

    Parameters
    ----------
    work : callable
        A function of a module, so that it can be sent to another process.
    blocks : sequence
    executor : Executor or None
        None: here, one after the other.

    Raises
    ------
    Exception
        What ``work`` itself raises.
    """
    if executor is None:
        yield from map(work, blocks)
        return
    futures = [_submitted(executor, work, block) for block in blocks]
    for block, future in zip(blocks, futures, strict=True):
        yield _result(work, block, (executor, future))


def _submitted(
    executor: Executor, work: Callable[[Block], Result], block: Block
) -> Future[Result] | None:
    """The future of a block, None where the executor takes no more."""
    try:
        return executor.submit(work, block)
    except (BrokenExecutor, RuntimeError):
        return None


def _result(
    work: Callable[[Block], Result], block: Block, given: tuple[Executor, Future[Result] | None]
) -> Result:
    executor, future = given
    for _ in range(ATTEMPTS):
        if future is None:
            break
        try:
            return future.result()
        except Exception as error:
            if not is_lost(error):
                raise
        future = _submitted(executor, work, block)
    return work(block)  # nobody else is left


def is_lost(error: BaseException) -> bool:
    """Whether a block was lost with its worker, rather than wrong itself.

    A cluster's own exceptions are known by their names, so that nothing of it is imported here.
    """
    lost = {"KilledWorker", "CommClosedError", "FutureCancelledError"}
    return isinstance(error, BrokenExecutor | CancelledError | ConnectionError) or bool(
        lost & {kind.__name__ for kind in type(error).__mro__}
    )
