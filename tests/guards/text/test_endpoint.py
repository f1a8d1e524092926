"""Tests of a safeguard that calls an endpoint; the local server is correct, slow or broken."""

from __future__ import annotations

import json
import socket
import sqlite3
import sys
import threading
import time
from contextlib import ExitStack, contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import pytest

from mitigate.core.addresses import check_arguments, check_choice
from mitigate.core.chat import ENVELOPE
from mitigate.evaluation import evaluate
from mitigate.guards.text.guard import Safeguard, open_safeguard
from mitigate.guards.text.language_models.endpoint import ChatEndpoint
from mitigate.guards.text.language_models.prompts import PROMPTS


class Server(ThreadingHTTPServer):
    """A server that answers with ``replies`` in turn (status, body, delay), and repeats the
    last."""

    daemon_threads = True

    def __init__(self):
        super().__init__(("127.0.0.1", 0), Handler)
        self.replies, self.requests = [], []
        # ``drops`` is the number of bytes in each piece of an answer.
        # ``pause`` is the delay in seconds before each piece.
        self.drops, self.pause = 1 << 30, 0.0
        self.headers = 0  # number of header bytes that are sent slowly before the first piece
        self.url = f"http://127.0.0.1:{self.server_port}/v1"


class Handler(BaseHTTPRequestHandler):
    def do_GET(self):
        self.do_POST()

    def do_POST(self):
        body = json.loads(self.rfile.read(int(self.headers.get("Content-Length", 0))) or b"{}")
        self.server.requests.append((self.path, body, self.headers.get("Authorization")))
        index = min(len(self.server.requests), len(self.server.replies)) - 1
        status, reply, delay = self.server.replies[index]
        time.sleep(delay)
        try:
            for n in range(self.server.headers):
                time.sleep(self.server.pause)
                self.wfile.write(b"a" if n else b"HTTP/1.0 200 OK\r\nX: ")
            self.send_response(status)
            if 300 <= status < 400:
                self.send_header("Location", reply.decode())
            self.end_headers()
            for n in range(0, len(reply), self.server.drops):
                time.sleep(self.server.pause)
                self.wfile.write(reply[n : n + self.server.drops])
        except OSError:  # the client has closed the connection
            pass

    def log_message(self, *_):
        pass


def answer(content) -> bytes:
    return json.dumps(
        {"choices": [{"message": {"role": "assistant", "content": content}}]}
    ).encode()


@pytest.fixture
def server():
    output = Server()
    thread = threading.Thread(
        target=output.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True
    )
    thread.start()
    yield output
    output.shutdown()
    output.server_close()


def endpoint(server, **others) -> ChatEndpoint:
    return ChatEndpoint(server.url, "some-model", **{"pause": 0.01, "timeout": 0.5, **others})


def test_endpoint_speaks_the_openai_protocol(server, monkeypatch):
    monkeypatch.setenv("OPENAI_API_KEY", "secret")
    server.replies = [(200, answer(" Turn left. "), 0)]
    assert endpoint(server, options={"temperature": 0}).rewrite(["HEY turn left"]) == ["Turn left."]
    path, body, key = server.requests[0]
    assert path == "/v1/chat/completions" and key == "Bearer secret"
    assert body["model"] == "some-model" and body["temperature"] == 0
    assert [m["role"] for m in body["messages"]] == ["system", "user"]
    assert body["messages"][1]["content"] == "HEY turn left"


def test_endpoint_retries_only_temporary_failures(server):
    server.replies = [(503, b"", 0), (429, b"", 0), (200, answer("Go."), 0)]
    assert endpoint(server).rewrite(["a"]) == ["Go."] and len(server.requests) == 3
    server.requests.clear()
    server.replies = [(401, b"", 0)]
    client = endpoint(server)
    assert client.rewrite(["a"]) == [None] and len(server.requests) == 1
    assert "HTTP 401" in client.failures["a"]


def test_endpoint_keeps_its_deadline_when_a_server_hangs(server):
    server.replies = [(200, answer("late"), 3)]
    client = endpoint(server, timeout=0.2, retries=1)
    began = time.monotonic()
    assert client.rewrite(["a"]) == [None]
    assert time.monotonic() - began < 2 and "time" in client.failures["a"].lower()
    assert endpoint(server, timeout=9).rewrite(["a", "b"], seconds=0.2) == [None, None]


