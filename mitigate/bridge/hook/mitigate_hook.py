"""The agent's side of the bridge: it corrupts the inputs of an unchanged program in its own
process.

``mitigate run -- COMMAND`` puts this folder first on PYTHONPATH, so every Python process of the
command loads this file through ``sitecustomize.py``. When a process imports habitat-lab (0.1.5 to
0.3), habitat-sim alone or WMNav, this file wraps a few methods of these packages. It sends frames
to the server through shared memory, and instructions through a socket. The server sends back
corrupted frames and instructions. A loop that does not use Habitat calls ``connect``, ``corrupt``
and ``finish``:

    import mitigate_hook
    episode = mitigate_hook.connect("17", scene="x.glb", instruction="Go to the door.")
    hear(episode.instruction)
    act_on(episode.corrupt({"rgb": rgb, "depth": depth}))  # at each step
    episode.finish(success=True, spl=0.8)

This file runs on Python 3.6 to 3.13 and needs only the standard library and numpy. If the server
reports an error, dies or is late, the process ends with a message, so that no agent continues with
clean frames.
"""

import contextlib
import functools
import importlib.machinery
import importlib.util
import json
import math
import mmap
import os
import socket
import struct
import sys
import threading
import weakref

np = None  # imported on demand: every Python process loads this file, and some have no numpy
PROTOCOL = 3
ADDRESS, TOKEN, PATIENCE = "MITIGATE_BRIDGE", "MITIGATE_TOKEN", "MITIGATE_PATIENCE"
# JSON object: folder, file (the path of plain_adapters.py), module, class, path
ADAPTERS = "MITIGATE_ADAPTERS"
HEADER = struct.Struct("!4sI")  # magic bytes, and the size of the JSON object that follows
MAGIC = b"mtg1"
# maximum size of a message in bytes
# The largest messages have about 1e6 bytes: episodes that contain all view points of their goals.
MAX_MESSAGE = 1 << 24
KEYS_PER_MESSAGE = 10000  # maximum number of episode names; train splits have millions of episodes
# name of a file next to the socket; a process creates it when it loads this module
LOADED = "loaded"
MAX_TEXT = 4000  # maximum length of a reported problem, in characters
STATUS = 97  # exit status of a process that stopped itself
REPORT_TIMEOUT = 3.0  # maximum seconds for a stopping process to report the reason (heuristic)
COLOR, DEPTH = "rgb", "depth"  # kinds of camera
# how an episode ended: it was over, its Env was reset or closed early, or an exception ended it
OVER, RESET, CLOSE, BROKEN = "over", "reset", "close", "broken"
# exceptions that signal the normal end of a loop
ORDERLY = (StopIteration, StopAsyncIteration, GeneratorExit)


class _Thread(threading.local):
    session = None  # the session that ``connect`` uses


_thread = _Thread()
# corrupted frames that the program still holds, by id
_corrupted_frames: "weakref.WeakValueDictionary[int, object]" = weakref.WeakValueDictionary()


# messages ---------------------------------------------------------------------------------------


def send(channel, message):
    """Send a dict of plain data; convert numpy numbers and arrays to Python's types.

    Raises ValueError if the message is too large, and TypeError if a value is not plain data.
    """
    body = json.dumps(message, default=_as_python).encode("utf-8")
    if len(body) > MAX_MESSAGE:
        raise ValueError(f"a message must be <= {MAX_MESSAGE} bytes, got {len(body)}")
    channel.sendall(HEADER.pack(MAGIC, len(body)) + body)


def _as_python(value):
    """Return a numpy value as plain Python data."""
    if isinstance(value, (np.generic, np.ndarray)):
        return value.tolist()
    raise TypeError(f"values must be numbers, text and lists, got a {type(value).__name__}")


def receive(channel):
    """Return the next message, or None at the end. Raises ValueError for an invalid message."""
    header = _read(channel, HEADER.size)
    if header is None:
        return None
    magic, size = HEADER.unpack(header)
    if magic != MAGIC or size > MAX_MESSAGE:
        raise ValueError("the other side does not use this protocol")
    body = _read(channel, size)
    if body is None:
        return None
    message = json.loads(body.decode("utf-8"))
    if not isinstance(message, dict):
        raise ValueError("a message must be a JSON object")
    return message


def _read(channel, size):
    """Return ``size`` bytes, or None if the channel ends earlier."""
    data = bytearray()
    while len(data) < size:
        part = channel.recv(min(size - len(data), 1 << 16))
        if not part:
            return None
        data += part
    return bytes(data)


def stop(problem, reported=False):
    """Print a message and end this process at once, because the program might catch an exception.

    The server gets the reason, so that the condition does not count as finished. The process ends
    even if this function fails or is interrupted.

    Args:
        problem: The reason, as a sentence.
        reported: Whether the server already knows the reason.
    """
    try:
        try:
            if not reported:
                _report(str(problem)[:MAX_TEXT])
        finally:
            text = (
                f"\nmitigate: {problem} This process ({os.getpid()}) ends here, because it would "
                "continue with frames that are not corrupted. The results so far are kept; see "
                "the output of `mitigate run`.\n"
            )
            # sys.stderr may be None.
            # If sys.__stderr__ is also None, descriptor 2 may belong to any file.
            if sys.__stderr__ is not None:
                os.write(2, text.encode("utf-8", "replace"))
    finally:
        os._exit(STATUS)


def _report(problem):
    """Send the server the reason why this process ends, through a new connection."""
    with contextlib.suppress(BaseException):  # the process ends even if this fails
        hello = {"kind": "hello", "protocol": PROTOCOL, "token": os.environ.get(TOKEN, "")}
        hello.update(pid=os.getpid(), python=sys.version.split()[0])
        channel = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        channel.settimeout(min(REPORT_TIMEOUT, float(os.environ.get(PATIENCE, "25"))))
        channel.connect(os.environ[ADDRESS])
        send(channel, hello)
        if receive(channel) == {}:
            send(channel, {"kind": "stopped", "problem": problem})
            receive(channel)


