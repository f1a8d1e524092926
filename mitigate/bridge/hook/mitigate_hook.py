"""The agent's side of the bridge: corrupts what an unchanged program sees, in its own process.

``mitigate run -- COMMAND`` puts this folder in front of PYTHONPATH, so that every Python process of
the command loads this file (``sitecustomize.py``), however it was started. Where one imports
habitat-lab (0.1.5 to 0.3), habitat-sim alone or WMNav, a few of their methods are wrapped: frames
go to the server through memory that both map, instructions through a socket, and come back
corrupted. A loop that is not Habitat's calls ``connect``, ``corrupt`` and ``finish`` itself:

    import mitigate_hook
    episode = mitigate_hook.connect("17", scene="x.glb", instruction="Go to the door.")
    hear(episode.instruction)
    act_on(episode.corrupt({"rgb": rgb, "depth": depth}))  # at each step
    episode.finish(success=True, spl=0.8)

One file for Python 3.6 to 3.13 that needs the standard library and numpy only. If the server
refuses, dies or is late, the process ends with one paragraph: no agent walks on with clean frames.
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

np = None  # numpy, once it is needed: every Python process loads this file, and some have none
PROTOCOL = 3
ADDRESS, TOKEN, PATIENCE = "MITIGATE_BRIDGE", "MITIGATE_TOKEN", "MITIGATE_PATIENCE"
ADAPTERS = "MITIGATE_ADAPTERS"  # JSON: folder, file of plain_adapters.py, module, class, path
HEADER = struct.Struct("!4sI")  # magic, bytes of the JSON object that follows
MAGIC = b"mtg1"
LARGEST = 1 << 24  # bytes of a message: an episode with all view points of its goals has 1e6
PIECE = 10000  # names of episodes in a message: train splits have millions
LOADED = "loaded"  # a file beside the socket, once a process has loaded this file
LONGEST = 4000  # characters of why a process was stopped
STATUS = 97  # what a process that was stopped exits with
FAREWELL = 3.0  # seconds at most in which a process that stops tells the server why (ours)
COLOR, DEPTH = "rgb", "depth"  # kinds of camera
# how an episode ends: it was over; its Env was reset, or closed, before; behind an exception
OVER, RESET, CLOSE, BROKEN = "over", "reset", "close", "broken"
ORDERLY = (StopIteration, StopAsyncIteration, GeneratorExit)  # how loops end, no fault of a program


class _Thread(threading.local):
    walk = None  # of connect


_thread = _Thread()
# by id, corrupted frames that the program still holds
_given: "weakref.WeakValueDictionary[int, object]" = weakref.WeakValueDictionary()


# messages ---------------------------------------------------------------------------------------


def send(channel, message):
    """Send a dict of plain data; numbers and arrays of numpy go as Python's. Raises ValueError if
    it is too large, TypeError for what is no data."""
    body = json.dumps(message, default=_as_python).encode("utf-8")
    if len(body) > LARGEST:
        raise ValueError(f"a message of {len(body)} bytes is more than {LARGEST}")
    channel.sendall(HEADER.pack(MAGIC, len(body)) + body)


def _as_python(value):
    if isinstance(value, (np.generic, np.ndarray)):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} is no plain data")


def receive(channel):
    """Return the next message, None at the end. Raises ValueError for what is no message."""
    head = _read(channel, HEADER.size)
    if head is None:
        return None
    magic, size = HEADER.unpack(head)
    if magic != MAGIC or size > LARGEST:
        raise ValueError("the other side does not speak this protocol")
    body = _read(channel, size)
    if body is None:
        return None
    message = json.loads(body.decode("utf-8"))
    if not isinstance(message, dict):
        raise ValueError("a message is no JSON object")
    return message


def _read(channel, size):
    parts, left = [], size
    while left:
        part = channel.recv(min(left, 1 << 16))
        if not part:
            return None
        parts.append(part)
        left -= len(part)
    return b"".join(parts)


def stop(problem, told=False):
    """End this process at once, with one paragraph: an exception might be caught. The server is
    told why, if it does not know, so that the condition does not count as done. Nothing that goes
    wrong here, nor an interrupt, lets the process go on."""
    try:
        try:
            if not told:
                _tell(str(problem)[:LONGEST])
        finally:
            text = (
                f"\nmitigate: {problem} This process ({os.getpid()}) ends here, as it would go on "
                "with frames that are not corrupted. What was measured so far is kept; see "
                "`mitigate run`'s own output.\n"
            )
            if sys.__stderr__ is not None:  # without one, 2 may be any file; sys.stderr may be none
                os.write(2, text.encode("utf-8", "replace"))
    finally:
        os._exit(STATUS)


def _tell(problem):
    """Tell the server why this process ends, by a connection of its own, if it can be reached."""
    with contextlib.suppress(BaseException):  # whatever it is, this process ends
        hello = {"kind": "hello", "protocol": PROTOCOL, "token": os.environ.get(TOKEN, "")}
        hello.update(pid=os.getpid(), python=sys.version.split()[0])
        channel = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        channel.settimeout(min(FAREWELL, float(os.environ.get(PATIENCE, "25"))))
        channel.connect(os.environ[ADDRESS])
        send(channel, hello)
        if receive(channel) == {}:
            send(channel, {"kind": "stopped", "problem": problem})
            receive(channel)


class Channel:
    """A connection to the server, of one environment. All of its failures end in ``stop``."""

    def __init__(self):
        _load_numpy()
        self.pid, self.memory, self.layout = os.getpid(), None, {}
        self.number = 0  # of the last message: its answer repeats it
        self.patience = float(os.environ.get(PATIENCE, "25"))
        try:
            self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
            self.socket.settimeout(self.patience)
            self.socket.connect(os.environ[ADDRESS])
        except BaseException as error:  # an interrupt, too: the agent might catch it
            stop(
                f"the server of `mitigate run` cannot be reached at "
                f"{os.environ.get(ADDRESS)} ({_named(error)}); a container needs the host's "
                "temporary folder (docker: -v /tmp:/tmp)."
            )
        self.ask("hello", protocol=PROTOCOL, token=os.environ.get(TOKEN, ""), **_versions())

    def ask(self, kind, **fields):
        """Send a message and return the answer. One that was interrupted is the last: its answer
        would be taken for that of the next."""
        self.number += 1
        number = self.number
        fields.update(kind=kind, number=number)
        try:
            send(self.socket, fields)
            answer = receive(self.socket)
        except socket.timeout:  # no TimeoutError before Python 3.10
            stop(f"the server did not answer within {self.patience:g} s.")
        except TypeError as error:  # of json, before anything was sent
            stop(f"what is told of {kind} cannot be sent ({error}): give numbers, words and lists.")
        except BaseException as error:  # whatever it is, the agent might catch it
            stop(f"the connection to the server broke ({_named(error)}).")
        if answer is None:
            stop("the server of `mitigate run` is gone.")
        if "error" in answer:
            stop(answer["error"], told=True)
        if answer.pop("number", None) != number:
            stop("the answer of the server is that to another message.")
        return answer

    def agree(self, cameras):
        """Tell the server what the cameras are, and map the memory that it gives."""
        answer = self.ask("spec", cameras=cameras)
        self.layout = {name: int(at) for name, at in answer["offsets"].items()}
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
                f"the memory for frames, {answer['file']}, cannot be mapped ({_named(error)}); a "
                "container needs the host's /dev/shm (docker: --ipc=host -v /dev/shm:/dev/shm)."
            )

    def place(self, camera):
        """Return the array in the mapped memory where the frame of a camera lies."""
        count, at = int(np.prod(camera["shape"])), self.layout[camera["name"]]
        return np.frombuffer(self.memory, camera["dtype"], count, at).reshape(camera["shape"])


def _named(error):
    """Return an exception with its kind."""
    return f"{type(error).__name__}: {error}"


def _is_orderly(error):
    """Whether an exception only says that a loop, or the program without a fault, is at its end."""
    ended = isinstance(error, SystemExit) and error.code in (None, 0)
    return ended or isinstance(error, ORDERLY)


def _placed(error):
    """Return an exception with its kind, and the file and line that raised it."""
    at = error.__traceback__
    while at is not None and at.tb_next is not None:
        at = at.tb_next
    where = "" if at is None else f" ({at.tb_frame.f_code.co_filename}:{at.tb_lineno})"
    return f"{_named(error)[:LONGEST]}{where}"


def _get(owner, name, default=None):
    """Return an attribute of an object of another project, whose versions differ: ``default`` if
    it has none."""
    return getattr(owner, name, default)  # what it may lack is known by its name only


def _load_numpy():
    global np
    import numpy as np


def _versions():
    names = ("habitat", "habitat_sim", "torch")
    found = {n: str(_get(sys.modules.get(n), "__version__", "")) for n in names}
    return {"pid": os.getpid(), "python": sys.version.split()[0], "numpy": np.__version__, **found}


# one environment --------------------------------------------------------------------------------


def _whole(what):
    """Wrap a method of ``Walk``: one thread at a time is in it, and whatever breaks it off, an
    interrupt too, ends the process, as the agent might catch it and act on what it was given.
    ``what``: did not take place then."""

    def wrap(method):
        @functools.wraps(method)
        def whole(walk, *args, **kwargs):
            walk.at_home()
            with walk.lock:
                if walk.busy:
                    stop(f"{what}: it was begun within another call of the same environment.")
                try:
                    walk.busy = True
                    result = method(walk, *args, **kwargs)
                    walk.busy = False
                    return result
                except BaseException as error:
                    stop(f"{what} ({_named(error)}).")

        return whole

    return wrap


class Walk:
    """One environment: its connection, the episode that is on and how it goes."""

    def __init__(self):
        self.channel = None
        self.cameras = None  # what the server was told of them
        self.sim = self.task = self.episode = None
        self.begun = self.busy = False
        self.handled = id(None)  # of the exception that was handled as the episode began
        self.farthest = {}  # by camera of depth: the most that the first frame reads
        self.simulated = False  # whether frames of habitat-sim alone came in this episode
        self.pid = None  # of the process in which the episode that is on was begun
        self.home, self.lock = os.getpid(), threading.RLock()
        self.current = None  # of connect: the episode that is on
        self.words = None  # of the episode that is on, where others are heard in their place
        self.clear()

    def clear(self):
        """Forget how the last episode went."""
        self.calls = self.steps = 0
        self.path, self.actions, self.start, self.farthest = [], [], None, {}

    def at_home(self):
        """In a forked process, take a lock of its own: a thread that is not here may hold it."""
        if self.home != os.getpid():
            self.home, self.lock, self.busy = os.getpid(), threading.RLock(), False

    def leave(self):
        """Close the connection; frames that come all the same open another one."""
        self.at_home()
        with self.lock:
            if self.channel is not None:
                self.channel.socket.close()
            self.channel = self.cameras = self.sim = self.task = self.episode = None

    def connected(self):
        """Return the channel; a forked process opens one of its own."""
        if self.channel is None or self.channel.pid != os.getpid():
            self.channel, self.cameras = Channel(), None
        return self.channel

    @_whole("an episode could not be begun")
    def begin(self, scene, name, **said):
        """Begin an episode; the answer holds its words as the agent is to hear them."""
        self.clear()
        self.pid, self.simulated, self.handled = os.getpid(), False, id(sys.exc_info()[1])
        answer = self.connected().ask("episode", scene=str(scene), id=str(name), **said)
        self.begun = True
        return answer

    @_whole("a frame could not be corrupted")
    def corrupt(self, observations, cameras, heading=None):
        """Replace the frames of ``cameras`` in a dict of observations, in its order.

        ``cameras``: dicts with name, type ("rgb" or "depth") and what else the server is to know
        of them (``_of_config``).
        """
        self._check(observations, cameras)
        channel = self.connected()
        heading = None if heading is None else float(heading)
        told = [dict(_data(c), **_array(observations[c["name"]], c["name"])) for c in cameras]
        if told != self.cameras:
            channel.agree(told)
            self.cameras = told
        for camera in told:
            if camera["name"] in channel.layout:
                frame = observations[camera["name"]]
                channel.place(camera)[...] = frame[..., :3] if camera["alpha"] else frame
        seen = {}
        for name in (camera["name"] for camera in told if camera["type"] == DEPTH):
            if self.farthest.get(name) is None:  # whether depth is what it is said to be
                seen[name], self.farthest[name] = _middle(observations[name])
        where = {"heading": heading, "position": self.position()}
        answer = channel.ask("frame", call=self.calls, depth=seen, **where)
        self.calls += 1
        for camera in told:
            if camera["name"] in answer["changed"]:
                before = observations[camera["name"]]
                frame = np.empty(before.shape, before.dtype)  # owned, writable, contiguous
                if camera["alpha"]:
                    frame[..., 3], frame[..., :3] = before[..., 3], channel.place(camera)
                else:
                    frame[...] = channel.place(camera)
                observations[camera["name"]] = _given[id(frame)] = frame
        return observations

    def _check(self, observations, cameras):
        """Stop where frames would be of no episode, and where one was corrupted before."""
        if self.pid not in (None, os.getpid()):
            stop(
                f"the episode that is on was begun in process {self.pid}, and its fork "
                f"{os.getpid()} walks on, whose frames would be of no episode: reset the "
                "environment in the process that walks, or start workers before the first reset."
            )
        for camera in cameras:
            if _is_given(observations[camera["name"]]):
                stop(
                    f"the frame {camera['name']} was corrupted before, and would be twice: give "
                    "each frame once, as the camera took it (of habitat-lab and habitat-sim they "
                    "are corrupted as they are taken: a loop calls connect and finish only)."
                )

    def position(self):
        """Return where the agent is, [x, y, z], None if nobody knows."""
        state = None if self.sim is None else self.sim.get_agent_state()
        return None if state is None else [float(x) for x in state.position]

    def moved(self, action=None):
        """Count a low-level step, and note what it was and where it led."""
        self.steps += 1
        if sys.exc_info()[1] is None:
            self.handled = id(None)
        self.actions.append(_action(action))
        here = self.position()
        if here is not None and (not self.path or here != self.path[-1]):
            self.path.append(here)

    @_whole("how an episode went could not be told")
    def end(self, metrics, how=OVER, stopped=None):
        """Tell how the episode went, once; one without a step did not take place, and a forked
        process does not end that of its parent. One that was not over and is left as an exception
        goes by, since it began, tells of the program's fault, not of the agent's."""
        if not self.begun or self.pid != os.getpid():
            return
        self.begun = False
        fault = None if how == OVER else self._fault()
        if fault is not None:
            how = BROKEN
        if self.steps or self.sim is None:
            said = {"metrics": _numbers(metrics), "steps": self.steps, "calls": self.calls}
            said.update({} if fault is None else {"fault": _placed(fault)})
            said.update(how=how, stopped=stopped, farthest=self.farthest)
            said.update(path=self.path, actions=self.actions, **self._distances())
            self.channel.ask("end", **said)

    def _fault(self):
        """Return the exception that goes by, or is handled, since the episode began, and is no
        orderly end of a loop or of the program; None if there is none."""
        error = sys.exc_info()[1]
        while error is not None and _is_orderly(error) and id(error) != self.handled:
            error = error.__context__
        return None if id(error) == self.handled else error

    def _distances(self):
        """Geodesic metres to the goals from the start and from here, and whether it said STOP."""
        if self.sim is None or self.episode is None:
            return {}
        stopped = _get(self.task, "is_stop_called")
        return {
            "start_distance": self.start,
            "distance": _distance(self.sim, self.path[-1] if self.path else None, self.episode),
            "stopped": None if stopped is None else bool(stopped),
        }


def _is_given(frame):
    """Whether an array is, or is a part of, a corrupted one that the program was given."""
    while isinstance(frame, np.ndarray) and isinstance(frame.base, np.ndarray):
        frame = frame.base
    return _given.get(id(frame)) is frame


def _action(action):
    """Return an action as Habitat gets it (a number, a name, or a dict of one) as plain data."""
    if isinstance(action, dict):
        action = action.get("action")
    if action is None:
        return None
    return int(action) if isinstance(action, (int, np.integer)) else str(action)


def _array(frame, name):
    """Return what the server must know of a frame."""
    if not isinstance(frame, np.ndarray):
        stop(
            f"the camera {name} gives a {type(frame).__name__}, and only numpy arrays can be "
            "corrupted: set Habitat's GPU_GPU (gpu_gpu) to False, or pass numpy arrays (of a "
            "tensor: .cpu().numpy()). An entry that is no frame: cameras={name: {'type': 'other'}}."
        )
    alpha = frame.dtype == np.uint8 and frame.ndim == 3 and frame.shape[-1] == 4
    shape = [*frame.shape[:-1], 3] if alpha else list(frame.shape)
    return {"shape": shape, "dtype": frame.dtype.name, "alpha": alpha}


def _data(told):
    """Return what is told of a camera with lists and numbers in place of numpy's: arrays that are
    made anew at each step cannot be compared."""
    if isinstance(told, dict):
        return {name: _data(value) for name, value in told.items()}
    if isinstance(told, (list, tuple)):
        return [_data(value) for value in told]
    return _as_python(told) if isinstance(told, (np.generic, np.ndarray)) else told


def _middle(depth):
    """Return the median and the most of what a depth frame reads, holes left out; None if all
    are."""
    some = np.asarray(depth[::4, ::4], np.float64)
    some = some[np.isfinite(some) & (some > 0)]
    return (float(np.median(some)), float(some.max())) if some.size else (None, None)


def _numbers(metrics, prefix=""):
    """Return the finite numbers of nested dicts, by dotted name; the distance to a goal out of
    reach, a failure by every rule, is infinite."""
    found = {}
    for name, value in dict(metrics or {}).items():
        if isinstance(value, dict):
            found.update(_numbers(value, f"{prefix}{name}."))
            continue
        known = isinstance(value, (bool, int, float, np.bool_, np.integer, np.floating))
        if _get(value, "shape") == () and _get(value, "item"):  # an array, a tensor
            value = value.item()
            known = isinstance(value, (bool, int, float))
        far = prefix + str(name) == "distance_to_goal" and known and float(value) == math.inf
        if far or (known and math.isfinite(float(value))):
            found[prefix + str(name)] = float(value)
    return found


def _distance(sim, position, episode):
    """Return the geodesic metres to the nearest goal, or place to see it from, infinite out of
    reach; None if unknown."""
    goals = _get(episode, "goals") or []
    views = [p.agent_state.position for g in goals for p in _get(g, "view_points") or []]
    ends = [list(map(float, end)) for end in views or [g.position for g in goals]]
    if not ends or position is None:
        return None
    return float(sim.geodesic_distance(position, ends))


# habitat-lab ------------------------------------------------------------------------------------


CAMERA = ("hfov", "min_depth", "max_depth", "normalize_depth", "position", "orientation")
_described = {}  # id of a sensor: (it, what the server must know); a config's options are slow


def _of_config(sensor):
    """Return what the server must know of a lab sensor; names are upper case before 0.2.3."""
    if id(sensor) in _described:
        return _described[id(sensor)][1]
    config, known = _get(sensor, "config"), {}
    for option in CAMERA:
        value = _get(config, option, _get(config, option.upper()))
        if isinstance(value, (bool, int, float)) or value is None:
            known[option] = value
        else:
            known[option] = [float(x) for x in value]
    kind = str(_get(sensor, "sensor_type", "")).rpartition(".")[2].lower()
    known.update(name=sensor.uuid, type=COLOR if kind == "color" else kind)
    _described[id(sensor)] = (sensor, known)
    return known


def _heading(state):
    """Return the agent's heading in radians, counter-clockwise, of its quaternion."""
    rotation = state.rotation
    if _get(rotation, "imag") is not None:  # numpy-quaternion
        return 2 * math.atan2(float(rotation.imag[1]), float(rotation.real))
    x, y, z, w = rotation
    return 2 * math.atan2(float(y), float(w))


