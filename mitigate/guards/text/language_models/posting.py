"""One HTTP request that ends in time, stays with its host and has a bounded answer."""

from __future__ import annotations

import http.client
import socket
import urllib.request
from collections.abc import Callable
from contextlib import suppress
from threading import Event, Timer
from typing import Any

LARGEST = 1 << 20  # bytes of an answer that are read (ours)


def post(url: str, body: bytes, headers: dict[str, str], seconds: float) -> bytes:
    """Return what ``url`` answers to ``body`` within ``seconds``, however slowly its bytes drip.

    Raises HTTPError for any other status than 2xx, a redirect included: it would take the words
    and the key to another host. Raises OSError (TimeoutError if it is late) and HTTPException if
    there is no whole answer, ValueError for one of more than ``LARGEST`` bytes.
    """
    opened: list[socket.socket] = []
    late = Event()

    def stop() -> None:
        late.set()
        for held in opened:
            with suppress(OSError):
                held.shutdown(socket.SHUT_RDWR)

    opener = urllib.request.build_opener(_NoRedirect, _Http(opened.append), _Https(opened.append))
    timer = Timer(seconds, stop)
    timer.daemon = True
    timer.start()
    try:
        request = urllib.request.Request(url, body, headers)
        with opener.open(request, timeout=seconds) as reply:
            found = reply.read(LARGEST + 1)
    except (OSError, ValueError, http.client.HTTPException) as error:
        if late.is_set():
            raise TimeoutError(f"no whole answer within {seconds:g} s") from error
        raise
    finally:
        timer.cancel()
    if late.is_set():
        raise TimeoutError(f"no whole answer within {seconds:g} s")
    if len(found) > LARGEST:
        raise ValueError(f"the answer has more than {LARGEST} bytes")
    return found


class _NoRedirect(urllib.request.HTTPRedirectHandler):
    """Leaves a redirect as the error that it is."""

    def redirect_request(self, *_: Any) -> None:
        return None


def _telling(kind: Any, tell: Callable[[Any], None]) -> Any:
    """A kind of connection that tells of its socket once it is connected."""

    class Connection(kind):
        def connect(self) -> None:
            super().connect()
            tell(self.sock)

    return Connection


class _Http(urllib.request.HTTPHandler):
    def __init__(self, tell: Callable[[Any], None]) -> None:
        super().__init__()
        self._connection = _telling(http.client.HTTPConnection, tell)

    def http_open(self, req: Any) -> Any:
        return self.do_open(self._connection, req)


class _Https(urllib.request.HTTPSHandler):
    def __init__(self, tell: Callable[[Any], None]) -> None:
        super().__init__()
        self._connection = _telling(http.client.HTTPSConnection, tell)

    def https_open(self, req: Any) -> Any:
        return self.do_open(self._connection, req)
