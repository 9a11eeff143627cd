"""Signatures in the format of minisign: Ed25519, detached, text files that its own program checks.

Format: https://jedisct1.github.io/minisign/ ("Signature format", "Public key format", "Secret key
format"). The message is hashed by BLAKE2b-512 first (algorithm ``ED``); a second signature covers
the first one and the trusted comment. Needs the extra ``sign`` (the package cryptography).
"""

from __future__ import annotations

import base64
import binascii
import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

from surveyapp.errors import Problem, SurveyError
from surveyapp.io.files import read_bytes, shown, shown_path

if TYPE_CHECKING:
    from cryptography.hazmat.primitives.asymmetric.ed25519 import (
        Ed25519PrivateKey,
        Ed25519PublicKey,
    )

SUFFIX: Final = ".minisig"
_PLAIN, _HASHED, _SCRYPT, _NO_KDF = b"Ed", b"ED", b"Sc", b"\0\0"
_SECRET_BYTES: Final = 158
_LONGEST: Final = 64 * 1024


@dataclass(frozen=True, slots=True)
class PublicKey:
    """A public key with its number, as minisign prints it."""

    number: bytes
    key: Ed25519PublicKey

    @property
    def id(self) -> str:
        """The number as sixteen hexadecimal digits, the last byte first."""
        return self.number[::-1].hex().upper()


@dataclass(frozen=True, slots=True)
class SecretKey:
    """A secret key with its number."""

    number: bytes
    key: Ed25519PrivateKey


def read_public_key(path: Path) -> PublicKey:
    """Read a public key file of minisign, or its one line of base 64.

    Raises
    ------
    SurveyError
        If it is none, or if the extra is not installed.
    """
    primitives = _primitives()
    data = _decoded(_lines(path)[-1], 42, path, "a public key of minisign")
    if data[:2] != _PLAIN:
        raise _no(path, "a public key of minisign", shown(data[:2]))
    return PublicKey(data[2:10], primitives.Ed25519PublicKey.from_public_bytes(data[10:]))


def read_secret_key(path: Path, password: Callable[[], str]) -> SecretKey:
    """Read a secret key file of minisign; ``password`` is asked for where it is encrypted.

    Raises
    ------
    SurveyError
        If it is none, if the password is another, or if the extra is not installed.
    """
    primitives = _primitives()
    data = _decoded(_lines(path)[-1], _SECRET_BYTES, path, "a secret key of minisign")
    algorithm, kdf, checksum = data[:2], data[2:4], data[4:6]
    secret = data[54:]
    if algorithm != _PLAIN or checksum != b"B2" or kdf not in (_SCRYPT, _NO_KDF):
        raise _no(path, "a secret key of minisign", shown(data[:6]))
    if kdf == _SCRYPT:
        stream = _stretched(password(), data[6:38], data[38:46], data[46:54])
        secret = bytes(a ^ b for a, b in zip(secret, stream, strict=True))
    number, own, check = secret[:8], secret[8:72], secret[72:]
    whole = hashlib.blake2b(algorithm + number + own, digest_size=32).digest() == check
    if not whole and (kdf == _SCRYPT or any(check)):  # minisign -W leaves the check empty
        raise _no(path, "the password of this key", "another password, or a damaged file")
    return SecretKey(number, primitives.Ed25519PrivateKey.from_private_bytes(own[:32]))


def _stretched(password: str, salt: bytes, opslimit: bytes, memlimit: bytes) -> bytes:
    """Key stream of an encrypted secret key."""
    power, parallel = scrypt_costs(
        operations=int.from_bytes(opslimit, "little"), memory=int.from_bytes(memlimit, "little")
    )
    return hashlib.scrypt(
        password.encode("utf-8"),
        salt=salt,
        n=1 << power,
        r=8,
        p=parallel,
        maxmem=1024 * (1 << power) + (1 << 24),
        dklen=104,
    )


