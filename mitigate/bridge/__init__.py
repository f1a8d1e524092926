"""Measures programs of other projects: ``mitigate run`` runs them unchanged, once per condition.

One call of ``mitigate run`` passes through these modules, from top to bottom:

- ``config``: the options and their checks.
- ``plan``: the conditions of a run, and the settings that their results depend on.
- ``run``: runs all conditions, here or on other machines; ``check`` inspects the first frames only.
- ``attempt``: one attempt to measure a condition: the user's program and a server of frames.
- ``program``: starts the user's program and ends all of its processes.
- ``server``, ``connection``: answer the program's processes (``hook/mitigate_hook.py``).
- ``condition``, ``cameras``: corrupt instructions and frames; ``recording`` saves the clean ones.
- ``events``, ``results``: what the processes reported of the episodes, as lines and as rows.
- ``cell``: one condition and its folder; ``report`` writes the table of all finished conditions.
"""