class Channel:
    """The connection of one environment to the server; every failure ends the process."""

    def __init__(self):
        _load_numpy()
        self.pid = os.getpid()
        self.memory = None
        self.layout = {}
        self.number = 0  # number of the last message; the answer contains the same number
        self.patience = float(os.environ.get(PATIENCE, "25"))
        try:
            self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
            self.socket.settimeout(self.patience)
            self.socket.connect(os.environ[ADDRESS])
        # this also handles interrupts, because the agent might catch them
        except BaseException as error:
            stop(
                f"the server of `mitigate run` cannot be reached at "
                f"{os.environ.get(ADDRESS)} ({_describe_error(error)}). A container needs the "
                "host's temporary folder (docker: -v /tmp:/tmp)."
            )
        self.ask("hello", protocol=PROTOCOL, token=os.environ.get(TOKEN, ""), **_versions())

    def ask(self, kind, **fields):
        """Send a message and return the answer.

        After an interrupted message, no other message is sent, because the late answer would be
        read as the answer to the next message.
        """
        self.number += 1
        number = self.number
        fields.update(kind=kind, number=number)
        try:
            send(self.socket, fields)
            answer = receive(self.socket)
        except socket.timeout:  # before Python 3.10, this is not a TimeoutError
            stop(f"the server did not answer within {self.patience:g} s.")
        except TypeError as error:  # json raises this before anything is sent
            stop(
                f"the values of {kind} must be numbers, text and lists, and cannot be sent "
                f"({error}). Convert them."
            )
        # end the process on any error: the agent might catch an exception and continue
        except BaseException as error:
            stop(f"the connection to the server broke ({_describe_error(error)}).")
        if answer is None:
            stop("the server of `mitigate run` is gone.")
        if "error" in answer:
            stop(answer["error"], reported=True)
        if answer.pop("number", None) != number:
            stop("the server answered another message.")
        return answer

    def map_memory(self, cameras, unread):
        """Describe the cameras to the server and map the memory that it provides.

        ``unread`` names observations that look like frames, but whose sensors are not cameras.
        """
        answer = self.ask("spec", cameras=cameras, unread=unread)
        self.layout = {name: int(offset) for name, offset in answer["offsets"].items()}
        self.memory = None
        if not self.layout:
            return
        try:
            descriptor = os.open(answer["file"], os.O_RDWR)
            try:
                self.memory = mmap.mmap(descriptor, int(answer["size"]))
            finally:
                os.close(descriptor)
        except BaseException as error:
            stop(
                f"the shared memory for frames, {answer['file']}, cannot be mapped "
                f"({_describe_error(error)}). A container needs the host's /dev/shm (docker: "
                "--ipc=host -v /dev/shm:/dev/shm)."
            )

    def frame_array(self, camera):
        """Return an array that shares memory with a camera's mapped frame."""
        count, offset = int(np.prod(camera["shape"])), self.layout[camera["name"]]
        return np.frombuffer(self.memory, camera["dtype"], count, offset).reshape(camera["shape"])


def _describe_error(error):
    """Return the class name and the text of an exception."""
    return f"{type(error).__name__}: {error}"


def _is_orderly(error):
    """Return whether an exception signals the normal end of a loop or of the program."""
    ended = isinstance(error, SystemExit) and error.code in (None, 0)
    return ended or isinstance(error, ORDERLY)


def _describe_fault(error):
    """Return the class name and text of an exception, and the file and line that raised it."""
    traceback = error.__traceback__
    while traceback is not None and traceback.tb_next is not None:
        traceback = traceback.tb_next
    place = ""
    if traceback is not None:
        place = f" ({traceback.tb_frame.f_code.co_filename}:{traceback.tb_lineno})"
    return f"{_describe_error(error)[:MAX_TEXT]}{place}"


def _get(owner, name, default=None):
    """Return an attribute that exists only in some versions of a library, else ``default``."""
    return getattr(owner, name, default)  # the name is known only at run time


def _load_numpy():
    global np
    import numpy as np


def _versions():
    """Return the process id and the versions of Python and of the libraries in use."""
    names = ("numpy", "habitat", "habitat_sim", "torch")
    versions = {n: str(_get(sys.modules.get(n), "__version__", "")) for n in names}
    return dict(versions, pid=os.getpid(), python=sys.version.split()[0])


# one environment --------------------------------------------------------------------------------


def _uninterrupted(failure):
    """Wrap a method of ``Session``.

    Only one thread at a time runs the method, and an exception ends the process. An interrupt also
    ends the process, because the agent might catch it and act on incomplete data. ``failure`` is
    the beginning of the message.
    """

    def decorate(method):
        @functools.wraps(method)
        def wrapper(session, *args, **kwargs):
            session.renew_lock()
            with session.lock:
                if session.busy:
                    stop(f"{failure}: another call of the same environment has not returned yet.")
                try:
                    session.busy = True
                    result = method(session, *args, **kwargs)
                    session.busy = False
                    return result
                except BaseException as error:
                    stop(f"{failure} ({_describe_error(error)}).")

        return wrapper

    return decorate


