"""The code behind a result: what it is now, and whether it is the code in memory."""

from pipeline.fingerprint.closure import Fingerprint, fingerprint

__all__ = ["Fingerprint", "fingerprint"]