@pytest.mark.parametrize(
    "reply",
    [
        *(
            b"<html>hello</html>",
            b"\xff\xfe",
            b"[]",
            b"{}",
            b'{"choices": []}',
            answer(None),
            answer(["x"]),
        ),
        *(b"", b"null", b"[" * 100_000, b'{"a":' * 100_000, b"9" * 100_000, b" " * (ENVELOPE + 99)),
        *(
            b'{"choices": 7}',
            b'{"choices": [null]}',
            b'{"choices": {"0": 1}}',
            answer(answer("x").decode())[:-3],
        ),
    ],
    ids=lambda reply: repr(reply[:20]),
)
def test_endpoint_ignores_malformed_answers(server, reply):
    server.replies = [(200, reply, 0)]
    client = endpoint(server, retries=1)
    assert client.rewrite(["a"]) == [None] and client.failures


def test_endpoint_survives_a_missing_server():
    assert ChatEndpoint("http://127.0.0.1:9/v1", "m", retries=0).rewrite(["a"]) == [None]


def test_cache_keeps_answers_by_text_model_and_prompt(server, tmp_path, monkeypatch):
    server.replies = [(200, answer("One."), 0), (200, answer("Two."), 0)]
    cache = tmp_path / "answers.sqlite"
    assert endpoint(server, cache=cache).rewrite(["a"]) == ["One."]
    assert endpoint(server, cache=cache).rewrite(["a"]) == ["One."] and len(server.requests) == 1
    monkeypatch.setitem(PROMPTS, "prompted", "Rewrite.")
    assert endpoint(server, cache=cache).rewrite(["a"]) == ["Two."]
    assert "secret" not in cache.read_bytes().decode(errors="replace")


def test_cache_keeps_no_failures(server, tmp_path):
    server.replies = [(500, b"", 0), (200, answer("Go."), 0)]
    client = endpoint(server, cache=tmp_path / "answers.sqlite", retries=0)
    assert client.rewrite(["a"]) == [None] and client.rewrite(["a"]) == ["Go."]


def test_endpoint_explains_a_wrong_url_or_cache(tmp_path):
    with pytest.raises(ValueError, match="is not a valid URL"):
        ChatEndpoint("localhost:8000", "m")
    (tmp_path / "notes").write_text("not a data base, but long enough to be taken for one" * 40)
    with pytest.raises(ValueError, match="is not a cache"):
        ChatEndpoint("http://localhost:8000", "m", cache=tmp_path / "notes")


def test_endpoint_answers_pass_the_gate(server):
    server.replies = [(200, answer("Walk to the airport and fly right."), 0)]
    heard = "Hey there! So, go ahead and stroll past the sofa. Then hang a left, okay?"
    decision = Safeguard(endpoint(server)).canonicalise(heard)
    assert decision.route == "fallback" and "airport" not in decision.text


def test_decision_and_log_state_why_the_endpoint_gave_no_answer(server, tmp_path, monkeypatch):
    # a key with a final newline is an invalid header, and a server may repeat the key
    heard = "Hey there! So, go ahead and stroll past the sofa. Then hang a left, okay?"
    log = tmp_path / "log.jsonl"
    for key in ("secret-key", "secret-key\n"):
        monkeypatch.setenv("OPENAI_API_KEY", key)
        server.replies = [(401, b"secret-key", 0)]
        client = endpoint(server, retries=0)
        decision = Safeguard(client, log=log).canonicalise(heard)
        assert decision.route == "fallback" and decision.text == heard
        cause = "HTTP 401" if key == "secret-key" else "Invalid header"
        assert any("gave no answer" in r and cause in r for r in decision.reasons)
    lines = [json.loads(line) for line in log.read_text(encoding="utf-8").splitlines()]
    assert "HTTP 401" in str(lines[0]["reasons"])
    assert "secret" not in log.read_text(encoding="utf-8")


def test_failures_do_not_repeat_the_key(server, monkeypatch):
    monkeypatch.setenv("OPENAI_API_KEY", "secret-key")
    client = endpoint(server, retries=0)
    for reply in (b'{"error": "wrong key secret-key"}', answer(["secret-key"])):
        server.replies = [(200, reply, 0)]
        assert client.rewrite(["a"]) == [None]
        assert "[key]" in client.failures["a"] and "secret" not in client.failures["a"]
    server.replies = [(200, answer("Go."), 0)]
    assert client.rewrite(["a"]) == ["Go."] and not client.failures