_walks = {}  # id of a simulator's sensor suite, or of a simulator: (it, its walk)


def _walk_of(owner):
    """Return the walk of a sensor suite or simulator."""
    if id(owner) not in _walks:  # keeps it, so that no other gets its id
        _walks.setdefault(id(owner), (owner, Walk()))  # threads get one
    return _walks[id(owner)][1]


def _unseen(original, *args, **kwargs):
    """Call what takes frames that are not what the agent acts on: goal pictures, videos."""
    return original(*args, **kwargs)


def _is_unseen():
    """Whether this thread is within ``_unseen``: by its frames, which no interrupt leaves behind as
    it might a flag."""
    frame = sys._getframe(1)
    while frame is not None and frame.f_code is not _unseen.__code__:
        frame = frame.f_back
    return frame is not None


def _get_observations(original, suite, *args, **kwargs):
    """``SensorSuite.get_observations``: of the simulator, or of the task (episode and task given,
    as the lab does), whose sensors may render a goal picture."""
    if "task" in kwargs or "episode" in kwargs:
        return _unseen(original, suite, *args, **kwargs)
    observations = original(suite, *args, **kwargs)
    cameras = [_of_config(s) for s in suite.sensors.values() if s.uuid in observations]
    cameras = [camera for camera in cameras if camera["type"] in (COLOR, DEPTH)]
    if _is_unseen() or not cameras:
        return observations
    walk = _walk_of(suite)
    heading = None if walk.sim is None else _heading(walk.sim.get_agent_state())
    return walk.corrupt(observations, cameras, heading)