class Session:
    """The connection of one environment and the state of its current episode."""

    def __init__(self):
        self.channel = None
        self.cameras = None  # camera descriptions that the server has received
        # observations that look like frames, but whose sensors are not cameras
        self.unread = []
        self.sim = self.task = self.episode = None
        self.active = False  # whether an episode has begun and not ended
        self.busy = False
        self.handled = id(None)  # id of the exception that was being handled when the episode began
        # whether this episode received frames from habitat-sim without habitat-lab
        self.simulated = False
        self.episode_pid = None  # id of the process that began the episode
        self.lock_pid = os.getpid()
        self.lock = threading.RLock()
        self.current = None  # the Episode that ``connect`` returned
        self.words = None  # the instruction object whose text is replaced during this episode
        self.clear()

    def clear(self):
        """Reset the data that is recorded about an episode."""
        self.calls = 0
        self.steps = 0
        self.path = []
        self.actions = []
        self.start = None
        self.farthest = {}  # maps a depth camera to the maximum depth in its first frame

    def renew_lock(self):
        """Replace the lock in a forked process, because a thread of the parent may have held it."""
        if self.lock_pid != os.getpid():
            self.lock_pid = os.getpid()
            self.lock = threading.RLock()
            self.busy = False

    def close(self):
        """Close the connection; a later frame opens a new connection."""
        self.renew_lock()
        with self.lock:
            if self.channel is not None:
                self.channel.socket.close()
            self.channel = self.cameras = self.sim = self.task = self.episode = None

    def connected(self):
        """Return the channel; a forked process opens a new channel."""
        if self.channel is None or self.channel.pid != os.getpid():
            self.channel, self.cameras = Channel(), None
        return self.channel

    @_uninterrupted("the episode could not begin")
    def begin(self, scene, name, **fields):
        """Begin an episode; return the answer, which contains the instruction for the agent."""
        self.clear()
        self.episode_pid = os.getpid()
        self.simulated = False
        self.handled = id(sys.exc_info()[1])
        answer = self.connected().ask("episode", scene=str(scene), id=str(name), **fields)
        self.active = True
        return answer

    @_uninterrupted("a frame could not be corrupted")
    def corrupt(self, observations, cameras, heading=None):
        """Replace the frames of ``cameras`` in a dict of observations, in the order of the keys.

        Args:
            observations: Arrays by name.
            cameras: Dicts that describe the cameras: name, type ("rgb" or "depth") and other
                options (``_describe_sensor``).
            heading: Radians, counter-clockwise.
        """
        self._check(observations, cameras)
        channel = self.connected()
        heading = None if heading is None else float(heading)
        # as plain data, because descriptions are compared with ``==`` at each step
        described = json.loads(json.dumps(cameras, default=_as_python))
        for camera in described:
            camera.update(_describe_array(observations[camera["name"]], camera["name"]))
        if described != self.cameras:
            channel.map_memory(described, self.unread)
            self.cameras = described
        for camera in described:
            if camera["name"] in channel.layout:
                frame = observations[camera["name"]]
                channel.frame_array(camera)[...] = frame[..., :3] if camera["alpha"] else frame
        medians = {}
        for name in (camera["name"] for camera in described if camera["type"] == DEPTH):
            if self.farthest.get(name) is None:  # the server checks the declared range
                medians[name], self.farthest[name] = _median_and_maximum(observations[name])
        pose = {"heading": heading, "position": self.position()}
        answer = channel.ask("frame", call=self.calls, depth=medians, **pose)
        self.calls += 1
        for camera in described:
            if camera["name"] in answer["changed"]:
                before = observations[camera["name"]]
                frame = np.empty(before.shape, before.dtype)  # a new, writable, contiguous array
                if camera["alpha"]:
                    frame[..., 3] = before[..., 3]
                    frame[..., :3] = channel.frame_array(camera)
                else:
                    frame[...] = channel.frame_array(camera)
                observations[camera["name"]] = _corrupted_frames[id(frame)] = frame
        return observations

    def _check(self, observations, cameras):
        """Stop the process if the frames belong to no episode or are already corrupted."""
        if self.episode_pid not in (None, os.getpid()):
            stop(
                f"process {self.episode_pid} began the current episode, and its fork "
                f"{os.getpid()} continues it. Reset the environment in the process that runs it, "
                "or start workers before the first reset."
            )
        for camera in cameras:
            if _is_corrupted(observations[camera["name"]]):
                stop(
                    f"the frame {camera['name']} is corrupted already. Pass each frame once, as "
                    "the camera returned it. A loop with habitat-lab or habitat-sim, whose frames "
                    "are corrupted as they are taken, calls connect and finish only."
                )

    def position(self):
        """Return the position of the agent, [x, y, z], or None if it is unknown."""
        state = None if self.sim is None else self.sim.get_agent_state()
        return None if state is None else [float(x) for x in state.position]

    def record_step(self, action=None):
        """Count a low-level step; record the action and the position after the step."""
        self.steps += 1
        if sys.exc_info()[1] is None:
            self.handled = id(None)
        self.actions.append(_plain_action(action))
        position = self.position()
        if position is not None and position not in self.path[-1:]:
            self.path.append(position)

    @_uninterrupted("the result of the episode could not be reported")
    def end(self, metrics, how=OVER, stopped=None):
        """Report the result of the episode exactly once.

        An episode without a step is not reported, and a forked process does not end the episode of
        its parent. If an exception ends an episode early, the episode counts as unfinished, and not
        as a failure of the agent.
        """
        if not self.active or self.episode_pid != os.getpid():
            return
        self.active = False
        fault = None if how == OVER else self._fault()
        if fault is not None:
            how = BROKEN
        if self.steps or self.sim is None:
            report = {"metrics": _finite_numbers(metrics), "steps": self.steps, "calls": self.calls}
            report.update({} if fault is None else {"fault": _describe_fault(fault)})
            report.update(how=how, stopped=stopped, farthest=self.farthest)
            report.update(path=self.path, actions=self.actions, **self._distances())
            self.channel.ask("end", **report)

    def _fault(self):
        """Return the exception that was raised or handled after the episode began, or None.

        Exceptions that only end a loop or the program do not count.
        """
        error = sys.exc_info()[1]
        while error is not None and _is_orderly(error) and id(error) != self.handled:
            error = error.__context__
        return None if id(error) == self.handled else error

    def _distances(self):
        """Return the geodesic distances from start and end to the goals.

        The result also contains whether STOP was called.
        """
        if self.sim is None or self.episode is None:
            return {}
        stopped = _get(self.task, "is_stop_called")
        return {
            "start_distance": self.start,
            "distance": _distance(self.sim, self.path[-1] if self.path else None, self.episode),
            "stopped": None if stopped is None else bool(stopped),
        }


def _is_corrupted(frame):
    """Return whether an array is a corrupted frame or a view of a corrupted frame."""
    while isinstance(frame, np.ndarray) and isinstance(frame.base, np.ndarray):
        frame = frame.base
    return _corrupted_frames.get(id(frame)) is frame


def _plain_action(action):
    """Convert a Habitat action (a number, a name, or a dict with one of these) to plain data."""
    if isinstance(action, dict):
        action = action.get("action")
    if action is None:
        return None
    return int(action) if isinstance(action, (int, np.integer)) else str(action)


def _describe_array(frame, name):
    """Describe the shape and dtype of a frame for the server."""
    if not isinstance(frame, np.ndarray):
        stop(
            f"the camera {name} must return a numpy array, got {type(frame).__name__}. Set "
            "Habitat's GPU_GPU (gpu_gpu) to False, or convert it (tensor.cpu().numpy()). For an "
            "entry that is not a frame: cameras={name: {'type': 'other'}}."
        )
    alpha = frame.dtype == np.uint8 and frame.ndim == 3 and frame.shape[-1] == 4
    shape = [*frame.shape[:-1], 3] if alpha else list(frame.shape)
    return {"shape": shape, "dtype": frame.dtype.name, "alpha": alpha}