@pytest.mark.parametrize("status", [301, 302, 303, 307, 308])
def test_endpoint_follows_no_redirect(server, monkeypatch, status):
    monkeypatch.setenv("OPENAI_API_KEY", "secret")
    other = Server()
    thread = threading.Thread(target=other.serve_forever, args=(0.02,), daemon=True)
    thread.start()
    other.replies = [(200, answer("Go."), 0)]
    server.replies = [(status, f"{other.url}/chat/completions".encode(), 0)]
    client = endpoint(server, retries=1)
    assert client.rewrite(["a"]) == [None] and f"HTTP {status}" in client.failures["a"]
    other.shutdown()
    other.server_close()
    assert not other.requests and "secret" not in client.failures["a"]


@pytest.mark.parametrize("headers", [0, 200])
def test_endpoint_keeps_its_deadline_when_a_server_drips(server, headers):
    server.replies, server.drops, server.pause = [(200, answer("x" * 200), 0)], 2, 0.05
    server.headers = headers
    client = endpoint(server, timeout=0.4, retries=0)
    began = time.monotonic()
    assert client.rewrite(["a"]) == [None]
    assert time.monotonic() - began < 1.5 and "time" in client.failures["a"].lower()


def test_endpoint_keeps_its_deadline_with_dead_addresses(server, monkeypatch):
    """An address whose connection queue is full never accepts, so each such address would use up
    the timeout."""
    with socket.socket() as dead:
        dead.bind(("127.0.0.1", 0))
        dead.listen(0)
        fill = [socket.socket() for _ in range(4)]
        for one in fill:
            one.setblocking(False)
            one.connect_ex(dead.getsockname())
        info = (socket.AF_INET, socket.SOCK_STREAM, 6, "", dead.getsockname())
        monkeypatch.setattr(socket, "getaddrinfo", lambda *_, **__: [info] * 5)
        client = endpoint(server, timeout=0.4, retries=0)
        began = time.monotonic()
        assert client.rewrite(["a"]) == [None]
        assert time.monotonic() - began < 1.2 and "time" in client.failures["a"].lower()
        for one in fill:
            one.close()


def test_endpoint_keeps_its_deadline_with_a_slow_resolver(server, monkeypatch):
    monkeypatch.setattr(socket, "getaddrinfo", lambda *_, **__: time.sleep(3))
    began = time.monotonic()
    assert endpoint(server, timeout=0.3, retries=0).rewrite(["a"]) == [None]
    assert time.monotonic() - began < 1.5


@pytest.mark.parametrize("length", [5_000, 800_000])
def test_endpoint_reads_no_huge_answer(server, length):
    server.replies = [(200, answer("left " * length), 0)]
    client = endpoint(server, retries=0)
    began = time.monotonic()
    decision = Safeguard(client).canonicalise(
        "Kindly stroll past the sofa, my dear, and hang a left."
    )
    assert decision.text == decision.original and time.monotonic() - began < 2
    assert "more than" in str(client.failures)


SECRETS = [
    "http://user:hush@host/v1?key=hush@m",
    "http://user:hush@host/v1@m",
    "http://user:hush@host/v1",
    "http://hush@host/v1",
    "http://user:hush@host",
    "https://host/v1?key=hush@m",
    "https://host/v1?key=hush",
    "https://host/v1#hush@m",
    "https://host/v1@m?key=hush",
    "HTTP://user:hush@host/v1@m",
    "http://hush:hush:hush@m",
    "http:///hush@m",
    "http:hush@m",
    "http://hush-without-a-model/v1",
    "https://user:hush@host/",
    "tagger+http://user:hush@host/v1@m",
    "reader+http://user:hush@host/v1@m",
]


@pytest.mark.parametrize("choice", SECRETS)
def test_check_choice_rejects_a_secret_without_repeating_it(tmp_path, monkeypatch, capfd, choice):
    with pytest.raises(ValueError, match="endpoint") as error:
        check_choice(choice)
    assert "hush" not in str(error.value)
    with pytest.raises(ValueError, match="endpoint") as error:
        open_safeguard(choice)
    assert "hush" not in str(error.value)
    monkeypatch.delenv("HYDRA_FULL_ERROR", raising=False)
    monkeypatch.setattr(sys, "argv", ["evaluate", f"safeguard='{choice}'", f"runs={tmp_path}"])
    with pytest.raises(SystemExit) as stop:
        evaluate.main()
    assert "hush" not in str(stop.value.code) + "".join(capfd.readouterr())
    assert not list(tmp_path.iterdir())