def _task_reset(original, task, episode, *args, **kwargs):
    """``EmbodiedTask.reset``: the last episode is over, and the words of the next are corrupted."""
    sim = task._sim
    if _get(_get(sim, "config"), "enable_batch_renderer"):
        stop("frames of Habitat's batch renderer pass no sensor: set enable_batch_renderer=False.")
    walk = _walk_of(sim.sensor_suite)
    walk.end(task.measurements.get_metrics() if walk.begun else None, RESET)
    _put_back(walk)
    walk.sim, walk.task, walk.episode = sim, task, episode
    words = _get(episode, "instruction")
    text, tokens = _own(words)
    said = {
        "text": text,
        "tokens": _plain(tokens),
        "language": _get(words, "language"),
        "category": _get(episode, "object_category"),
    }
    answer = walk.begin(episode.scene_id, episode.episode_id, **said)
    if words is not None and answer.get("text") is not None:
        words._mitigate_own = (answer["text"], text, tokens)
        walk.words = words
        _say(words, answer["text"], answer["tokens"])
    observations = original(task, episode, *args, **kwargs)
    walk.start = _distance(sim, walk.position(), episode)
    walk.path = [place for place in [walk.position()] if place is not None]
    return observations


def _own(words):
    """Return text and tokens of an episode's words as the data set has them, though a walk may have
    put others in their place, and the program changed these: they are not corrupted again. Copies
    and pickles of words that are on know their own, too, by the text that is heard."""
    text = _get(words, "instruction_text")
    heard, *own = _get(words, "_mitigate_own", (None, None, None))
    known = heard is not None and (heard == text or _is_on(words))
    return own if known else (text, _get(words, "instruction_tokens"))