def _median_and_maximum(depth):
    """Return the median and maximum of the valid depth, or (None, None) if no pixel is valid."""
    sample = np.asarray(depth[::4, ::4], np.float64)
    sample = sample[np.isfinite(sample) & (sample > 0)]
    return (float(np.median(sample)), float(sample.max())) if sample.size else (None, None)


def _finite_numbers(metrics, prefix=""):
    """Return a flat dict of the finite numbers in nested dicts, with dotted names as keys.

    ``distance_to_goal`` may be infinite, because an unreachable goal means failure by every rule.
    """
    numbers = {}
    for name, value in dict(metrics or {}).items():
        if isinstance(value, dict):
            numbers.update(_finite_numbers(value, f"{prefix}{name}."))
            continue
        if _get(value, "shape") == () and _get(value, "item"):  # a scalar of numpy or torch
            value = value.item()
        name = prefix + str(name)
        unreachable = name == "distance_to_goal" and value == math.inf
        if isinstance(value, (int, float)) and (unreachable or math.isfinite(value)):
            numbers[name] = float(value)
    return numbers


def _distance(sim, position, episode):
    """Return the geodesic distance in metres to the nearest goal or view point, or None if unknown.

    The result is infinite if no goal can be reached.
    """
    goals = _get(episode, "goals") or []
    views = [p.agent_state.position for g in goals for p in _get(g, "view_points") or []]
    ends = [list(map(float, end)) for end in views or [g.position for g in goals]]
    if not ends or position is None:
        return None
    return float(sim.geodesic_distance(position, ends))


# habitat-lab ------------------------------------------------------------------------------------


CAMERA = ("hfov", "min_depth", "max_depth", "normalize_depth", "position", "orientation")
# caches (sensor, description) by the id of the sensor, because reading configs is slow
_descriptions = {}


def _describe_sensor(sensor):
    """Describe a habitat-lab sensor; in versions before 0.2.3, option names are in upper case."""
    if id(sensor) in _descriptions:
        return _descriptions[id(sensor)][1]
    config, description = _get(sensor, "config"), {}
    for option in CAMERA:
        value = _get(config, option, _get(config, option.upper()))
        is_plain = value is None or isinstance(value, (int, float))
        description[option] = value if is_plain else [float(x) for x in value]
    kind = str(_get(sensor, "sensor_type", "")).rpartition(".")[2].lower()
    description.update(name=sensor.uuid, type=COLOR if kind == "color" else kind)
    _descriptions[id(sensor)] = (sensor, description)
    return description


def _heading(state):
    """Return the agent's heading in radians, counter-clockwise, from its quaternion."""
    rotation = state.rotation
    if _get(rotation, "imag") is not None:  # numpy-quaternion
        return 2 * math.atan2(float(rotation.imag[1]), float(rotation.real))
    x, y, z, w = rotation
    return 2 * math.atan2(float(y), float(w))


_sessions = {}  # maps the id of a simulator or sensor suite to (that object, its session)


def _session_of(owner):
    """Return the session of a sensor suite or simulator."""
    if id(owner) not in _sessions:  # the entry keeps the object alive, so that its id is not reused
        _sessions.setdefault(id(owner), (owner, Session()))  # all threads get the same session
    return _sessions[id(owner)][1]


def _call_clean(original, *args, **kwargs):
    """Call a method whose frames are used for goal pictures or videos, not for acting."""
    return original(*args, **kwargs)


def _is_clean_call():
    """Return whether this thread is inside ``_call_clean``."""
    # the stack is inspected instead of a flag, because an interrupt could leave a flag set
    frame = sys._getframe(1)
    while frame is not None and frame.f_code is not _call_clean.__code__:
        frame = frame.f_back
    return frame is not None


def _get_observations(original, suite, *args, **kwargs):
    """Wrap the simulator's ``SensorSuite.get_observations``.

    habitat-lab passes ``task`` and ``episode`` only to the sensors of the task. Their frames stay
    clean, because these sensors may render a picture of the goal.
    """
    if "task" in kwargs or "episode" in kwargs:
        return _call_clean(original, suite, *args, **kwargs)
    observations = original(suite, *args, **kwargs)
    described = [_describe_sensor(s) for s in suite.sensors.values() if s.uuid in observations]
    cameras = [camera for camera in described if camera["type"] in (COLOR, DEPTH)]
    if _is_clean_call() or not cameras:
        return observations
    session = _session_of(suite)
    if session.cameras is None:
        session.unread = [
            f"{sensor['name']} with sensor_type {sensor['type'].upper() or None}"
            for sensor in described
            if sensor not in cameras and _is_float_image(observations[sensor["name"]])
        ]
    heading = None if session.sim is None else _heading(session.sim.get_agent_state())
    return session.corrupt(observations, cameras, heading)


def _is_float_image(value):
    """Return whether an observation has the shape of a frame and a floating-point dtype."""
    return _may_be_frame(_shape(value)) and str(_get(value, "dtype")).startswith("float")


def _task_reset(original, task, episode, *args, **kwargs):
    """Wrap ``EmbodiedTask.reset`` to end the last episode and replace the next instruction."""
    sim = task._sim
    if _get(_get(sim, "config"), "enable_batch_renderer"):
        stop(
            "frames of Habitat's batch renderer pass no sensor and would be clean. Set "
            "enable_batch_renderer=False."
        )
    session = _session_of(sim.sensor_suite)
    session.end(task.measurements.get_metrics() if session.active else None, RESET)
    _restore_words(session)
    session.sim, session.task, session.episode = sim, task, episode
    words = _get(episode, "instruction")
    text, tokens = _original_words(words)
    plain = None if tokens is None else [t if isinstance(t, str) else int(t) for t in tokens]
    fields = {"language": _get(words, "language"), "category": _get(episode, "object_category")}
    answer = session.begin(episode.scene_id, episode.episode_id, text=text, tokens=plain, **fields)
    if words is not None and answer.get("text") is not None:
        words._mitigate_own = (answer["text"], text, tokens)
        session.words = words
        _set_words(words, answer["text"], answer["tokens"])
    observations = original(task, episode, *args, **kwargs)
    session.start = _distance(sim, session.position(), episode)
    session.path = [position for position in [session.position()] if position is not None]
    return observations


