"""Agents of other projects under the suite: their unchanged programs, run once per condition.

One call of ``mitigate run`` passes through these modules, from top to bottom:

- ``config``: the options and their checks.
- ``plan``: the conditions of a run, and what their results depend on.
- ``run``: runs all conditions, here or on other machines; ``check`` looks at the first frames only.
- ``attempt``: one attempt at a condition: the user's program beside a server of frames.
- ``program``: starts the user's program and ends all processes that come from it.
- ``server``, ``connection``: answer what the program's processes ask (``hook/mitigate_hook.py``).
- ``condition``, ``cameras``: corrupt words and frames; ``recording`` keeps the clean ones.
- ``events``, ``results``: what was reported of the episodes, as lines and as rows.
- ``cell``: one condition and its folder; ``report`` writes the table of all that are finished.
"""