def _is_on(words):
    """Whether a walk is in the episode with these words."""
    return any(walk.words is words for _, walk in list(_walks.values()))


def _say(words, text, tokens):
    words.instruction_text = text
    if _get(words, "instruction_tokens") is not None:
        words.instruction_tokens = tokens


def _put_back(walk):
    """Let the words of a walk's episode be as they were, whatever the program made of them, unless
    another walk is in it."""
    words, walk.words = walk.words, None
    if words is None or _is_on(words):
        return
    own = vars(words).pop("_mitigate_own", None)  # once: threads may leave one episode together
    if own is not None:
        _say(words, *own[1:])


def _plain(tokens):
    return None if tokens is None else [t if isinstance(t, str) else int(t) for t in tokens]


def _update_measures(original, measurements, *args, **kwargs):
    """``Measurements.update_measures`` is called once for each low-level step."""
    result = original(measurements, *args, **kwargs)
    sim = _get(kwargs.get("task"), "_sim")
    if sim is not None:
        _walk_of(sim.sensor_suite).moved(kwargs.get("action"))
    return result


def _env_init(original, env, config, dataset=None, *args, **kwargs):
    """``Env.__init__``: of a dataset that it is given, some episodes may be left out."""
    return original(env, config, _some(dataset), *args, **kwargs)