def _original_words(words):
    """Return the original text and tokens of an instruction in the data set.

    A session may have replaced both, and the program may have changed them later. A replaced text
    must not be corrupted again. A copy or pickle of a replaced instruction is recognised by its
    text.
    """
    text = _get(words, "instruction_text")
    replacement, *originals = _get(words, "_mitigate_own", (None, None, None))
    replaced = replacement is not None and (replacement == text or _is_in_use(words))
    return originals if replaced else (text, _get(words, "instruction_tokens"))


def _is_in_use(words):
    """Return whether an episode of any session has this instruction."""
    return any(session.words is words for _, session in list(_sessions.values()))


def _set_words(words, text, tokens):
    words.instruction_text = text
    if _get(words, "instruction_tokens") is not None:
        words.instruction_tokens = tokens


def _restore_words(session):
    """Restore the original instruction, unless a different session uses it."""
    words, session.words = session.words, None
    if words is None or _is_in_use(words):
        return
    # pop makes this happen only once, even if several threads end the episode at the same time
    originals = vars(words).pop("_mitigate_own", None)
    if originals is not None:
        _set_words(words, *originals[1:])


def _update_measures(original, measurements, *args, **kwargs):
    """Wrap ``Measurements.update_measures``, which is called once per low-level step."""
    result = original(measurements, *args, **kwargs)
    sim = _get(kwargs.get("task"), "_sim")
    if sim is not None:
        _session_of(sim.sensor_suite).record_step(kwargs.get("action"))
    return result


def _env_init(original, env, config, dataset=None, *args, **kwargs):
    """Wrap ``Env.__init__`` to keep only the selected episodes of the dataset."""
    original(env, config, _keep_selected(dataset), *args, **kwargs)
    if _get(env, "sim") is None:
        stop(f"habitat.core.env.Env has no sim, so it is not habitat-lab's. {OWN_ENV}")


def _make_dataset(original, *args, **kwargs):
    """Wrap ``make_dataset``, which ``Env.__init__`` calls if it receives no dataset."""
    return _keep_selected(original(*args, **kwargs))


def _keep_selected(dataset):
    """Remove the episodes that the run does not need."""
    if dataset is not None and len(dataset.episodes):
        keep = _select(dataset.episodes, lambda e: _episode_key(e.scene_id, e.episode_id), 1)
        if keep is not None:
            dataset.episodes = [dataset.episodes[i] for i in keep]
    return dataset


def _select(episodes, key, least):
    """Return the indices of the episodes that the run needs, or None for all episodes.

    Args:
        episodes: All episodes.
        key: Function that returns the name of an episode. If the server chooses episodes, it
            receives all names, in several messages.
        least: The minimum number of episodes to keep, 0 or 1.
    """
    channel, count = Channel(), len(episodes)
    answer = channel.ask("dataset", count=count, keys=[], least=least)
    for start in range(0, count, KEYS_PER_MESSAGE):
        if "keep" not in answer:
            keys = [key(episode) for episode in episodes[start : start + KEYS_PER_MESSAGE]]
            answer = channel.ask("dataset", count=count, keys=keys, least=least)
    return answer["keep"]


def _env_reset(original, env, *args, **kwargs):
    """Wrap ``Env.reset`` to report the last episode before the next scene is loaded."""
    _end_episode(env, RESET)
    return original(env, *args, **kwargs)


def _env_step(original, env, *args, **kwargs):
    observations = original(env, *args, **kwargs)
    if env.episode_over:
        _end_episode(env, OVER)
    return observations


def _env_close(original, env, *args, **kwargs):
    """Wrap ``Env.close``, so that programs that open an Env per episode do not leak connections."""
    _end_episode(env, CLOSE)
    suite = _get(env.sim, "sensor_suite")
    try:
        return original(env, *args, **kwargs)
    finally:
        _, session = _sessions.pop(id(suite), (None, None))
        for sensor in suite.sensors.values() if suite is not None else ():
            _descriptions.pop(id(sensor), None)
        if session is not None:
            _restore_words(session)
            session.close()


def _end_episode(env, how):
    suite = _get(env.sim, "sensor_suite")
    if suite is not None and _session_of(suite).active:
        _session_of(suite).end(env.get_metrics(), how)


# habitat-sim without habitat-lab
# --------------------------------------------------------------------


def _sensor_observations(original, sim, *args, **kwargs):
    """Wrap ``Simulator.get_sensor_observations``."""
    # some versions call this method again for each agent; those inner calls must stay clean
    observations = _call_clean(original, sim, *args, **kwargs)
    return _corrupt_acting_agent(sim, observations, args[0] if args else kwargs.get("agent_ids"))


def _async_observations(original, sim, *args, **kwargs):
    """Wrap ``Simulator.get_sensor_observations_async_finish``, if habitat-sim has it."""
    agent_ids = _get(sim, "_async_draw_agent_ids")  # read first, because the call clears it
    observations = _call_clean(original, sim, *args, **kwargs)
    return _corrupt_acting_agent(sim, observations, agent_ids)


def _is_called_by_lab(sim):
    """Return whether habitat-lab is the caller; its frames are corrupted at its own sensors.

    The caller is habitat-lab if its code is in a module of habitat-lab. A method of the simulator
    also belongs to habitat-lab if it overrides a method of a habitat-lab class. If any other code
    takes frames from a habitat-lab simulator, the process stops.
    """
    frame = sys._getframe(1)
    passed_over = (_package(__name__), "habitat_sim")
    while frame is not None and _package(frame.f_globals.get("__name__")) in passed_over:
        frame = frame.f_back
    if frame is None or _package(frame.f_globals.get("__name__")) == "habitat":
        return frame is not None
    if _get(sim, "sensor_suite") is None:
        return False
    lab_classes = [kind for kind in type(sim).__mro__ if _package(kind.__module__) == "habitat"]
    name = frame.f_code.co_name
    if frame.f_locals.get("self") is sim and any(name in vars(kind) for kind in lab_classes):
        return True
    stop(
        f"{frame.f_code.co_filename}:{frame.f_lineno} calls get_sensor_observations of "
        "habitat-lab's simulator, whose frames would be clean. Use env.step or env.sim."
        "get_observations_at(...), or env.render for frames that the agent does not see."
    )


def _package(module):
    return str(module).partition(".")[0]


