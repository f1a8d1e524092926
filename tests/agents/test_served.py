"""Tests of policies behind a model server; a fake server answers slowly, wrongly or not at all."""

from __future__ import annotations

import gc
import itertools
import pickle
import socket
import threading
import time

import gymnasium
import msgpack
import numpy as np
import pytest
from gymnasium import spaces
from websockets.sync.server import serve

from mitigate.agents.fingerprint import fingerprint
from mitigate.agents.policies import served
from mitigate.agents.policies.served import ServedPolicy
from mitigate.core.observation import FORWARD, LEFT, STOP
from mitigate.corruptions import CLEAN, Corruption
from mitigate.evaluation import rows as result_rows
from mitigate.evaluation.evaluator import evaluate
from tests.agents.vlm.corridor import CELLS, Corridor, episode
from tests.documented import example

FRAME = np.zeros((28, 28, 3), np.uint8)


def array(values, dtype: str = "<f4") -> dict:
    data = np.asarray(values, dtype)
    return {"__ndarray__": True, "data": data.tobytes(), "dtype": dtype, "shape": list(data.shape)}


def nested(depth: int) -> list:
    made: list = []
    for _ in range(depth):
        made = [made]
    return made


def expert(payload: dict) -> dict:
    """Return the correct action for a frame, which shows the agent's cell and the goal."""
    sent = payload["images"]["front"]
    frame = np.frombuffer(sent["data"], sent["dtype"]).reshape(sent["shape"])
    cell = int((frame[10] == (40, 220, 40)).all(-1).argmax()) // 3
    goal = int((frame[0] == (220, 40, 40)).all(-1).argmax()) // 3
    return {"actions": array([STOP if cell == goal else FORWARD if goal > cell else LEFT])}


@pytest.fixture
def server():
    """A server whose ``reply(number, payload)`` returns the payload of an action; None closes the
    connection, and bytes are sent as they are."""

    def talk(connection):
        stand_in.open += 1
        try:
            answer_all(connection)
        finally:
            stand_in.open -= 1

    def answer_all(connection):
        for data in connection:
            message = msgpack.unpackb(data)
            kind, payload, seq = message["type"], message["payload"], message["seq"]
            stand_in.received.append((kind, payload))
            if kind == "hello":
                answer = {"type": "hello", "payload": {"protocol_version": stand_in.protocol}}
            elif kind == "observation":
                made = stand_in.reply(next(stand_in.counter), payload)
                if made is None:
                    return
                if isinstance(made, bytes):
                    connection.send(made)
                    continue
                answer = {"type": "error" if "error" in made else "action", "payload": made}
            else:
                continue
            connection.send(msgpack.packb({**answer, "seq": seq, "timestamp": 0.0}))

    stand_in = serve(talk, "127.0.0.1", 0, compression=None, max_size=None)
    stand_in.talk, stand_in.open = talk, 0
    stand_in.counter, stand_in.received, stand_in.protocol = itertools.count(), [], 1
    stand_in.reply = lambda number, payload: expert(payload)
    thread = threading.Thread(target=stand_in.serve_forever, daemon=True)
    thread.start()
    stand_in.url = f"ws://127.0.0.1:{stand_in.socket.getsockname()[1]}"
    yield stand_in
    stand_in.shutdown()
    thread.join(5)


def first(action: np.ndarray) -> int:
    return int(action[0])


def policy(server, **others) -> ServedPolicy:
    options = {
        "cameras": {"rgb": "front"},
        "version": "1",
        "convert": first,
        "timeout": 2.0,
        "wait": 0.0,
    }
    return ServedPolicy(server.url, **{**options, **others})


def rows(agent: ServedPolicy, folder, workers: int = 1) -> list[dict]:
    out = folder / "rows.jsonl"
    episodes = [episode(k % CELLS, (3 * k + 5) % CELLS) for k in range(16)]
    unique = {one.episode_id: one for one in episodes}
    evaluate(
        agent,
        Corridor,
        list(unique.values()),
        [CLEAN, Corruption("foreign_object", 0.6)],
        name="served",
        out=out,
        split="test",
        workers=workers,
    )
    return result_rows.read(out)