def _make_dataset(original, *args, **kwargs):
    """The dataset that ``Env.__init__`` makes where it is given none."""
    return _some(original(*args, **kwargs))


def _some(dataset):
    """Leave out episodes that the server does not ask for."""
    if dataset is not None and len(dataset.episodes):
        keep = _chosen(dataset.episodes, lambda e: _key(e.scene_id, e.episode_id), 1)
        if keep is not None:
            dataset.episodes = [dataset.episodes[i] for i in keep]
    return dataset


def _chosen(episodes, key, least):
    """Return the numbers of the episodes that the server asks for, ``least`` so many; None: of
    all. Their keys are told in pieces, if it chooses at all."""
    channel, count = Channel(), len(episodes)
    answer = channel.ask("dataset", count=count, keys=[], least=least)
    for at in range(0, count, PIECE):
        if "keep" not in answer:
            keys = [key(episode) for episode in episodes[at : at + PIECE]]
            answer = channel.ask("dataset", count=count, keys=keys, least=least)
    return answer["keep"]


def _env_reset(original, env, *args, **kwargs):
    """``Env.reset`` loads the next scene, so the last episode is measured before."""
    _end(env, RESET)
    return original(env, *args, **kwargs)


def _env_step(original, env, *args, **kwargs):
    observations = original(env, *args, **kwargs)
    if env.episode_over:
        _end(env, OVER)
    return observations


def _env_close(original, env, *args, **kwargs):
    """``Env.close``: an Env for each episode leaves no simulator or connection behind."""
    _end(env, CLOSE)
    suite = _get(env.sim, "sensor_suite")
    try:
        return original(env, *args, **kwargs)
    finally:
        _release(suite)


def _release(suite):
    """Forget a sensor suite, its walk and its connection."""
    if suite is not None:
        _, walk = _walks.pop(id(suite), (None, None))
        for sensor in suite.sensors.values():
            _described.pop(id(sensor), None)
        if walk is not None:
            _put_back(walk)
            walk.leave()


def _end(env, how):
    suite = _get(env.sim, "sensor_suite")
    walk = None if suite is None else _walk_of(suite)
    if walk is not None and walk.begun:
        walk.end(env.get_metrics(), how)


def _env_render(original, env, *args, **kwargs):
    return _unseen(original, env, *args, **kwargs)


# habitat-sim without the lab --------------------------------------------------------------------


def _sensor_observations(original, sim, *args, **kwargs):
    """``Simulator.get_sensor_observations``."""
    observations = _unseen(original, sim, *args, **kwargs)  # some call themselves for each agent
    if _is_unseen() or _is_labs(sim):
        return observations
    return _of_agents(sim, observations, args[0] if args else kwargs.get("agent_ids"))


def _async_observations(original, sim, *args, **kwargs):
    """``Simulator.get_sensor_observations_async_finish``, where habitat-sim has it."""
    wanted = _get(sim, "_async_draw_agent_ids")  # the call forgets them
    observations = _unseen(original, sim, *args, **kwargs)
    if _is_unseen() or _is_labs(sim):
        return observations
    return _of_agents(sim, observations, wanted)