def _corrupt_acting_agent(sim, observations, agent_ids):
    """Corrupt the observations of the acting agent only.

    Observations stay unchanged inside ``_call_clean``. Observations that habitat-lab
    requested also stay unchanged here, because habitat-lab's sensors corrupt them.

    Args:
        sim: The simulator.
        observations: Maps sensors to observations. With several agents, it maps agent numbers to
            such dicts.
        agent_ids: The ids of the requested agents; None means the acting agent.
    """
    if _is_clean_call() or _is_called_by_lab(sim):
        return observations
    acting = _default_agent(sim)
    if observations and all(isinstance(value, dict) for value in observations.values()):
        if acting in observations:
            observations[acting] = _corrupt_observations(sim, observations[acting])
        return observations
    agent = agent_ids[0] if isinstance(agent_ids, (list, tuple)) else agent_ids
    if agent is None or agent == acting:
        return _corrupt_observations(sim, observations)
    return observations


def _corrupt_observations(sim, observations):
    session = _thread.session
    if session is None or session.episode_pid != os.getpid():
        stop(
            "habitat-sim is used without habitat-lab, and this thread of this process began no "
            "episode. Call mitigate_hook.connect(episode, scene=...) before the first frame."
        )
    session.simulated = True
    cameras = [c for c in _describe_simulator(sim) if c["name"] in observations]
    heading = _heading(sim.get_agent(_default_agent(sim)).get_state())
    return session.corrupt(observations, cameras, heading)


def _default_agent(sim):
    return _get(sim, "_default_agent_id", 0)


def _describe_simulator(sim):
    """Return the descriptions of the cameras of habitat-sim's default agent."""
    cameras = []
    for spec in sim.config.agents[_default_agent(sim)].sensor_specifications:
        kind = str(spec.sensor_type).rpartition(".")[2].lower()
        if kind in ("color", "depth"):
            camera = {"name": spec.uuid, "type": COLOR if kind == "color" else DEPTH}
            camera.update(hfov=float(_get(spec, "hfov", 90)), normalize_depth=False)
            camera["position"] = [float(x) for x in spec.position]
            camera["orientation"] = [float(x) for x in spec.orientation]
            cameras.append(camera)
    return cameras


# WMNav ------------------------------------------------------------------------------------------


def _wmnav_episode(original, env, number, *args, **kwargs):
    """Wrap WMNav's ``Env._run_episode``.

    WMNav opens a simulator per episode, and does not use habitat-lab.
    """
    _thread.session = session = _thread.session or Session()
    episode = env.all_episodes[number]
    words = episode["object_category"]
    answer = session.begin(
        episode["scene_id"], episode["episode_id"], text=words, category=words, loop=True
    )
    original_initialize = env._initialize_episode

    def initialize(*numbers):
        observations = original_initialize(*numbers)
        env.current_episode["object"] = answer.get("text") or env.current_episode["object"]
        return observations

    env._initialize_episode = initialize
    try:
        result = original(env, number, *args, **kwargs)
    finally:
        del env._initialize_episode
    metrics = {
        "success": env.wandb_log_data["goal_reached"],
        "spl": env.wandb_log_data["spl"],
        "distance_to_goal": env.path_calculator.geodesic_distance,
        "path_length": env.agent_distance_traveled,
        "geodesic_distance": episode["info"]["geodesic_distance"],
    }
    session.end(metrics)
    return result


# adapters in the agent's own encoder ------------------------------------------------------------


def _make_adapter_wrapper(folder, file, path):
    """Return a wrapper for the method ``forward`` of an encoder's class.

    At the first call of each instance, the wrapper attaches adapters to the module ``path``. The
    weights have been loaded before this call.
    """

    def forward(original, encoder, *args, **kwargs):
        if not vars(encoder).get("_mitigate_adapted"):
            _attach_adapters(encoder, folder, file, path)
            encoder._mitigate_adapted = True
        return original(encoder, *args, **kwargs)

    return forward


def _attach_adapters(encoder, folder, file, path):
    module = encoder
    for name in filter(None, path.split(".")):
        if _get(module, name) is None:
            children = ", ".join(n for n, _ in module.named_children()) or "none"
            stop(
                f"adapters= names {path} in {type(encoder).__name__}, but there is no {name}: its "
                f"modules there are {children}."
            )
        module = _get(module, name)
    spec = importlib.util.spec_from_file_location("mitigate_plain_adapters", file)
    plain_adapters = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(plain_adapters)
    half = any(str(p.dtype).endswith("16") for p in module.parameters())
    try:
        plain_adapters.attach(module, folder, check=not half)
    except (ValueError, OSError) as error:
        stop(f"the adapters do not fit {type(encoder).__name__}: {error}")
    Channel().ask("adapted", module=f"{type(encoder).__name__}.{path}")


# a loop without Habitat -------------------------------------------------------------------------


