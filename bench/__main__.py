"""Run every benchmark, or those named: ``python -m bench [--cluster ADDRESS] [NAME ...]``.

A benchmark whose ``run`` takes an executor is given that of the cluster. The exit status is 1 where
one found a fault.
"""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import sys

import bench
from bench._parts import FaultsFoundError
from surveyapp import api


def main(names: list[str]) -> int:
    known = sorted(
        m.name for m in pkgutil.iter_modules(bench.__path__) if not m.name.startswith("_")
    )
    address = None
    if names[:1] == ["--cluster"]:
        address, names = (names[1] if len(names) > 1 else ""), names[2:]
    unknown = [name for name in names if name not in known]
    if unknown:
        print(f"unknown: {', '.join(unknown)}; known: {', '.join(known)}", file=sys.stderr)
        return 2
    code = 0
    with api.cluster_executor(address) as executor:
        for name in names or known:
            print(f"== {name}")
            work = importlib.import_module(f"bench.{name}").run
            takes = "executor" in inspect.signature(work).parameters
            try:
                for line in work(executor=executor) if takes else work():
                    print(line, flush=True)
            except FaultsFoundError as found:
                print("\n".join(found.lines), flush=True)
                code = 1
    return code


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