def _is_labs(sim):
    """Whether habitat-lab takes the frames, whose sensors they pass: a module of its own, or a
    method of its simulator, overridden or not. Anyone else gets none of the lab's simulators."""
    frame, own = sys._getframe(1), (_package(__name__), "habitat_sim")
    while frame is not None and _package(frame.f_globals.get("__name__")) in own:
        frame = frame.f_back
    if frame is None or _package(frame.f_globals.get("__name__")) == "habitat":
        return frame is not None
    if _get(sim, "sensor_suite") is None:
        return False
    labs = [kind for kind in type(sim).__mro__ if _package(kind.__module__) == "habitat"]
    name = frame.f_code.co_name
    if frame.f_locals.get("self") is sim and any(name in vars(kind) for kind in labs):
        return True
    stop(
        f"{frame.f_code.co_filename}:{frame.f_lineno} takes frames from habitat-lab's simulator by "
        "get_sensor_observations itself, which pass by its sensors and would be clean: take them "
        "by env.step, env.sim.get_observations_at(...), or env.render for what the agent does not "
        "see."
    )


def _package(module):
    return str(module).partition(".")[0]


def _of_agents(sim, observations, wanted):
    """Corrupt what the acting agent sees, in observations of several agents, by number, or of the
    ``wanted`` one (None: the acting one). The others are no eyes of the agent."""
    agent = _default_agent(sim)
    if observations and all(isinstance(seen, dict) for seen in observations.values()):
        if agent in observations:
            observations[agent] = _of_agent(sim, observations[agent])
        return observations
    one = wanted[0] if isinstance(wanted, (list, tuple)) else wanted
    return _of_agent(sim, observations) if one is None or one == agent else observations


def _of_agent(sim, observations):
    walk = _thread.walk
    if walk is None or walk.pid != os.getpid():
        stop(
            "habitat-sim is used here without habitat-lab, and nobody said in this thread of this "
            "process which episode it is: call mitigate_hook.connect(episode, scene=...) before "
            "its first frame."
        )
    walk.simulated = True
    cameras = [c for c in _of_specifications(sim) if c["name"] in observations]
    return walk.corrupt(
        observations, cameras, _heading(sim.get_agent(_default_agent(sim)).get_state())
    )


def _default_agent(sim):
    return _get(sim, "_default_agent_id", 0)


def _of_specifications(sim):
    """Return what the server must know of the cameras of habitat-sim's default agent."""
    found = []
    for spec in sim.config.agents[_default_agent(sim)].sensor_specifications:
        kind = str(spec.sensor_type).rpartition(".")[2].lower()
        if kind in ("color", "depth"):
            camera = {"name": spec.uuid, "type": COLOR if kind == "color" else DEPTH}
            camera.update(hfov=float(_get(spec, "hfov", 90)), normalize_depth=False)
            camera["position"] = [float(x) for x in spec.position]
            camera["orientation"] = [float(x) for x in spec.orientation]
            found.append(camera)
    return found


# WMNav ------------------------------------------------------------------------------------------


def _wmnav_episode(original, env, number, *args, **kwargs):
    """``Env._run_episode`` of WMNav, which has no lab: its simulators last for an episode each."""
    _thread.walk = walk = _thread.walk or Walk()
    told = env.all_episodes[number]
    words = told["object_category"]
    answer = walk.begin(told["scene_id"], told["episode_id"], text=words, category=words, loop=True)
    begin = env._initialize_episode

    def initialize(*numbers):
        observations = begin(*numbers)
        env.current_episode["object"] = answer.get("text") or env.current_episode["object"]
        return observations

    env._initialize_episode = initialize
    try:
        result = original(env, number, *args, **kwargs)
    finally:
        del env._initialize_episode
    said = {"success": env.wandb_log_data["goal_reached"], "spl": env.wandb_log_data["spl"]}
    said["distance_to_goal"] = env.path_calculator.geodesic_distance
    said["path_length"] = env.agent_distance_traveled
    said["geodesic_distance"] = told["info"]["geodesic_distance"]
    walk.end(said)
    return result


# adapters in the agent's own encoder ------------------------------------------------------------


def _adapted(folder, file, path):
    """Return what wraps the ``forward`` of an encoder's class: at an instance's first call, by when
    its weights are loaded, adapters go into its module ``path``."""

    def forward(original, encoder, *args, **kwargs):
        if not vars(encoder).get("_mitigate_adapted"):
            _adapt(encoder, folder, file, path)
            encoder._mitigate_adapted = True
        return original(encoder, *args, **kwargs)

    return forward


def _adapt(encoder, folder, file, path):
    owner, module = None, encoder
    for name in filter(None, path.split(".")):
        inner = _get(module, name)
        if inner is None:
            there = ", ".join(n for n, _ in module.named_children()) or "none"
            stop(
                f"adapters= names {path} in {type(encoder).__name__}, but there is no {name}: its "
                f"modules there are {there}."
            )
        owner, module = (module, name), inner
    spec = importlib.util.spec_from_file_location("mitigate_plain_adapters", file)
    plain_adapters = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(plain_adapters)
    half = any(str(p.dtype).endswith("16") for p in module.parameters())
    try:
        made = plain_adapters.attach(module, folder, check=not half)
    except (ValueError, OSError) as error:
        stop(f"the adapters do not fit {type(encoder).__name__}: {error}")
    if made is not module:  # around TorchScript, which takes no hooks
        if owner is None:
            stop(
                f"{type(encoder).__name__} itself is TorchScript, which takes no adapters in "
                "place: let adapters= name the attribute that holds it, "
                "FOLDER:module:Class.attribute."
            )
        try:
            setattr(*owner, made)
        except RuntimeError as error:
            stop(
                f"adapters= names {path} in {type(encoder).__name__}, which is TorchScript within "
                f"TorchScript, where nothing can be put around it ({error}). Name the module that "
                "holds all of it, and train adapters for that one."
            )
    Channel().ask("adapted", module=f"{type(encoder).__name__}.{path}")


# a loop of one's own ----------------------------------------------------------------------------


