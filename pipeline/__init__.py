"""The engine: declares, plans, keys, stores and runs stages. Knows no physics.

Where things are:

- ``nodes`` (``stage``, ``Node``), ``runs`` (what a running stage may ask), ``records``, ``annotations``
- ``canonical``, ``fingerprint`` (``syntax``, ``sources``, ``source_cache``), ``keys``: what makes two results
  the same
- ``loaded``, ``contents``, ``freshness``: whether the code in memory is the code that a key states
- ``store``, ``manifest``, ``verification``, ``locks``, ``durable``, ``codecs``, ``loading``: how results
  are kept and read
- ``plan``, ``reasons``: what would run, and why
- ``runner``, ``sweep``, ``cases``, ``scheduling``, ``outcome``: one run or many cases, node by node;
  ``executors``: where they run
- ``task``, ``obtaining``, ``execution``, ``storerun``, ``streams``, ``frames``, ``checkpoints``,
  ``interrupts``: how a stage runs, streams and resumes
- ``config``: tables, overrides and units to one validated configuration
- ``events``, ``errors``, ``provenance``, ``memory``, ``testing``

After editing code, start a new process (in a notebook: restart the kernel). A stage whose modules were
edited after this process had loaded them is refused, since its result would get the key of other code.

Only running a stage or loading a result imports numpy, HDF5 and zarr. Importing the engine begins to
note the state of the source files of modules loaded from then on (``loaded``).
"""

from pipeline.loaded import watch

watch()