def test_server_gets_the_frames_the_state_and_the_task(server):
    server.reply = lambda number, payload: {"actions": array([0.25, -1.0])}
    agent = policy(server, state="pose", convert=None)
    agent.reset("look around")
    action = agent.act({"rgb": FRAME, "pose": np.array([1.0, 2.0])})
    assert action.dtype == np.float32 and action.tolist() == [0.25, -1.0]
    (hello, _), (start, task), (_, sent) = server.received
    assert (hello, start, task) == ("hello", "episode_start", {"task": {"name": "look around"}})
    assert sent["task_description"] == "look around"
    assert sent["images"] == {"front": array(FRAME, "|u1")} and sent["state"] == array([1, 2])


def test_policy_sees_corrupted_frames(server, tmp_path):
    found = rows(policy(server), tmp_path)
    clean = [row for row in found if row["corruption"] == "clean"]
    assert len(clean) == 9 and all(row["success"] for row in clean)
    assert not all(row["success"] for row in found)


@pytest.mark.slow
def test_processes_have_their_own_connections(server, tmp_path):
    assert rows(policy(server), tmp_path / "a") == rows(policy(server), tmp_path / "b", workers=2)


def test_rows_are_kept_when_the_server_dies_and_are_completed_later(server, tmp_path):
    server.reply = lambda number, payload: expert(payload) if number < 30 else None
    with pytest.raises(ConnectionError, match="no usable answer.*same command"):
        rows(policy(server), tmp_path)
    assert 0 < len(result_rows.read(tmp_path / "rows.jsonl")) < 18
    server.reply = lambda number, payload: expert(payload)
    assert len(rows(policy(server), tmp_path)) == 18


@pytest.mark.parametrize(
    ("reply", "words"),
    [
        ({"error": "observation_failed: KeyError"}, "the server reports .*observation_failed"),
        ({"actions": array([[1.0], [2.0]])}, "one action .* with chunk_size="),
        ({"actions": array([np.nan])}, "finite numbers"),
        ({"actions": array([1e300], "<f8")}, "finite numbers"),
        ({"actions": array([])}, "finite numbers"),
        ({"actions": [[1], [1, 2]]}, "finite numbers"),
        ({"actions": ["1", "2.5"]}, "must return one action"),
        ({"actions": [True]}, "must return one action"),
        ({"terminate_episode": True}, "must return one action"),
        ({"actions": {"__ndarray__": True, "data": b"", "dtype": "(1,2", "shape": [0]}}, "allowed"),
        (msgpack.packb([[]] * 20_000), "no usable answer"),
        (msgpack.packb({"type": "action", "seq": [3], "payload": {}}), "instead of action 3"),
        (msgpack.packb({"type": "action", "seq": 3.0, "payload": {}}), "instead of action 3"),
        (msgpack.packb({"type": "error", "seq": 3, "payload": nested(400)}), "server reports"),
        ({"actions": {"__ndarray__": True, "data": b"", "dtype": "O", "shape": [0]}}, "no usable"),
        ({"actions": {"__ndarray__": True, "data": b"123", "dtype": "<f4"}}, "no usable answer"),
        (b"\xc1", "no usable answer"),
        (msgpack.packb([1]), "a list instead of a map"),
        (msgpack.packb({"type": "action", "seq": 99, "payload": {}}), "instead of action 3"),
        (msgpack.packb({"type": "action", "seq": 3, "payload": 5}), "the payload is not a map"),
    ],
)
def test_wrong_answer_is_an_error(server, reply, words):
    server.reply = lambda number, payload: reply
    agent = policy(server)
    agent.reset("go")
    with pytest.raises((ConnectionError, ValueError), match=words):
        agent.act({"rgb": FRAME})


def test_action_can_be_changed_by_the_conversion(server):
    def flip(action):
        action[-1] *= -1
        return action

    server.reply = lambda number, payload: {"actions": array([1.0, 2.0])}
    agent = policy(server, convert=flip)
    agent.reset("go")
    assert agent.act({"rgb": FRAME}).tolist() == [1.0, -2.0]


