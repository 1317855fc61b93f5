"""The engine: declares, plans, keys, stores and runs stages. Knows no physics.

Where things are:

- ``nodes`` (``stage``, ``Node``), ``runs`` (what a running stage may ask), ``records``, ``annotations``
- ``canonical``, ``fingerprint`` (the code behind a result, and whether it is the code in memory),
  ``keys``: what makes two results the same
- ``plan``: what would run, and why; when a result of other code is accepted
- ``computing``, ``task``: how one result comes about, from the store or by its stage
- ``running``: frames, checkpoints and stopping of a stage while it runs, in a store or in memory
- ``scheduling``: which results are computed when, for one run or many cases; ``executors``: where;
  ``runner`` and ``sweep`` are what users call
- ``store``, ``manifest``, ``verification``, ``codecs``, ``durable``: how results are kept and checked;
  ``lineage``, ``archive``: what they were made from, and how they are passed on
- ``config``: tables, overrides and units to one validated configuration
- ``events``, ``errors``, ``provenance``, ``threads``, ``testing``

After editing code, start a new process (in a notebook: restart the kernel). A stage whose modules were
edited after this process had loaded them is refused, since its result would get the key of other code.

Only running a stage or loading a result imports numpy, HDF5 and zarr. Importing the engine begins to
note the state of the source files of modules loaded from then on (``loaded``).
"""

from pipeline.fingerprint.loaded import watch

watch()
