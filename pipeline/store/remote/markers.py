"""The object that makes an artefact exist: its manifest, and where its data are."""

from __future__ import annotations

import json
import time
import uuid
from dataclasses import dataclass, field

from pipeline.keys import Ref
from pipeline.manifest import Manifest


def new_attempt() -> str:
    """Name of one process's attempt at an artefact, different from all others."""
    return uuid.uuid4().hex


@dataclass(frozen=True)
class Marker:
    """A line about the attempt, then the manifest as it is in any store.

    Attributes
    ----------
    attempt
        Whose data count.
    manifest
        Manifest of the artefact.
    published
        When, by the clock of the machine: orders what the server's times, in seconds, do not.
    """

    attempt: str
    manifest: Manifest
    published: float = field(default_factory=time.time)

    def to_bytes(self) -> bytes:
        """What the object holds."""
        head = json.dumps({"attempt": self.attempt, "published": self.published})
        return head.encode() + b"\n" + self.manifest.to_json()

    @classmethod
    def from_bytes(cls, contents: bytes) -> Marker:
        """Marker read back.

        Raises
        ------
        ValueError
            If it is none, or was edited.
        """
        head, _, text = contents.partition(b"\n")
        try:
            about = json.loads(head)
            attempt, published = about["attempt"], float(about["published"])
            if not isinstance(attempt, str) or not attempt.isalnum():
                raise ValueError("its attempt has no name")
        except (KeyError, TypeError) as error:
            raise ValueError(f"not a marker: {error}") from error
        return cls(attempt, Manifest.from_json(text), published)


def marker_path(ref: Ref) -> str:
    """Path of the object."""
    return f"objects/{ref.stage}/{ref.key}"


def data_folder(ref: Ref, attempt: str = "") -> str:
    """Folder with the data of one attempt, or of all."""
    return f"data/{ref.stage}/{ref.key}" + (f"/{attempt}" if attempt else "")


def ref_of(path: str) -> Ref | None:
    """Artefact whose marker has a path; ``None`` if it is none."""
    parts = path.split("/")
    return Ref(parts[1], parts[2]) if len(parts) == 3 else None
