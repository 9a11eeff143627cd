"""Signatures with a key: the published format, closings and records signed, changes found."""

from __future__ import annotations

import base64
import hashlib
import shutil
import subprocess
from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.cli.main import main
from surveyapp.errors import SurveyError
from surveyapp.io import minisign
from surveyapp.io.minisign import read_public_key, read_secret_key, scrypt_costs, verified
from surveyapp.observation.session import SessionDesk
from tests.tui.helpers_tui import make_calibrations

# Example of the documentation of rust-minisign-verify (F. Denis), over the bytes "test"
PUBLISHED_KEY = "RWQf6LRCGA9i53mlYecO4IzT51TGPpvWucNSCh1CBM0QTaLn73Y7GFO3"
PUBLISHED = """\
untrusted comment: signature from minisign secret key
RUQf6LRCGA9i559r3g7V1qNyJDApGip8MfqcadIgT9CuhV3EMhHoN1mGTkUidF/z7SrlQgXdy8ofjb7bNJJylDOocrCo8KLzZwo=
trusted comment: timestamp:1633700835\tfile:test\tprehashed
wLMDjy9FLAuxZ3q4NlEvkgtyhrr0gtTu6KC4KBJdITbbOeAi1zBIYo0v4iTgt8jJpIidRJnp94ABQkJAgAooBQ==
"""
# A pair made by minisign 0.11 (-G -W) for this test; it protects nothing
SECRET = (
    "RWQAAEIyAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA2pqUegggY0hZQrOzF2Tx"
    "zk0YRLfGS+XMWTJpCCjaUXVpNsRRhim77k2QTEZBxLFfvlEZPmpD8yUnfGdtx+/RS1iIvBHUK/nyAAAAAAAAAAAAAAAAAAAA"
    "AAAAAAAAAAAAAAAAAAAAAAA="
)
PUBLIC = "RWTampR6CCBjSE2QTEZBxLFfvlEZPmpD8yUnfGdtx+/RS1iIvBHUK/ny"


@pytest.fixture
def keys(tmp_path: Path) -> tuple[Path, Path]:
    """Secret and public key."""
    secret, public = tmp_path / "own.key", tmp_path / "own.pub"
    secret.write_text(f"untrusted comment: minisign secret key\n{SECRET}\n", "utf-8")
    public.write_text(f"untrusted comment: minisign public key\n{PUBLIC}\n", "utf-8")
    return secret, public


def test_a_published_signature_holds_and_every_change_of_it_is_found(tmp_path: Path) -> None:
    path = tmp_path / "published.pub"
    path.write_text(PUBLISHED_KEY, "utf-8")
    key = read_public_key(path)
    assert key.id == "E7620F1842B4E81F"  # as minisign prints it
    assert verified(b"test", PUBLISHED, key) == ""
    assert "changed" in verified(b"Test", PUBLISHED, key)
    assert "changed" in verified(b"test", PUBLISHED.replace("file:test", "file:best"), key)
    assert "no signature" in verified(b"test", "x\ny\n", key)
    lines = PUBLISHED.splitlines()
    data = bytearray(base64.b64decode(lines[1]))
    data[40] ^= 1
    lines[1] = base64.b64encode(bytes(data)).decode("ascii")
    assert "changed" in verified(b"test", "\n".join(lines), key)


def test_the_costs_of_scrypt_are_those_of_libsodium() -> None:
    # libsodium, crypto_pwhash_scryptsalsa208sha256: interactive 2^14, sensitive 2^20
    assert scrypt_costs(operations=524288, memory=16777216) == (14, 1)
    assert scrypt_costs(operations=33554432, memory=1073741824) == (20, 1)