def scrypt_costs(*, operations: int, memory: int) -> tuple[int, int]:
    """Power of two and parallelism of scrypt (r = 8) as libsodium picks them.

    Parameters
    ----------
    operations, memory : int
        ``opslimit`` and ``memlimit`` [bytes] of the key file.

    Returns
    -------
    log2 of N, p : int
        At most 1 GB of memory is asked for: a key file of a stranger names no more.
    """
    operations = max(operations, 32768)
    few = operations < memory // 32
    most = operations // 32 if few else memory // 1024
    power = next(k for k in range(1, 64) if (1 << k) > most // 2)
    parallel = 1 if few else min(operations // 4 // (1 << power), 0x3FFFFFFF) // 8
    return min(power, 20), min(max(parallel, 1), 16)


def signature_text(data: bytes, secret: SecretKey, *, comment: str) -> str:
    """The text of a signature file.

    Parameters
    ----------
    data : bytes
        What is signed.
    secret : SecretKey
    comment : str
        The trusted comment, one line; it is signed with the rest.
    """
    line = " ".join(comment.split())
    signature = secret.key.sign(hashlib.blake2b(data).digest())
    whole = secret.key.sign(signature + line.encode("utf-8"))
    first = base64.b64encode(_HASHED + secret.number + signature).decode("ascii")
    return (
        "untrusted comment: signature from surveyapp, minisign format\n"
        f"{first}\ntrusted comment: {line}\n{base64.b64encode(whole).decode('ascii')}\n"
    )


def verified(data: bytes, text: str, public: PublicKey) -> str:
    """Why a signature does not hold, in words; empty where it does.

    Parameters
    ----------
    data : bytes
        What was signed.
    text : str
        Of the signature file.
    public : PublicKey
    """
    from cryptography.exceptions import InvalidSignature

    lines = text.splitlines()
    if len(lines) < 4 or not lines[2].startswith("trusted comment: "):
        return "this is no signature of minisign"
    try:
        first = base64.b64decode(lines[1], validate=True)
        whole = base64.b64decode(lines[3], validate=True)
    except (binascii.Error, ValueError):
        return "this is no signature of minisign"
    if len(first) != 74 or len(whole) != 64 or first[:2] not in (_PLAIN, _HASHED):
        return "this is no signature of minisign"
    if first[2:10] != public.number:
        return f"signed by the key {first[2:10][::-1].hex().upper()}, not by {public.id}"
    message = hashlib.blake2b(data).digest() if first[:2] == _HASHED else data
    comment = lines[2].removeprefix("trusted comment: ")
    try:
        public.key.verify(first[10:], message)
        public.key.verify(whole, first[10:] + comment.encode("utf-8"))
    except InvalidSignature:
        return "what was signed, or the signature, was changed"
    return ""


class _Primitives:
    """The two classes of the library, loaded when a key is read."""

    def __init__(self) -> None:
        from cryptography.hazmat.primitives.asymmetric import ed25519

        self.Ed25519PublicKey = ed25519.Ed25519PublicKey
        self.Ed25519PrivateKey = ed25519.Ed25519PrivateKey


def _primitives() -> _Primitives:
    try:
        return _Primitives()
    except ImportError:
        raise SurveyError(
            Problem(
                "signatures need a further package",
                "",
                "",
                "the extra sign",
                "pip install 'surveyapp[sign]'",
            )
        ) from None


def _lines(path: Path) -> list[str]:
    data = read_bytes(path, where=shown_path(path))
    text = data[:_LONGEST].decode("utf-8", "replace")
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    if not lines:
        raise _no(path, "a key of minisign", "an empty file")
    return lines


def _decoded(line: str, size: int, path: Path, what: str) -> bytes:
    try:
        data = base64.b64decode(line, validate=True)
    except (binascii.Error, ValueError):
        data = b""
    if len(data) != size:
        raise _no(path, what, shown(line))
    return data


def _no(path: Path, expected: str, found: str) -> SurveyError:
    return SurveyError(
        Problem(
            "this key cannot be used",
            shown_path(path),
            found,
            expected,
            "minisign -G -s FILE.key -p FILE.pub makes a pair",
        )
    )
