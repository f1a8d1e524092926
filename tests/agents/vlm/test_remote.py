"""Tests of an agent behind a server; a fake server answers slowly, wrongly or not at all."""

from __future__ import annotations

import base64
import itertools
import json
import threading
import time
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import cv2
import numpy as np
import pytest

from mitigate.agents.fingerprint import contents
from mitigate.agents.vlm import RemoteAgent
from mitigate.agents.vlm.answers import ANSWERS, answer_for, read_answer
from mitigate.agents.vlm.conversation import SYSTEM
from mitigate.core.observation import FORWARD, LEFT, STOP
from mitigate.corruptions import CLEAN, Corruption
from mitigate.evaluation import rows as result_rows
from mitigate.evaluation.evaluator import evaluate
from tests.agents.vlm.corridor import CELLS, PIXELS, Corridor, episode


class Handler(BaseHTTPRequestHandler):
    def do_POST(self):
        body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        with self.server.lock:
            number = next(self.server.counter)
        status, text, delay = self.server.reply(number, body)
        time.sleep(delay)
        if status == 0:  # the connection breaks
            self.close_connection = True
            return
        try:
            self.send_response(status)
            self.end_headers()
            self.wfile.write(json.dumps({"choices": [{"message": {"content": text}}]}).encode())
        except OSError:  # the client has closed the connection
            pass

    def log_message(self, *_):
        pass


def frames_of(body: dict) -> list[np.ndarray]:
    urls = [p["image_url"]["url"] for p in body["messages"][-1]["content"] if "image_url" in p]
    data = [base64.b64decode(url.removeprefix("data:image/png;base64,")) for url in urls]
    return [cv2.imdecode(np.frombuffer(one, np.uint8), 1)[..., ::-1] for one in data]


def expert(body: dict) -> str:
    """Return the correct answer for the last frame, which shows the agent's cell and the goal."""
    frame = frames_of(body)[-1]
    cell = int((frame[10] == (40, 220, 40)).all(-1).argmax()) // 3
    goal = int((frame[0] == (220, 40, 40)).all(-1).argmax()) // 3
    steps = min(abs(goal - cell), 3)
    if not steps:
        return "stop"
    return f"forward {25 * steps} cm" if goal > cell else f"turn left {15 * steps} degrees"


@pytest.fixture
def server():
    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    server.daemon_threads = True
    server.counter, server.lock = itertools.count(), threading.Lock()
    server.reply = lambda number, body: (200, expert(body), 0)
    thread = threading.Thread(target=server.serve_forever, args=(0.02,), daemon=True)
    thread.start()
    server.url = f"http://127.0.0.1:{server.server_port}/v1"
    yield server
    server.shutdown()
    server.server_close()


def remote(server, **others) -> RemoteAgent:
    return RemoteAgent(server.url, "navid", **{"timeout": 0.5, "pause": 0.01, **others})


def rows(agent, tmp_path, count: int = 16, conditions=(CLEAN,)):
    pairs = [(a, b) for a in range(CELLS) for b in range(CELLS) if a != b][:count]
    episodes = [episode(*pair) for pair in pairs]
    out = tmp_path / "rows.jsonl"
    evaluate(
        agent,
        Corridor,
        episodes,
        list(conditions),
        name="remote",
        out=out,
        split="test",
        version="1",
    )
    return result_rows.read(out)


def test_remote_loses_no_row_to_delays_and_faults(server, tmp_path):
    faults = {3: (503, "", 0), 7: (0, "", 0), 11: (200, None, 0), 14: (429, "", 0)}
    faults[20] = (200, "late", 0.6)
    together = threading.Barrier(16)

    def reply(number, body):
        if number < 16:  # the requests of the 16 episodes run at the same time
            together.wait(5)
        return faults.get(number % 24) or (200, expert(body), 0.005 * (number % 4))

    server.reply = reply
    found = rows(remote(server), tmp_path)
    assert len(found) == 16 and all(row["success"] for row in found)
    assert not together.broken and next(server.counter) > 32
    assert all(row["unreadable_answers"] == 0 for row in found)


def test_rows_do_not_depend_on_the_number_of_episodes_at_once(server, tmp_path):
    several = rows(remote(server), tmp_path / "a", 4)
    assert several == rows(remote(server, together=1), tmp_path / "b", 4)