class Episode:
    """One episode of a program that runs its own loop and does not use Habitat.

    Attributes:
        instruction: The instruction for the agent, corrupted if the condition changes words.
    """

    def __init__(self, session, name, scene, instruction):
        self._session = session
        self._name = name
        self._thread = threading.get_ident()
        session.current = self
        answer = session.begin(scene, name, text=instruction, loop=True)
        self.instruction = answer.get("text", instruction)

    def corrupt(self, observations, heading=None, cameras=None):
        """Return a new dict of observations with corrupted frames.

        Args:
            observations: Arrays by name: ``rgb*`` (uint8) and ``depth*`` (float32, metres).
            heading: Radians, counter-clockwise.
            cameras: Descriptions of cameras that have other names, or whose depth is not in metres
                from 0 to 10: {name: {"type": "depth", "min_depth": 0.5, "max_depth": 5.0,
                "normalize_depth": True, "hfov": 79, "orientation": [0, 0.5, 0]}}.
        """
        self._check()
        if not self._session.active:
            stop(f"episode {self._name} is finished. connect() begins the next one.")
        if self._session.simulated:
            stop(
                "frames of habitat-sim are corrupted as its simulator returns them, and "
                "episode.corrupt() would corrupt them twice. Leave it out."
            )
        try:
            observations, described = _find_cameras(observations, cameras)
        except BaseException as error:  # the agent might catch the exception
            stop(f"an observation could not be read ({_describe_error(error)}).")
        self._session.steps += 1
        return self._session.corrupt(observations, described, heading)

    def finish(self, success, spl=None, stopped=None, **metrics):
        """Report the result of the episode.

        Args:
            success: 0 or 1.
            spl: 0 to 1. If None, it is computed from ``path_length`` and ``geodesic_distance`` or,
                without these, is equal to ``success``.
            stopped: Whether the agent called STOP, 0 or 1, or None if this is unknown. Some success
                rules cannot judge the episode without this value.
            **metrics: Other measures, such as ``distance_to_goal``.

        Raises:
            ValueError: If a value is outside its range.
        """
        self._check()
        report = dict(metrics, success=_check_flag(success, "success"))
        if stopped is not None:
            stopped = bool(_check_flag(stopped, "stopped"))
        if spl is not None:
            report["spl"] = _check_number(spl, "spl", 1)
            if report["spl"] and not report["success"]:
                raise ValueError(
                    f"finish(success={success!r}, spl={spl!r}): the SPL of a failed episode must "
                    "be 0. Leave spl out, or correct the success."
                )
        for name in ("path_length", "geodesic_distance", "distance_to_goal"):
            if metrics.get(name) is not None:
                report[name] = _check_number(metrics[name], name)
        self._session.end(report, OVER, stopped)

    def _check(self):
        if self._session.current is not self:
            stop(
                f"episode {self._name} ended when the next one began: a thread has one episode at "
                "a time. Run parallel episodes in threads or processes."
            )
        if self._session.episode_pid != os.getpid():
            stop(
                f"process {self._session.episode_pid} began episode {self._name}, and process "
                f"{os.getpid()} continues it. Call mitigate_hook.connect() in the process that "
                "runs the episode."
            )
        if self._thread != threading.get_ident():
            stop(
                f"another thread began episode {self._name}. Call mitigate_hook.connect() in the "
                "thread that runs the episode."
            )


def _check_flag(value, name):
    """Return 0.0 or 1.0. Raises ValueError for all other values."""
    number = _check_number(value, name, 1)
    if number not in (0.0, 1.0):
        raise ValueError(f"finish({name}={value!r}): it must be 1 (or True) or 0 (or False).")
    return number


def _check_number(value, name, most=math.inf):
    """Return ``value`` as a float; raise ValueError if it is not a number from 0 to ``most``."""
    try:
        number = float(value)  # float also accepts an array or tensor with one item
    except (TypeError, ValueError):
        number = math.nan
    if not 0 <= number <= most:
        kind = ">= 0" if most == math.inf else "from 0 to 1, not percent: 0.8"
        raise ValueError(f"finish({name}={value!r}): it must be a number {kind}.")
    return number


def _find_cameras(observations, cameras):
    """Return a copy of the observations and the description of each camera in them.

    If an entry has the shape of a frame but no known type, the process stops.
    """
    observations, cameras, described = dict(observations), dict(cameras or {}), []
    for name, value in observations.items():
        by_name = next((kind for kind in (COLOR, DEPTH) if str(name).startswith(kind)), None)
        camera = dict({"type": by_name}, **cameras.get(name, {}))
        unknown = sorted(set(map(str, camera)) - {"type", *CAMERA})
        if unknown:
            stop(
                f"the camera {name} has unknown options: {', '.join(unknown)}. The options of a "
                f"camera are type, {', '.join(CAMERA)}."
            )
        if camera["type"] in (COLOR, DEPTH):
            if not isinstance(name, str):
                stop(f"the name of a camera must be text, got {name!r}. Write {str(name)!r}.")
            if callable(_get(value, "items")):
                stop(
                    f"the camera {name} must be a numpy array. "
                    f"{_advise_cameras(name, value, camera['type'])}"
                )
            described.append(dict(camera, name=name))
        elif name in cameras and camera["type"] != "other":
            stop(
                f"the type of the entry {name} must be 'rgb', 'depth', or 'other' for what is to "
                f"stay as it is, got {camera['type']!r}."
            )
        elif name not in cameras:
            array = _find_frame(value, str(name))
            if array is not None:
                stop(
                    f"the entry {array[0]} of an observation may be a frame {array[1]}, and it is "
                    f"not described. {_advise_cameras(name, value, COLOR)}"
                )
    return observations, described


def _advise_cameras(name, value, kind):
    """Return how to describe the frames in an entry of an observation, as sentences."""
    if not callable(_get(value, "items")):
        return (
            f"Name it in cameras=, {{{str(name)!r}: {{'type': 'rgb'}}}} (or 'depth', for a "
            "separate array [H, W, channels]; 'other' leaves it as it is)."
        )
    inner = next((key for key, part in value.items() if _find_frame(part, "") is not None), "left")
    return (
        f"{name} is a dict. Pass it by itself: episode.corrupt(observation[{name!r}], "
        f"cameras={{{inner!r}: {{'type': {kind!r}}}}}). If it contains no frames that the agent "
        f"uses: cameras={{{name!r}: {{'type': 'other'}}}}."
    )


def _find_frame(value, name):
    """Return the name and shape of the first array that has the shape of a frame, else None.

    Nested dicts and lists are searched.
    """
    if value is None or isinstance(value, (str, bytes, int, float)):
        return None
    shape = _shape(value)
    if _may_be_frame(shape):
        return name, shape
    if callable(_get(value, "items")):
        parts = value.items()
    elif str(_get(value, "dtype", "")) == "object":
        parts = enumerate(value.ravel().tolist())
    else:
        parts = enumerate(value) if isinstance(value, (list, tuple)) else ()
    frames = (_find_frame(part, f"{name}.{key}") for key, part in parts)
    return next((frame for frame in frames if frame is not None), None)


def _may_be_frame(shape):
    """Return whether this is the shape of a frame: at least two dimensions are larger than 8."""
    return len(shape) > 1 and sorted(shape)[-2] > 8


def _shape(value):
    """Return the shape of an array, tensor or PIL image, or of nested lists."""
    outer = []
    while isinstance(value, (list, tuple)) and value:
        outer.append(len(value))
        value = value[0]
    inner = value.size if _get(value, "getbands") else _get(value, "shape")
    if inner is None:
        return tuple(outer) if isinstance(value, (int, float)) else ()
    try:
        return (*outer, *map(int, inner))
    except (TypeError, ValueError):  # this attribute is not the shape or size of an array
        return ()


