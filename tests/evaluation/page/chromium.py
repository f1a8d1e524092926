"""Control a headless Chromium over its debugging pipe: NUL-terminated JSON messages on file
descriptors 3 and 4.

The protocol: https://chromedevtools.github.io/devtools-protocol
"""

from __future__ import annotations

import json
import os
import select
import shutil
import subprocess
import time
from pathlib import Path
from typing import Any

PROGRAM = shutil.which("chromium") or shutil.which("chromium-browser")
SECONDS = 20.0  # for any answer


class Page:
    """A page in its own browser process. ``requests`` contains the addresses that the page
    requested, and ``errors`` contains the exceptions of its scripts and the violations of its
    content security policy."""

    def __init__(self, profile: Path) -> None:
        assert PROGRAM is not None
        self.requests: dict[str, str] = {}
        self.errors: list[str] = []
        self._number, self._text = 0, b""
        # One pipe is for commands to Chromium, and one is for its messages.
        # Each pipe is a pair (read end, write end).
        ours, theirs = os.pipe(), os.pipe()
        options = ["--headless", "--no-sandbox", "--disable-gpu", "--remote-debugging-pipe"]
        options += [f"--user-data-dir={profile}", "--window-size=1300,1000", "--no-first-run"]
        options += ["--disable-background-networking", "--disable-component-update"]
        os.set_inheritable(ours[0], True)
        os.set_inheritable(theirs[1], True)
        shell = f'exec 3<&{ours[0]} 4>&{theirs[1]}; exec "$0" "$@"'
        self._process = subprocess.Popen(
            ["bash", "-c", shell, PROGRAM, *options, "about:blank"],
            pass_fds=(ours[0], theirs[1]),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(ours[0])
        os.close(theirs[1])
        self._in, self._out, self._session = ours[1], theirs[0], ""
        targets = self.call("Target.getTargets")["targetInfos"]
        target = next(one["targetId"] for one in targets if one["type"] == "page")
        attached = self.call("Target.attachToTarget", targetId=target, flatten=True)
        self._session = attached["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.call(f"{domain}.enable")

    def open(self, file: Path, address: str = "") -> None:
        """Open ``file`` with the URL fragment ``address``."""
        self.requests.clear()
        self.errors.clear()
        self.call("Page.navigate", url="about:blank")
        self.call("Page.navigate", url=f"{file.as_uri()}{address}")
        self.until("document.readyState === 'complete' && location.protocol === 'file:'")

    def ask(self, expression: str) -> Any:
        """Return the value of a JavaScript expression in the page."""
        result = self.call("Runtime.evaluate", expression=expression, returnByValue=True)
        assert "exceptionDetails" not in result, result["exceptionDetails"]
        return result["result"].get("value")

    def click(self, selector: str, text: str = "") -> None:
        """Click the first element that matches ``selector`` and whose text begins with ``text``."""
        chosen = f"[...document.querySelectorAll({json.dumps(selector)})]"
        chosen += f".find((one) => one.textContent.startsWith({json.dumps(text)}))"
        self.ask(f"{chosen}.click()")

    def press(self, key: str) -> None:
        """Press and release a key such as "Enter" or "ArrowRight"."""
        codes = {"Enter": 13, "Escape": 27, "ArrowRight": 39, "ArrowDown": 40}
        options = {"key": key, "code": key, "windowsVirtualKeyCode": codes[key]}
        options |= {"text": "\r"} if key == "Enter" else {}
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, **options)

    def type(self, text: str) -> None:
        """Type into the focused element, one letter at a time."""
        for letter in text:
            self.call("Input.insertText", text=letter)

    def until(self, expression: str) -> None:
        """Wait until an expression is true."""
        end = time.monotonic() + SECONDS
        while not self.ask(expression):
            assert time.monotonic() < end, f"never: {expression}"
            time.sleep(0.02)

    def call(self, method: str, **options: Any) -> dict[str, Any]:
        """Send a command of the protocol, and return its result."""
        self._number += 1
        requests: dict[str, Any] = {"id": self._number, "method": method, "params": options}
        if self._session:
            requests["sessionId"] = self._session
        os.write(self._in, json.dumps(requests).encode() + b"\0")
        while True:
            message = self._message()
            if message.get("id") == self._number:
                assert "error" not in message, message
                return message["result"]
            self._note(message)

    def close(self) -> None:
        os.close(self._in)
        os.close(self._out)
        self._process.terminate()
        self._process.wait(SECONDS)

    def _message(self) -> dict[str, Any]:
        end = time.monotonic() + SECONDS
        while b"\0" not in self._text:
            left = end - time.monotonic()
            ready, _, _ = select.select([self._out], [], [], max(0, left))
            assert ready, "Chromium does not answer"
            part = os.read(self._out, 1 << 20)
            assert part, "Chromium ended"
            self._text += part
        message, _, self._text = self._text.partition(b"\0")
        return json.loads(message)

    def _note(self, message: dict[str, Any]) -> None:
        options = message.get("params", {})
        if message["method"] == "Network.requestWillBeSent":
            self.requests[options["requestId"]] = options["request"]["url"]
        elif message["method"] == "Network.loadingFailed" and options.get("blockedReason"):
            self.requests.pop(options["requestId"], None)
        elif message["method"] == "Runtime.exceptionThrown":
            self.errors.append(str(options["exceptionDetails"]))
        elif message["method"] == "Log.entryAdded" and options["entry"]["level"] == "error":
            self.errors.append(options["entry"]["text"])