class Episode:
    """One episode of a loop that is not Habitat's; ``instruction`` is what the agent is told."""

    def __init__(self, walk, name, scene, instruction):
        self._walk, self._name, self._thread = walk, name, threading.get_ident()
        walk.current = self
        answer = walk.begin(scene, name, text=instruction, loop=True)
        self.instruction = answer.get("text", instruction)

    def corrupt(self, observations, heading=None, cameras=None):
        """Return a new dict with the frames of ``rgb*`` (uint8) and ``depth*`` (float32 metres)
        corrupted. cameras: {name: {"type": "depth", "min_depth": 0.5, "max_depth": 5.0,
        "normalize_depth": True, "hfov": 79, "orientation": [0, 0.5, 0]}} for other names and for
        depth that is not metres from 0 to 10; heading: radians, counter-clockwise."""
        self._check()
        if not self._walk.begun:
            stop(f"episode {self._name} was finished: connect() begins the next one.")
        if self._walk.simulated:
            stop(
                "frames of habitat-sim are corrupted as its simulator gives them, and "
                "episode.corrupt() would do so again: of such a loop leave it out, and call "
                "connect() and finish() only."
            )
        try:
            observations, listed = _described_frames(observations, cameras)
        except BaseException as error:  # the agent might catch it
            stop(f"an observation could not be read ({_named(error)}).")
        self._walk.steps += 1
        return self._walk.corrupt(observations, listed, heading)

    def finish(self, success, spl=None, stopped=None, **metrics):
        """Tell how it went: ``success`` (0 or 1), ``spl`` (0 to 1; None: by ``path_length`` and
        ``geodesic_distance``, or else as the success), whether the agent ``stopped`` by itself (0
        or 1, None: unknown; rules ask for it), ``distance_to_goal`` ... Raises ValueError for what
        is none."""
        self._check()
        told = dict(metrics, success=_truth(success, "success"))
        if stopped is not None:
            stopped = bool(_truth(stopped, "stopped"))
        if spl is not None:
            told["spl"] = _share(spl, "spl")
            if told["spl"] and not told["success"]:
                raise ValueError(
                    f"finish(success={success!r}, spl={spl!r}): the SPL of an episode that failed "
                    "is 0. Leave spl out, or correct the success."
                )
        for name in ("path_length", "geodesic_distance", "distance_to_goal"):
            if metrics.get(name) is not None:
                told[name] = _measure(metrics[name], name)
        self._walk.end(told, OVER, stopped)

    def _check(self):
        if self._walk.current is not self:
            stop(
                f"episode {self._name} was left for another one: of one thread, an episode is over "
                "when the next one begins. Walk side by side in threads or processes."
            )
        if self._walk.pid != os.getpid():
            stop(
                f"episode {self._name} was begun in process {self._walk.pid}, and process "
                f"{os.getpid()} goes on with it, whose frames would be of no episode: call "
                "mitigate_hook.connect() in the process that walks."
            )
        if self._thread != threading.get_ident():
            stop(
                f"episode {self._name} was begun by another thread than the one that goes on with "
                "it, and their frames might be mixed up: call mitigate_hook.connect() in the "
                "thread that walks."
            )


def _truth(value, name):
    """Return 0.0 or 1.0. Raises ValueError for what is neither."""
    found = _share(value, name)
    if found not in (0.0, 1.0):
        raise ValueError(f"finish({name}={value!r}): it must be 1 (or True) or 0 (or False).")
    return found


def _share(value, name):
    """Return a number from 0 to 1. Raises ValueError if it is none."""
    found = _measure(value, name)
    if not found <= 1:
        raise ValueError(
            f"finish({name}={value!r}): it must be a number from 0 to 1, not percent: 0.8."
        )
    return found


def _measure(value, name):
    """Return a number from 0, infinity too. Raises ValueError if it is none."""
    try:
        found = float(value)  # of an array or tensor with one item, too
    except (TypeError, ValueError):
        found = math.nan
    if not found >= 0:
        raise ValueError(f"finish({name}={value!r}): it must be a number that is not negative.")
    return found


def _described_frames(observations, cameras):
    """Return a new dict of observations, and what the server must know of each camera in it; stop
    at what may be a frame and was not described."""
    observations, cameras, listed = dict(observations), dict(cameras or {}), []
    for name, value in observations.items():
        by_name = next((kind for kind in (COLOR, DEPTH) if str(name).startswith(kind)), None)
        told = dict({"type": by_name}, **cameras.get(name, {}))
        strange = sorted(set(map(str, told)) - {"type", *CAMERA})
        if strange:
            stop(
                f"the camera {name} is described by {', '.join(strange)}, which nobody reads: what "
                f"can be said of a camera is type, {', '.join(CAMERA)}."
            )
        if told["type"] in (COLOR, DEPTH):
            if not isinstance(name, str):
                stop(f"a camera is called {name!r}: its name must be text, as {str(name)!r} is.")
            listed.append(dict(told, name=name))
        elif name in cameras and told["type"] != "other":
            stop(
                f"the entry {name} of an observation is described as {told['type']!r}: its type "
                "must be 'rgb', 'depth', or 'other' for what is to stay as it is."
            )
        elif name not in cameras:
            found = _frame_in(value, str(name))
            if found is not None:
                stop(
                    f"the entry {found[0]} of an observation may be a frame {found[1]}, and nobody "
                    f"said what it is. Name it in cameras=, {{{str(name)!r}: {{'type': 'rgb'}}}} "
                    "(or 'depth'; it must be an array [H, W, channels] and an entry of its own, "
                    "not one in a dict or list), or {'type': 'other'} to leave it as it is."
                )
    return observations, listed