def test_unreadable_answers_are_counted_reported_and_no_stop(server, tmp_path, capsys):
    server.reply = lambda number, body: (200, "I would go forward 75 cm.", 0)
    (row,) = rows(remote(server), tmp_path, 1)
    assert row["unreadable_answers"] == row["decisions"] == 20 and not row["success"]
    printed = capsys.readouterr().out
    assert "16 of 16 answers are not one of the allowed answers" in printed
    assert "'I would go forward 75 cm.'; each counts as \"turn left 15 degrees\"" in printed


def test_rows_are_kept_when_the_server_dies_and_are_completed_later(server, tmp_path):
    server.reply = lambda number, body: (200, expert(body), 0) if number < 30 else (500, "", 0)
    with pytest.raises(ConnectionError, match="after 2 attempts .*HTTP 500.*same command"):
        rows(remote(server, retries=1, together=2), tmp_path)
    kept = result_rows.read(tmp_path / "rows.jsonl")
    assert 0 < len(kept) < 16
    server.reply = lambda number, body: (200, expert(body), 0)
    assert len(rows(remote(server), tmp_path)) == 16


def test_request_holds_the_conversation_and_exact_frames(server):
    seen = []
    server.reply = lambda number, body: (seen.append(body), (200, "stop", 0))[1]
    agent = remote(server, history=1)
    frame = Corridor().reset(episode(2, 5))["rgb"]
    agent.reset('Go to "{answers}".')
    assert agent.act({"rgb": frame}) == STOP and agent.act({"rgb": frame[:, ::-1]}) == STOP
    assert [len(frames_of(body)) for body in seen] == [1, 2]
    assert np.array_equal(frames_of(seen[1])[1], frame[:, ::-1])
    system, user = seen[0]["messages"]
    assert system["role"] == "system" and 'Go to "{answers}".' in user["content"][-1]["text"]
    assert seen[0]["temperature"] == 0 and seen[0]["model"] == "navid"
    assert frame.shape == (PIXELS, PIXELS, 3)


def test_white_box_attack_reaches_the_system_prompt(server, tmp_path):
    prompts = []
    server.reply = lambda number, body: (prompts.append(body["messages"][0]), (200, "stop", 0))[1]
    rows(remote(server), tmp_path, 1, (CLEAN, Corruption("white_box", 1.0)))
    clean, attacked = (prompt["content"][0]["text"] for prompt in prompts)
    assert clean == SYSTEM and attacked != SYSTEM and SYSTEM in attacked


@pytest.mark.parametrize(
    "text, expected",
    [
        ("forward 75 cm", (FORWARD, 3)),
        (" Forward  75cm. ", (FORWARD, 3)),
        ("TURN LEFT 30 degrees", (LEFT, 2)),
        ("stop", (STOP, 1)),
        *[
            (text, None)
            for text in (
                "", ".", "forward", "forward 80 cm", "forward 7 5 cm", "forward -75 cm",
                "stop stop", "turn left 75 cm", "do not stop",
                "forward 75 cm and stop", "forward 75.0 cm",
            )
        ],
    ],
)  # fmt: skip
def test_read_answer_accepts_exactly_the_allowed_answers(text, expected):
    answer = read_answer(text, ANSWERS["navid"])
    assert (answer and (answer.action, answer.repeats)) == expected


def test_answer_for_is_the_longest_that_fits():
    answers = ANSWERS["navid"]
    assert [answers[answer_for(LEFT, n, answers)].repeats for n in (1, 2, 3, 9)] == [1, 2, 3, 3]


def test_settings_that_change_no_action_keep_the_fingerprint(server):
    agents = [remote(server), remote(server, timeout=9, retries=0, together=1)]
    assert contents(agents[0]).parts == contents(agents[1]).parts
    changed = remote(server, otherwise="turn right 45 degrees")
    assert contents(changed).parts != contents(agents[0]).parts


@pytest.mark.parametrize(
    "settings, words",
    [
        ({"model": ""}, "agent.model"),
        ({"otherwise": "dance"}, "agent.otherwise must be one of stop, forward 25 cm"),
        ({"together": 0}, "agent.together"),
        ({"url": "http://user:secret@host/v1"}, "must not contain @"),
    ],
)
def test_remote_explains_a_wrong_setting(settings, words):
    with pytest.raises(ValueError, match=words):
        RemoteAgent(**{"url": "http://localhost:1/v1", "model": "m", **settings})