def test_server_that_stops_reading_is_an_error(server):
    """The frame is larger than the buffers of the sockets."""
    tested = threading.Event()
    server.reply = lambda number, payload: tested.wait(30)
    agent = policy(server, timeout=0.5)
    agent.reset("go")
    large = np.zeros((2000, 2000, 3), np.uint8)
    began = time.monotonic()
    for _ in range(2):
        with pytest.raises(ConnectionError, match="timeout="):
            agent.act({"rgb": large})
    assert time.monotonic() - began < 10
    tested.set()


def test_redirect_is_an_error(monkeypatch):
    """Frames go only to the address that the user named."""
    listening = socket.create_server(("127.0.0.1", 0))

    def answer():
        connection, _ = listening.accept()
        connection.recv(4096)
        connection.sendall(b"HTTP/1.1 302 Found\r\nLocation: ws://127.0.0.1:9/\r\n\r\n")
        connection.close()

    threading.Thread(target=answer, daemon=True).start()
    agent = ServedPolicy(f"ws://127.0.0.1:{listening.getsockname()[1]}", {"rgb": "front"}, "1")
    agent.wait = 0
    with pytest.raises(ConnectionError, match="No connection"):
        agent.reset("go")


@pytest.mark.parametrize("entry", [np.array([None, "x"], object), np.array(["x"]), None])
def test_only_numbers_are_sent(server, entry):
    agent = policy(server, state="pose")
    agent.reset("go")
    with pytest.raises(ValueError, match="must be an array of numbers"):
        agent.act({"rgb": entry, "pose": np.zeros(2)})
    with pytest.raises(ValueError, match="must be"):
        agent.act({"rgb": FRAME, "pose": entry})
    with pytest.raises(ValueError, match="must be finite numbers"):
        agent.act({"rgb": FRAME, "pose": np.array([np.inf])})
    assert "observation" not in [kind for kind, _ in server.received]


def test_instruction_must_be_text(server):
    for wrong in (None, 5, b"go"):
        with pytest.raises(TypeError, match="instruction must be a string"):
            policy(server).reset(wrong)
    with pytest.raises(ValueError, match="not valid text"):
        policy(server).reset("go \ud83d on")


def test_connections_are_closed(server):
    server.protocol = 2
    for _ in range(3):
        with pytest.raises(ConnectionError):
            policy(server).reset("go")
    server.protocol = 1
    agent = policy(server)
    agent.reset("go")
    agent.reset("go on")
    assert server.open == 1
    del agent
    gc.collect()
    ends = time.monotonic() + 5
    while server.open and time.monotonic() < ends:
        time.sleep(0.01)
    assert server.open == 0


def test_slow_server_is_an_error(server):
    server.reply = lambda number, payload: time.sleep(1) or expert(payload)
    agent = policy(server, timeout=0.2)
    agent.reset("go")
    with pytest.raises(ConnectionError, match=r"no answer within 0.2 s \(timeout=\)"):
        agent.act({"rgb": FRAME})


def test_other_protocol_and_absent_server_are_errors(server):
    server.protocol = 2
    with pytest.raises(ConnectionError, match="protocol version 1 .* got .?2"):
        policy(server).reset("go")
    with pytest.raises(ConnectionError, match="within 0 s .*Start the model server"):
        ServedPolicy("ws://127.0.0.1:1", {"rgb": "front"}, "1", wait=0).reset("go")


def test_policy_waits_for_a_server_that_starts_late(server, monkeypatch, capsys):
    monkeypatch.setattr(served, "PAUSE", 0.05)
    taken = socket.socket()
    taken.bind(("127.0.0.1", 0))
    agent = policy(server, wait=30.0)
    agent.url = f"ws://127.0.0.1:{taken.getsockname()[1]}"

    def start():
        time.sleep(0.3)
        taken.listen()
        with serve(server.talk, sock=taken, compression=None) as late:
            late.serve_forever()

    threading.Thread(target=start, daemon=True).start()
    agent.reset("go")
    assert "waiting for the model server" in capsys.readouterr().out