def _frame_in(value, name):
    """Return name and shape of the first array in an entry that may be a frame, however deep in
    dicts and lists: more than 8 x 8 in two of its sides. None if there is none."""
    if value is None or isinstance(value, (str, bytes, int, float)):
        return None
    shape = _shape(value)
    if len(shape) > 1 and sorted(shape)[-2] > 8:
        return name, shape
    if callable(_get(value, "items")):
        parts = value.items()
    elif str(_get(value, "dtype", "")) == "object":
        parts = enumerate(value.ravel().tolist())
    else:
        parts = enumerate(value) if isinstance(value, (list, tuple)) else ()
    found = (_frame_in(part, f"{name}.{key}") for key, part in parts)
    return next((one for one in found if one is not None), None)


def _shape(value):
    """Return the shape of an array, a tensor, a picture of PIL, or numbers in lists of lists."""
    shape = []
    while isinstance(value, (list, tuple)) and value:
        shape.append(len(value))
        value = value[0]
    own = value.size if _get(value, "getbands") else _get(value, "shape")
    if own is None:
        return tuple(shape) if isinstance(value, (int, float)) else ()
    try:
        return (*shape, *map(int, own))
    except (TypeError, ValueError):  # a shape of another kind
        return ()


def wanted(episodes):
    """Return those of a list of (scene, episode id) that this run asks for: all without
    ``episodes=``, else about as many, chosen by a hash of their names. Raises RuntimeError outside
    of ``mitigate run``, ValueError for what is no such list."""
    _check_run()
    episodes = list(episodes)
    for one in episodes:
        if not isinstance(one, (tuple, list)) or len(one) != 2:
            raise ValueError(
                f"wanted() was given {one!r:.80}: each episode must be a pair, (scene, id), or "
                "('', id) where there are no scenes."
            )
    if not episodes:
        return []
    keep = _chosen(episodes, lambda episode: _key(*episode), 0)
    return episodes if keep is None else [episodes[i] for i in keep]


def _key(scene, episode):
    """The name of an episode: of its scene's file, and its id."""
    return f"{str(scene).rpartition('/')[2]}/{episode}"


def _check_run():
    if ADDRESS not in os.environ:
        raise RuntimeError("Start this program under `mitigate run -- python ...`.")


def connect(episode, scene="", instruction=None):
    """Begin an episode under ``mitigate run``; no two have one scene and name. Raises RuntimeError
    outside of it."""
    _check_run()
    if _thread.walk is None:
        _thread.walk = Walk()
    return Episode(_thread.walk, str(episode), scene, instruction)


# installing -------------------------------------------------------------------------------------

PATCHES = {  # module: ((class, or none for the module's own functions; method; wrapper), ...)
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
        ("Env", "render", _env_render),
    ),
    "habitat_sim.simulator": (
        ("Simulator", "get_sensor_observations", _sensor_observations),
        ("Simulator", "get_sensor_observations_async_finish", _async_observations),
    ),
    "WMNav_env": (("Env", "_run_episode", _wmnav_episode),),
}
OPTIONAL = ("get_sensor_observations_async_finish",)  # not in every version


def patch(module):
    """Wrap the methods of a module that was just imported."""
    _load_numpy()
    for owner, method, wrapper in PATCHES[module.__name__]:
        kind = _get(module, owner) if owner else module
        original = None if kind is None else _get(kind, method)
        if original is not None:
            setattr(kind, method, _wrapped(original, wrapper))
        elif method not in OPTIONAL:
            stop(_absent(module, owner, method))


def _absent(module, owner, method):
    """Say why a method that is to be wrapped is not there."""
    adapters = json.loads(os.environ.get(ADAPTERS) or "{}")
    if adapters.get("module") == module.__name__:
        classes = [n for n, kind in vars(module).items() if isinstance(kind, type)]
        there = ", ".join(n for n in classes if _get(vars(module)[n], "forward")) or "none"
        return (
            f"adapters= names the class {owner} of {module.__name__}, but there is none with a "
            f"forward method: those there are {there}. Write FOLDER:package.module:Class.attribute."
        )
    return (
        f"{module.__name__} has no {owner} {method}: this version of it is not known to the bridge "
        "(known: habitat-lab 0.1.5 to 0.3)."
    )


def _wrapped(original, wrapper):
    @functools.wraps(original)
    def method(*args, **kwargs):
        return wrapper(original, *args, **kwargs)

    return method


class Finder:
    """Has the loaders of the modules in ``PATCHES`` call ``patch`` behind the module's own code."""

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
    """Wrap what this process imports from now on, under ``mitigate run``; else do nothing."""
    if ADDRESS not in os.environ or any(isinstance(f, Finder) for f in sys.meta_path):
        return
    if os.path.exists(os.environ[ADDRESS]):
        with contextlib.suppress(OSError):  # of another user's: it says what is wrong later
            folder = os.path.dirname(os.environ[ADDRESS])
            open(os.path.join(folder, LOADED), "a").close()
    if os.environ.get(ADAPTERS):
        told = json.loads(os.environ[ADAPTERS])
        wrapper = _adapted(told["folder"], told["file"], told["path"])
        PATCHES[told["module"]] = ((told["class"], "forward", wrapper),)
    sys.meta_path.insert(0, Finder())


def run_hidden_sitecustomize(own):
    """Run the ``sitecustomize`` that the one in the file ``own`` hides, if there is one."""
    folder = os.path.dirname(os.path.abspath(own))
    path = [p for p in sys.path if os.path.abspath(p or os.curdir) != folder]
    spec = importlib.machinery.PathFinder.find_spec("sitecustomize", path)
    if spec is not None and spec.loader is not None:
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
