"""The store on object storage: artefacts below a URL, shared by machines that see nothing else of each other.

Layout below the URL::

    store.json                               version of this layout
    objects/<stage>/<key>                    manifest of an artefact: created last, if absent, never modified
    data/<stage>/<key>/<attempt>/...         data files; the attempt that counts is named in the manifest
    leases/<key>/<generation>                who computes the key; the highest generation counts
    checkpoints/<key>/<attempt>/...          copies of checkpoints
    runs/, usage/, tags/, removed/, quarantine/
    index.jsonl                              what lists need of the manifests; a cache
"""

from __future__ import annotations

from pipeline.store.remote.store import RemoteStore

__all__ = ["RemoteStore"]
