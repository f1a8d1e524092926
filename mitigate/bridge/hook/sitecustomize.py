"""Loads ``mitigate_hook`` in every Python process that is started under ``mitigate run``.

Python imports the first ``sitecustomize`` on its path at start-up. This folder stands in front of
PYTHONPATH there; the one that this file hides, if there is one, is run behind it.
"""

import sys

if sys.version_info >= (3, 6):
    import mitigate_hook

    mitigate_hook.install()
    mitigate_hook.run_hidden_sitecustomize(__file__)
