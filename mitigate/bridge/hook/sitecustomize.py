"""Load ``mitigate_hook`` in every Python process that is started under ``mitigate run``.

At start-up, Python imports the first module ``sitecustomize`` on its path. This folder is first on
PYTHONPATH, so this file may hide a different ``sitecustomize``. Therefore, this file runs the
hidden module at the end.
"""

import sys

if sys.version_info >= (3, 6):
    import mitigate_hook

    mitigate_hook.install()
    mitigate_hook.run_hidden_sitecustomize(__file__)
else:
    version = "%d.%d" % sys.version_info[:2]
    sys.stderr.write("mitigate: the hook needs Python 3.6 or newer, got %s.\n" % version)