def wanted(episodes):
    """Return the episodes that this run needs.

    Args:
        episodes: List of (scene, episode id).

    Returns:
        All episodes if ``episodes=`` is not set; otherwise about that number of episodes, chosen by
        a hash of their names.

    Raises:
        RuntimeError: If the program does not run under ``mitigate run``.
        ValueError: If an entry of ``episodes`` is not a pair.
    """
    _check_run()
    episodes = list(episodes)
    for episode in episodes:
        if not isinstance(episode, (tuple, list)) or len(episode) != 2:
            raise ValueError(
                "each episode of wanted() must be a pair, (scene, id), or ('', id) without "
                f"scenes, got {episode!r:.80}."
            )
    if not episodes:
        return []
    keep = _select(episodes, lambda episode: _episode_key(*episode), 0)
    return episodes if keep is None else [episodes[i] for i in keep]


def _episode_key(scene, episode):
    """Return the name of an episode: the file name of its scene, and its id."""
    return f"{str(scene).rpartition('/')[2]}/{episode}"


def _check_run():
    if ADDRESS not in os.environ:
        raise RuntimeError("Start this program under `mitigate run -- python ...`.")


def connect(episode, scene="", instruction=None):
    """Begin an episode under ``mitigate run`` and return its ``Episode``.

    Args:
        episode: Name of the episode, unique within the scene.
        scene: File name or path of the scene.
        instruction: Text for the agent.

    Raises:
        RuntimeError: If the program does not run under ``mitigate run``.
    """
    _check_run()
    if _thread.session is None:
        _thread.session = Session()
    return Episode(_thread.session, str(episode), scene, instruction)


# installing -------------------------------------------------------------------------------------

PATCHES = {  # maps a module to tuples (class, method, wrapper); the class is "" for a function
    "habitat.core.simulator": (("SensorSuite", "get_observations", _get_observations),),
    "habitat.core.embodied_task": (
        ("EmbodiedTask", "reset", _task_reset),
        ("Measurements", "update_measures", _update_measures),
    ),
    "habitat.core.env": (
        ("", "make_dataset", _make_dataset),
        ("Env", "__init__", _env_init),
        ("Env", "reset", _env_reset),
        ("Env", "step", _env_step),
        ("Env", "close", _env_close),
        ("Env", "render", _call_clean),
    ),
    "habitat_sim.simulator": (
        ("Simulator", "get_sensor_observations", _sensor_observations),
        ("Simulator", "get_sensor_observations_async_finish", _async_observations),
    ),
    "WMNav_env": (("Env", "_run_episode", _wmnav_episode),),
}
OWN_ENV = (
    "For an environment of your own, call connect, corrupt and finish of mitigate_hook "
    "(docs/bridge.md), and give it a name other than habitat."
)
OPTIONAL = ("get_sensor_observations_async_finish",)  # methods that some versions lack


def patch(module):
    """Wrap the methods of a module that was just imported."""
    _load_numpy()
    missing = []
    for owner, method, wrapper in PATCHES[module.__name__]:
        kind = _get(module, owner) if owner else module
        original = None if kind is None else _get(kind, method)
        if original is not None:
            setattr(kind, method, _wrap(original, wrapper))
        elif method not in OPTIONAL:
            missing.append((owner, method))
    if missing:
        stop(_describe_missing(module, missing))


def _describe_missing(module, missing):
    """Return the error message for methods of ``module`` that do not exist.

    ``missing`` is a list of pairs (class, method).
    """
    adapters = json.loads(os.environ.get(ADAPTERS) or "{}")
    if adapters.get("module") == module.__name__:
        classes = [n for n, kind in vars(module).items() if isinstance(kind, type)]
        encoders = ", ".join(n for n in classes if _get(vars(module)[n], "forward")) or "none"
        return (
            f"adapters= names the class {missing[0][0]} of {module.__name__}, but it has no such "
            f"class with a forward method; it has {encoders}. Write "
            "FOLDER:package.module:Class.attribute."
        )
    package = _package(module.__name__)
    wrapped = [f"{n} ({_join(PATCHES[n])})" for n in PATCHES if _package(n) == package]
    return (
        f"{module.__name__} has no {_join(missing)}. The bridge supports habitat-lab 0.1.5 to 0.3, "
        f"and wraps {', '.join(wrapped)}. {OWN_ENV}"
    )


def _join(methods):
    """Return the names of methods; each method is a tuple that begins with its class and name."""
    return ", ".join(f"{owner}.{name}" if owner else name for owner, name, *_ in methods)


def _wrap(original, wrapper):
    @functools.wraps(original)
    def method(*args, **kwargs):
        return wrapper(original, *args, **kwargs)

    return method


class Finder:
    """Import finder that calls ``patch`` for modules in ``PATCHES`` after they are executed."""

    def find_spec(self, name, path=None, target=None):
        if name not in PATCHES:
            return None
        spec = importlib.machinery.PathFinder.find_spec(name, path, target)
        if spec is not None and spec.loader is not None:
            run = spec.loader.exec_module

            def exec_module(module):
                run(module)
                patch(module)

            spec.loader.exec_module = exec_module
        return spec


def install():
    """Wrap modules that this process imports from now on; do nothing outside ``mitigate run``."""
    if ADDRESS not in os.environ or any(isinstance(f, Finder) for f in sys.meta_path):
        return
    if os.path.exists(os.environ[ADDRESS]):
        # the folder belongs to a different user; the connection reports this later
        with contextlib.suppress(OSError):
            folder = os.path.dirname(os.environ[ADDRESS])
            open(os.path.join(folder, LOADED), "a").close()
    if os.environ.get(ADAPTERS):
        adapters = json.loads(os.environ[ADAPTERS])
        wrapper = _make_adapter_wrapper(adapters["folder"], adapters["file"], adapters["path"])
        PATCHES[adapters["module"]] = ((adapters["class"], "forward", wrapper),)
    sys.meta_path.insert(0, Finder())


def run_hidden_sitecustomize(file):
    """Run the ``sitecustomize`` module that ``file`` shadows, if there is one."""
    folder = os.path.dirname(os.path.abspath(file))
    path = [p for p in sys.path if os.path.abspath(p or os.curdir) != folder]
    spec = importlib.machinery.PathFinder.find_spec("sitecustomize", path)
    if spec is not None and spec.loader is not None:
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