def test_closings_signed_with_a_key(
    tmp_path: Path, keys: tuple[Path, Path], capsys: pytest.CaptureFixture[str]
) -> None:
    folder = make_calibrations(tmp_path / "p")
    secret, public = keys
    made = api.close(folder, session="k1", by="M. Weber", key=secret)
    assert made.signature == f"signatures/{made.head}.txt.minisig"
    statement = folder / made.signature.removesuffix(".minisig")
    assert made.head in statement.read_text("utf-8")

    def answer() -> tuple[bool | None, str]:
        check = next(c for c in api.check(folder, key=public) if c.rule == "closing.signature")
        return check.passed, check.text

    assert answer() == (True, "signed by the key 486320087A949ADA")
    whole = statement.read_text("utf-8")
    statement.write_text(whole.replace("Weber", "Meier"), "utf-8")
    assert answer()[0] is False
    statement.write_text(whole, "utf-8")
    # the ledger forged as a whole: its hashes hold, the signed entry is another one
    shutil.rmtree(folder / "signatures" / "x", ignore_errors=True)
    for name in ("ledger.jsonl", "closings.txt"):
        (folder / name).unlink()
    api.close(folder, session="k1", by="M. Weber", note="forged")
    assert answer() == (False, "this closing is not signed with a key")
    assert main(["check", str(folder), "--key", str(public)]) == 1
    assert "NOT MET" in capsys.readouterr().out


def test_a_record_signed_with_a_key(
    tmp_path: Path, keys: tuple[Path, Path], capsys: pytest.CaptureFixture[str]
) -> None:
    folder = make_calibrations(tmp_path / "p")
    secret, public = keys
    pdf = tmp_path / "record.pdf"
    assert main(["report", str(folder), "-o", str(pdf), "--key", str(secret)]) == 0
    assert "signed" in capsys.readouterr().out
    checks = api.check(folder, key=public, signed=(pdf,))
    assert checks[-1].rule == "record.signature"
    assert checks[-1].passed
    if shutil.which("minisign"):
        done = subprocess.run(
            ["minisign", "-Vm", str(pdf), "-p", str(public)], capture_output=True, check=False
        )
        assert done.returncode == 0, done.stderr
        subprocess.run(
            ["minisign", "-Sm", str(pdf), "-s", str(secret)], capture_output=True, check=True
        )
        assert api.check(folder, key=public, signed=(pdf,))[-1].passed
    pdf.write_bytes(pdf.read_bytes() + b" ")
    assert api.check(folder, key=public, signed=(pdf,))[-1].passed is False
    Path(f"{pdf}.minisig").unlink()
    assert "there is no" in api.check(folder, key=public, signed=(pdf,))[-1].text
    assert main(["check", str(folder), "--signed", str(pdf)]) == 2


@pytest.mark.parametrize("text", ["", "x", "untrusted comment: x\nAAAA\n", PUBLIC, SECRET[:-8]])
def test_a_key_that_cannot_be_used_closes_nothing(tmp_path: Path, text: str) -> None:
    folder = make_calibrations(tmp_path / "p")
    path = tmp_path / "bad.key"
    path.write_text(text, "utf-8")
    with pytest.raises(SurveyError, match="key"):
        api.close(folder, session="k1", key=path)
    assert not (folder / "ledger.jsonl").exists()
    desk = SessionDesk(folder, "k1")
    assert desk.writable
    desk.close()


def test_an_encrypted_key_asks_for_its_password(tmp_path: Path) -> None:
    plain = base64.b64decode(SECRET)
    salt, limits = bytes(range(32)), (32768).to_bytes(8, "little") + (1 << 20).to_bytes(8, "little")
    body = plain[54:126]
    check = hashlib.blake2b(b"Ed" + body, digest_size=32).digest()
    stream = minisign._stretched("geheim", salt, limits[:8], limits[8:])
    mixed = bytes(a ^ b for a, b in zip(body + check, stream, strict=True))
    path = tmp_path / "locked.key"
    data = b"EdScB2" + salt + limits + mixed
    path.write_text(f"untrusted comment: x\n{base64.b64encode(data).decode('ascii')}\n", "utf-8")
    assert read_secret_key(path, lambda: "geheim").number == plain[54:62]
    with pytest.raises(SurveyError, match="password"):
        read_secret_key(path, lambda: "geheiM")
    folder = make_calibrations(tmp_path / "p")
    with pytest.raises(SurveyError, match="nobody can be asked"):
        api.close(folder, session="k1", key=path)


def test_without_the_extra_it_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse() -> None:
        raise ImportError

    monkeypatch.setattr(minisign, "_Primitives", refuse)
    with pytest.raises(SurveyError, match=r"surveyapp\[sign\]"):
        read_public_key(tmp_path / "x.pub")
