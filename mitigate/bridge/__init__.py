"""Evaluate programs of other projects: ``mitigate run`` runs a program unchanged, once per
condition.

One call of ``mitigate run`` passes through these modules, from top to bottom:

- ``config``: the options and their checks.
- ``plan``: the conditions of a run, and the settings that their results depend on.
- ``run``: runs all conditions on this machine or on others; ``check`` only reads the first frames.
- ``attempt``: runs the user's program once under one condition, and a server that corrupts its
  frames.
- ``program``: starts the user's program and ends all of its processes.
- ``server``, ``connection``: handle messages from the program's processes
  (``hook/mitigate_hook.py``).
- ``condition``, ``cameras``: corrupt instructions and frames; ``recording`` saves clean frames.
- ``events`` and ``results`` hold what the processes report about episodes, as JSON lines and as
  result rows.
- ``cell``: one condition and its output folder; ``report`` writes the table of all conditions.
"""