def test_settings_are_checked(server):
    for url in ("http://host:1", "ws://user:secret@host", "ws://", "ws://host?key=1"):
        with pytest.raises(ValueError, match="without a user, a password or a key") as error:
            ServedPolicy(url, {"rgb": "front"}, "1")
        assert "secret" not in str(error.value)
    with pytest.raises(ValueError, match="cameras must map"):
        ServedPolicy("ws://host", {}, "1")
    with pytest.raises(ValueError, match="different names"):
        ServedPolicy("ws://host", {"rgb": "front", "depth": "front"}, "1")
    with pytest.raises(ValueError, match="timeout must be > 0"):
        ServedPolicy("ws://host", {"rgb": "front"}, "1", timeout=0)
    with pytest.warns(UserWarning, match="frames of wrist stay clean"):
        ServedPolicy("ws://host", {"rgb": "front", "wrist": "wrist"}, "1")
    with pytest.raises(ValueError, match="version must name the weights"):
        ServedPolicy("ws://host", {"rgb": "front"}, "")
    agent = policy(server)
    agent.reset("go")
    with pytest.raises(KeyError, match="The observation must have rgb; it has depth"):
        agent.act({"depth": FRAME})


class Reach(gymnasium.Env):
    """An episode of three steps, which succeeds if the actions are 0.5."""

    observation_space = spaces.Dict(
        {
            "rgb": spaces.Box(0, 255, (16, 16, 3), np.uint8),
            "state": spaces.Box(-1, 1, (2,), np.float32),
        }
    )
    action_space = spaces.Box(-1, 1, (1,), np.float32)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.steps, self.correct = 0, True
        return self.observe(), {}

    def step(self, action):
        self.steps += 1
        self.correct = self.correct and float(action[0]) == 0.5
        return self.observe(), 0.0, self.steps == 3, False, {"is_success": self.correct}

    def observe(self):
        return {"rgb": np.full((16, 16, 3), 90, np.uint8), "state": np.zeros(2, np.float32)}


def test_example_of_the_documentation(server, tmp_path, monkeypatch):
    """The server answers correctly if it sees the clean frame."""

    def reply(number, payload):
        clean = set(payload["images"]["agentview"]["data"]) == {90}
        return {"actions": array([0.5 if clean and payload["state"] else 0.0])}

    server.reply = reply
    monkeypatch.chdir(tmp_path)
    code = example("vlm.md", "served").replace("ws://gpu-machine:8000", server.url)
    exec(code, {"make_env": Reach})
    (file,) = tmp_path.glob("runs/benchmark/*/rows.jsonl")
    rates = {(row["corruption"], row["success"]) for row in result_rows.read(file)}
    assert ("clean", 1) in rates and ("clean", 0) not in rates and ("spatter", 0) in rates


def test_other_weights_on_the_server_are_another_agent(server):
    prints = {fingerprint(policy(server, version=name), Corridor.sensors) for name in ("a", "b")}
    assert len(prints) == 2
    moved = policy(server, version="a", timeout=9.0)
    moved.url = "ws://another-machine:8000"
    assert fingerprint(moved, Corridor.sensors) in prints


def test_order_of_cameras_is_part_of_the_agent(server):
    orders = [{"rgb": "a", "depth": "b"}, {"depth": "b", "rgb": "a"}]
    one, other = (policy(server, cameras=cameras) for cameras in orders)
    assert fingerprint(one, Corridor.sensors) != fingerprint(other, Corridor.sensors)


def test_copy_for_another_process_opens_its_own_connection(server):
    agent = policy(server)
    agent.reset("go")
    copied = pickle.loads(pickle.dumps(agent))
    with pytest.raises(RuntimeError, match="Start the episode first"):
        copied.act({"rgb": FRAME})
    copied.reset("go")
    assert copied.act({"rgb": FRAME}) == STOP
