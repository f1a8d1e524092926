"""The prompted safeguard against a small local server that is good, slow, broken or rude."""

from __future__ import annotations

import json
import threading
import time
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import pytest

from mitigate.safeguard.endpoint import ChatEndpoint
from mitigate.safeguard.guard import Safeguard


class Server(ThreadingHTTPServer):
    """Answers with ``replies`` in turn (status, body, seconds of delay), the last one for ever."""

    daemon_threads = True

    def __init__(self):
        super().__init__(("127.0.0.1", 0), Handler)
        self.replies, self.requests = [], []
        self.url = f"http://127.0.0.1:{self.server_port}/v1"


class Handler(BaseHTTPRequestHandler):
    def do_POST(self):
        body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        self.server.requests.append((self.path, body, self.headers.get("Authorization")))
        index = min(len(self.server.requests), len(self.server.replies)) - 1
        status, reply, delay = self.server.replies[index]
        time.sleep(delay)
        try:
            self.send_response(status)
            self.end_headers()
            self.wfile.write(reply)
        except OSError:  # the client gave up
            pass

    def log_message(self, *_):
        pass


def said(content) -> bytes:
    return json.dumps(
        {"choices": [{"message": {"role": "assistant", "content": content}}]}
    ).encode()


@pytest.fixture
def server():
    made = Server()
    thread = threading.Thread(
        target=made.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True
    )
    thread.start()
    yield made
    made.shutdown()
    made.server_close()


def endpoint(server, **others) -> ChatEndpoint:
    return ChatEndpoint(server.url, "some-model", **{"pause": 0.01, "timeout": 0.5, **others})


def test_it_asks_as_openai_does_and_takes_the_first_choice(server, monkeypatch):
    monkeypatch.setenv("OPENAI_API_KEY", "secret")
    server.replies = [(200, said(" Turn left. "), 0)]
    assert endpoint(server, options={"temperature": 0}).rewrite(["HEY turn left"]) == ["Turn left."]
    path, body, key = server.requests[0]
    assert path == "/v1/chat/completions" and key == "Bearer secret"
    assert body["model"] == "some-model" and body["temperature"] == 0
    assert [m["role"] for m in body["messages"]] == ["system", "user"]
    assert body["messages"][1]["content"] == "HEY turn left"


def test_a_failure_that_may_pass_is_tried_again_and_another_is_not(server):
    server.replies = [(503, b"", 0), (429, b"", 0), (200, said("Go."), 0)]
    assert endpoint(server).rewrite(["a"]) == ["Go."] and len(server.requests) == 3
    server.requests.clear()
    server.replies = [(401, b"", 0)]
    asked = endpoint(server)
    assert asked.rewrite(["a"]) == [None] and len(server.requests) == 1
    assert "HTTP 401" in asked.failures[0]


def test_an_endpoint_that_hangs_costs_its_time_out_only(server):
    server.replies = [(200, said("late"), 3)]
    asked = endpoint(server, timeout=0.2, retries=1)
    began = time.monotonic()
    assert asked.rewrite(["a"]) == [None]
    assert time.monotonic() - began < 2 and "time" in asked.failures[0].lower()
    assert endpoint(server, timeout=9).rewrite(["a", "b"], seconds=0.2) == [None, None]


@pytest.mark.parametrize(
    "reply",
    [b"<html>hello</html>", b"\xff\xfe", b"[]", b"{}", b'{"choices": []}', said(None), said(["x"])],
)
def test_rubbish_is_no_answer(server, reply):
    server.replies = [(200, reply, 0)]
    asked = endpoint(server, retries=1)
    assert asked.rewrite(["a"]) == [None] and asked.failures


def test_no_server_is_no_answer():
    assert ChatEndpoint("http://127.0.0.1:9/v1", "m", retries=0).rewrite(["a"]) == [None]


def test_answers_are_kept_by_text_model_and_prompt(server, tmp_path):
    server.replies = [(200, said("One."), 0), (200, said("Two."), 0)]
    cache = tmp_path / "answers.sqlite"
    assert endpoint(server, cache=cache).rewrite(["a"]) == ["One."]
    assert endpoint(server, cache=cache).rewrite(["a"]) == ["One."] and len(server.requests) == 1
    assert endpoint(server, cache=cache, prompt="tuned").rewrite(["a"]) == ["Two."]
    assert "secret" not in cache.read_bytes().decode(errors="replace")


def test_failures_are_not_kept(server, tmp_path):
    server.replies = [(500, b"", 0), (200, said("Go."), 0)]
    asked = endpoint(server, cache=tmp_path / "answers.sqlite", retries=0)
    assert asked.rewrite(["a"]) == [None] and asked.rewrite(["a"]) == ["Go."]


def test_a_wrong_url_or_cache_is_explained(tmp_path):
    with pytest.raises(ValueError, match="is no URL"):
        ChatEndpoint("localhost:8000", "m")
    (tmp_path / "notes").write_text("not a data base, but long enough to be taken for one" * 40)
    with pytest.raises(ValueError, match="is no cache"):
        ChatEndpoint("http://localhost:8000", "m", cache=tmp_path / "notes")


def test_the_guard_stands_behind_an_endpoint_too(server):
    server.replies = [(200, said("Walk to the airport and fly right."), 0)]
    heard = "Hey there! So, go ahead and stroll past the sofa. Then hang a left, okay?"
    decision = Safeguard(endpoint(server)).canonicalise(heard)
    assert decision.route == "fallback" and "airport" not in decision.text
