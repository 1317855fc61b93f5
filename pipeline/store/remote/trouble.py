"""What drivers of object storage raise, in the user's words.

They are told apart by name: the libraries that define them need not be installed.
"""

from __future__ import annotations

import errno

from pipeline.errors import StoreError

REFUSED = {
    "PermissionError",
    "NoCredentialsError",
    "PartialCredentialsError",
    "CredentialRetrievalError",
    "TokenRetrievalError",
    "UnauthorizedSSOTokenError",
    "ProfileNotFound",
    "DefaultCredentialsError",
    "RefreshError",
    "ClientAuthenticationError",
}

UNREACHABLE = {
    "EndpointConnectionError",
    "ConnectTimeoutError",
    "ReadTimeoutError",
    "ConnectionClosedError",
    "HTTPClientError",
    "ConnectionError",
    "ConnectionRefusedError",
    "ConnectionResetError",
    "ClientConnectorError",
    "ClientConnectionError",
    "ServerDisconnectedError",
    "ClientPayloadError",
    "FSTimeoutError",
    "TimeoutError",
    "ServiceRequestError",
    "gaierror",
}


BUSY = {errno.EBUSY, getattr(errno, "EREMOTEIO", errno.EIO)}
"""What s3fs makes of a server that is overloaded or has an error of its own."""


def may_pass(error: Exception) -> bool:
    """Whether the same request may succeed a little later."""
    return _is_unreachable(error) or (isinstance(error, OSError) and error.errno in BUSY)


def _is_unreachable(error: Exception) -> bool:
    return bool({cls.__name__ for cls in type(error).__mro__} & UNREACHABLE)


def told(error: Exception, location: str) -> StoreError:
    """The error that names the URL and what to do."""
    names = {cls.__name__ for cls in type(error).__mro__}
    said = " ".join(str(error).split()) or type(error).__name__
    if names & REFUSED:
        return StoreError(
            f"the object store refuses the credentials, or there are none ({said})",
            path=location,
            remedy="set them as for other tools, for S3 by AWS_ACCESS_KEY_ID and "
            "AWS_SECRET_ACCESS_KEY or AWS_PROFILE",
        )
    if _is_unreachable(error):
        return StoreError(
            f"the object store cannot be reached ({said})",
            path=location,
            remedy="look at the network and at the endpoint, for S3 AWS_ENDPOINT_URL; what was "
            "computed until the last checkpoint is kept, and the same command goes on from there",
        )
    if isinstance(error, NotImplementedError):
        return StoreError(
            f"this kind of storage cannot hold a store ({said})",
            path=location,
            remedy="choose another store with --store",
        )
    return StoreError(
        f"the object store cannot be used ({said})",
        path=location,
        remedy="choose another store with --store, or look at the settings of this one",
    )
