"""A cluster's executor by its address; ``dask.distributed`` is imported here alone, when used."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from typing import Any, cast

from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said

TIMEOUT_S = 20


@contextmanager
def cluster_executor(address: str | None) -> Iterator[Executor | None]:
    """Executor of the cluster at an address; None without one.

    Raises
    ------
    SurveyError
        If the extra is not installed, or nobody answers at the address.
    """
    if address is None:
        yield None
        return
    try:
        from distributed import Client
    except ImportError:
        raise SurveyError(
            Problem(
                "the extra for clusters is not installed",
                "cluster",
                address,
                "dask.distributed",
                "pip install 'surveyapp[cluster]'",
            )
        ) from None
    try:
        connect: Any = Client  # the library has no types
        client = connect(address, timeout=TIMEOUT_S)
    except (OSError, ValueError, TimeoutError) as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise SurveyError(
            Problem(
                said("no cluster answers ({reason})", reason=reason),
                "cluster",
                address,
                "the address of a scheduler, like tcp://host:8786",
                "start one with: dask scheduler --port 8786",
            )
        ) from None
    with client:
        # a block that a dead worker held is given to another one; it has no effect but its result
        yield cast("Executor", client.get_executor(retries=3, pure=False))
