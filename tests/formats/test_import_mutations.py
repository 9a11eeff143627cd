"""Whatever happens to the bytes of a field file: taken over or refused in words, never a fault."""

from __future__ import annotations

import contextlib
import random
from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.errors import SurveyError
from tests.formats.importing import project, tree
from tests.formats.test_import_damage import FILES, OPTIONS


def mutated(data: bytes, r: random.Random) -> bytes:
    """A few bytes changed, deleted or inserted, or the end cut off."""
    i, n = r.randrange(len(data)), r.randint(1, 30)
    noise = bytes(r.randrange(1, 256) for _ in range(n))
    return r.choice(
        (
            data[:i] + noise[:2] + data[i + 2 :],
            data[:i] + data[i + n :],
            data[:i] + noise + data[i:],
            data[:i],
        )
    )


@pytest.mark.parametrize("form", ["gsi", "sdr", "jobxml", "csv"])
def test_no_mutation_is_a_fault_or_half_an_import(tmp_path: Path, form: str) -> None:
    r = random.Random(form)
    whole = ("\n".join(FILES[form]) + "\n").encode()
    for number in range(15):
        folder = project(tmp_path / str(number))
        path = tmp_path / f"f{number}"
        path.write_bytes(mutated(whole, r))
        for skip in (False, True):
            before = tree(folder)
            options = OPTIONS.get(form, {})
            with contextlib.suppress(SurveyError):
                api.import_file(
                    form, path, folder, traverse=f"t{skip}", skip_damaged=skip, **options
                )
                api.open_project(folder)
                continue
            assert tree(folder) == before