def test_check_choice_accepts_a_url_without_a_secret():
    for choice in ("none", "rules", "http://h:8000/v1@m", "http://h/v1@org/model:2"):
        check_choice(choice)
        check_arguments(["evaluate", f"safeguard={choice}", "x=1"])


def test_cache_treats_an_untrusted_file_as_data(server, tmp_path):
    server.replies = [(200, answer("Go."), 0)]
    for number, script in enumerate(
        (
            "CREATE VIEW answers AS WITH RECURSIVE c(x) AS (SELECT 1 UNION ALL SELECT x FROM c) "
            "SELECT '' || x AS name, 'x' AS answer FROM c",
            "CREATE TABLE answers (name, answer); CREATE TRIGGER t AFTER INSERT ON answers BEGIN "
            "DELETE FROM answers; END",
        )
    ):
        cache = tmp_path / f"{number}.sqlite"
        with sqlite3.connect(cache) as handle:
            handle.executescript(script)
        with pytest.raises(ValueError, match="is not a cache of endpoint answers"):
            endpoint(server, cache=cache)
    cache = tmp_path / "answers.sqlite"
    client = endpoint(server, cache=cache)
    assert client.rewrite(["a"]) == ["Go."]
    for bad in (
        "7",
        "x'ff'",
        "NULL",
        "replace(hex(zeroblob(100000)), '0', 'x')",
        "CAST(x'ff' AS TEXT)",
    ):
        with sqlite3.connect(cache) as handle:
            handle.execute(f"UPDATE answers SET answer = {bad}")
        server.requests.clear()
        assert endpoint(server, cache=cache).rewrite(["a"]) == ["Go."] and len(server.requests) == 1


def test_cache_survives_flipped_bytes(server, tmp_path):
    server.replies = [(200, answer("Go."), 0)]
    cache = tmp_path / "answers.sqlite"
    endpoint(server, cache=cache).rewrite([f"text {n}" for n in range(60)])
    sound = cache.read_bytes()
    for place in range(0, len(sound), 701):
        cache.write_bytes(sound[:place] + b"\xa5" * 64 + sound[place + 64 :])
        try:
            assert endpoint(server, cache=cache).rewrite(["text 7"])[0] is not None
        except ValueError as error:
            assert "is not a cache" in str(error)


@contextmanager
def dead_address():
    """Yield the address of a socket whose connection queue is full, so that it never accepts."""
    with socket.socket() as dead, ExitStack() as stack:
        dead.bind(("127.0.0.1", 0))
        dead.listen(0)
        for _ in range(4):
            waiting = stack.enter_context(socket.socket())
            waiting.setblocking(False)
            waiting.connect_ex(dead.getsockname())
        yield dead.getsockname()


def test_endpoint_answers_when_the_first_address_is_dead(server, monkeypatch):
    """Issue T2, item 7."""
    server.replies = [(200, answer("Go."), 0)]
    live = ("127.0.0.1", server.server_port)
    with dead_address() as dead:
        info = [(socket.AF_INET, socket.SOCK_STREAM, 6, "", address) for address in (dead, live)]
        monkeypatch.setattr(socket, "getaddrinfo", lambda *_, **__: info)
        began = time.monotonic()
        assert endpoint(server, timeout=4.0, retries=0).rewrite(["a"]) == ["Go."]
        assert time.monotonic() - began < 4.0


@pytest.mark.parametrize("count", [1, 5])
def test_endpoint_deadline_for_all_texts_holds_with_dead_addresses(server, monkeypatch, count):
    with dead_address() as dead:
        info = [(socket.AF_INET, socket.SOCK_STREAM, 6, "", dead)] * count
        monkeypatch.setattr(socket, "getaddrinfo", lambda *_, **__: info)
        client = endpoint(server, timeout=60.0, retries=3)
        began = time.monotonic()
        assert client.rewrite(["a", "b", "c"], seconds=0.5) == [None] * 3
        assert time.monotonic() - began < 2.0


def test_endpoint_deadline_holds_while_another_process_locks_the_cache(server, tmp_path):
    server.replies = [(200, answer("Go."), 0)]
    client = endpoint(server, cache=tmp_path / "answers.sqlite")
    with sqlite3.connect(tmp_path / "answers.sqlite") as other:
        other.execute("BEGIN EXCLUSIVE")
        began = time.monotonic()
        assert client.rewrite(["a", "b"], seconds=2.0) == ["Go.", "Go."]
        assert time.monotonic() - began < 2.0
    other.close()
