"""Seals: JSON texts that carry a digest of themselves, so that an edit of any value is seen.

The digest is taken with a blank in its own place, the first ``"seal": "..."`` of the text.
"""

from __future__ import annotations

import hashlib

BLANK = "0" * 40
"""What stands in the place of the seal while the digest is taken."""


def sealed(text: bytes) -> bytes:
    """A text with a seal in the place of a blank one.

    Examples
    --------
    >>> text = sealed(b'{"seal": "' + BLANK.encode() + b'", "gain": 2.0}')
    >>> seal = text[10:50].decode()
    >>> is_sealed(text, seal), is_sealed(text.replace(b"2.0", b"3.0"), seal)
    (True, False)
    """
    return text.replace(_slot(BLANK), _slot(_digest(text)), 1)


def is_sealed(text: bytes, seal: str) -> bool:
    """Whether a text is as it was when it got the seal."""
    return _digest(text.replace(_slot(seal), _slot(BLANK), 1)) == seal


def _slot(seal: str) -> bytes:
    return f'"seal": "{seal}"'.encode()


def _digest(text: bytes) -> str:
    return hashlib.blake2b(text, digest_size=len(BLANK) // 2).hexdigest()
