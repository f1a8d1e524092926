"""Give every host an additional first address that never answers. This affects each Python process
whose PYTHONPATH contains this folder.

``DEAD_PORT`` names a port of this machine whose queue of connections is full, so that a connection
is neither accepted nor rejected.
"""

import os
import socket

_real_getaddrinfo = socket.getaddrinfo


def _dead_address_first(*arguments, **options):
    dead = ("127.0.0.1", int(os.environ["DEAD_PORT"]))
    first = (socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP, "", dead)
    return [first, *_real_getaddrinfo(*arguments, **options)]


socket.getaddrinfo = _dead_address_first
