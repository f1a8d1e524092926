"""Tests of all ways to read frames from a simulator: frames are corrupted once, or the process ends
with an error."""

import pytest

from mitigate.bridge.condition import why_not_applicable
from mitigate.corruptions import Corruption

from .conftest import condition
from .test_loops import run_loop

ENV = """
import habitat, habitat_sim.simulator
from habitat.core.env import Env, make_dataset
from habitat.core.simulator import Simulator
"""
LAB = (
    ENV
    + """
class Sim(habitat_sim.simulator.Simulator, Simulator):  # as habitat-lab's own is
    def __init__(self):
        habitat_sim.simulator.Simulator.__init__(self)
        Simulator.__init__(self)
    def step(self, action):
        self.raw = self.get_sensor_observations()["color_sensor"]
        return Simulator.step(self, action)
    def look(self):
        return self.get_sensor_observations()["color_sensor"]
env = Env(config={}, dataset=make_dataset(1))
env.sim = env._sim = env.task._sim = sim = Sim()
env.reset()
env.step(1)
assert (sim.raw[..., :3] == 130).all()  # what the lab's sensors are given
"""
)


def test_lab_simulator_gives_clean_frames_to_its_sensors(tmp_path):
    process, reports = run_loop(
        tmp_path, LAB + "env.step(0)\nprint('done')", condition("low_light")
    )
    assert process.stdout == "done\n" and reports.ends["s0/0"]["calls"] == 3


@pytest.mark.parametrize(
    "look",
    [
        "env.sim.get_sensor_observations()",
        "env.sim.look()",
        "habitat_sim.simulator.Simulator.step(env.sim, 1)",
        "env.sim.start_async_render(); env.sim.get_sensor_observations_async_finish()",
    ],
)
def test_lab_simulator_stops_for_frames_that_bypass_its_sensors(tmp_path, look):
    process, reports = run_loop(tmp_path, f"{LAB}{look}\nprint('went on')", condition("low_light"))
    assert process.returncode == 97 and "went on" not in process.stdout
    assert "calls get_sensor_observations of habitat-lab's simulator" in reports.problems[0]


def test_get_observations_accepts_frames_by_keyword(tmp_path):
    code = ENV + (
        "env = Env(config={}, dataset=make_dataset(1))\nenv.reset()\n"
        "suite, place = env.sim.sensor_suite, (0.0, 0.0, 0.0)\n"
        "clean = mitigate_hook._call_clean(suite.get_observations, place)\n"
        "for seen in (suite.get_observations(place), suite.get_observations(sim_obs=place)):\n"
        "    print((seen['rgb'] != clean['rgb']).any(), (seen['depth'] == clean['depth']).all())"
    )
    process, _ = run_loop(tmp_path, code, condition("low_light"))
    assert process.stdout == "True True\n" * 2


SIM = """
import habitat_sim.simulator
sim = habitat_sim.simulator.Simulator()
episode = mitigate_hook.connect("a")
"""


@pytest.mark.parametrize(
    ("call", "acting", "goal"),
    [
        ("sim.get_sensor_observations()", "['color_sensor']", None),
        ("sim.get_sensor_observations([0, 1])", "[0]['color_sensor']", "[1]['goal_sensor']"),
        ("sim.get_sensor_observations(agent_ids=1)", None, "['goal_sensor']"),
        ("(sim.start_async_render(), sim.get_sensor_observations_async_finish())[1]",
         "['color_sensor']", None),
        ("(sim.start_async_render(1), sim.get_sensor_observations_async_finish())[1]",
         None, "['goal_sensor']"),
    ],
)  # fmt: skip
def test_habitat_sim_corrupts_the_acting_agent_once(tmp_path, call, acting, goal):
    displayed = f"seen{acting}[..., :3].mean()" if acting else "0"
    other = f"seen{goal}[0, 0, 0]" if goal else "130"
    process, _ = run_loop(
        tmp_path, f"{SIM}seen = {call}\nprint({displayed}, {other})", condition("low_light")
    )
    mean, clean = map(float, process.stdout.split())
    assert clean == 130 and (mean == 0 if acting is None else 40 < mean < 110)


@pytest.mark.parametrize("name", ["clean", "low_light"])
def test_corrupt_stops_for_frames_of_habitat_sim(tmp_path, name):
    code = (
        "frames = sim.get_sensor_observations()\n"
        "episode.corrupt({'rgb': frames['color_sensor'].copy()})\nprint('went on')"
    )
    process, reports = run_loop(tmp_path, SIM + code, condition(name))
    assert process.returncode == 97 and "would corrupt them twice" in reports.problems[0]
    process, reports = run_loop(
        tmp_path / "b", SIM + "sim.get_sensor_observations()\nepisode.finish(1)"
    )
    assert process.returncode == 0 and reports.ends["a"]["calls"] == 1


@pytest.mark.parametrize(
    "again",
    [
        "episode.corrupt(seen)",
        "episode.corrupt({'rgb': seen['rgb'][:8, ::2]})",
        "mitigate_hook.connect('b').corrupt({'left': seen['rgb']}, cameras={'left': {}})",
    ],
)
def test_corrupt_stops_for_a_corrupted_frame(tmp_path, again):
    code = (
        "episode = mitigate_hook.connect('a')\nseen = episode.corrupt({'rgb': rgb})\n"
        f"seen = episode.corrupt({{'rgb': rgb}})\n{again}\nprint('went on')"
    ).replace("{}}", "{'type': 'rgb'}}")
    process, reports = run_loop(tmp_path, code)
    assert process.returncode == 97 and "is corrupted already" in reports.problems[0]


@pytest.mark.parametrize(
    ("source", "words"),
    [
        ("class Env:\n    def reset(self): pass", "has no make_dataset, Env.step, Env.close, Env."),
        (
            "make_dataset = 1\nclass Env:\n    reset = step = close = render = 0\n"
            "    def __init__(self, config, dataset): pass",
            "Env has no sim",
        ),
    ],
)
def test_hook_rejects_a_different_package_named_habitat(tmp_path, source, words):
    package = tmp_path / "own" / "habitat" / "core"
    package.mkdir(parents=True)
    for folder in (package.parent, package):
        (folder / "__init__.py").touch()
    (package / "env.py").write_text(source)
    code = f"sys.path.insert(0, {str(tmp_path / 'own')!r})\n"
    code += "from habitat.core.env import Env\nEnv(None)\n"
    process, reports = run_loop(tmp_path, code)
    assert process.returncode == 97 and words in reports.problems[0], process.stdout
    assert "call connect, corrupt and finish" in reports.problems[0]


def test_reports_name_float_images_that_are_no_camera(tmp_path):
    code = ENV + (
        "from habitat.core.simulator import SensorTypes\nenv = Env(config={})\n"
        "env.sim.sensor_suite.sensors['depth'].sensor_type = SensorTypes.TEXT\n"
        "env.reset(); env.step(1); env.close()"
    )
    _, reports = run_loop(tmp_path, code)
    assert why_not_applicable(Corruption("multipath", 0.6), reports) == (
        "the agent has no depth camera (not read as cameras: depth with sensor_type TEXT)"
    )


@pytest.mark.slow
def test_close_leaves_nothing_behind(tmp_path):
    code = ENV + (
        "import gc, time\nopen_files = []\n"
        "for _ in range(6):\n"
        "    env = Env(config={}, dataset=make_dataset(1))\n"
        "    env.reset(); env.step(1); env.step(0); env.close(); del env; gc.collect()\n"
        "    open_files.append(len(os.listdir('/proc/self/fd')))\n"
        "print(max(open_files) == open_files[0],"
        " any(isinstance(o, Simulator) for o in gc.get_objects()),"
        " len(mitigate_hook._sessions), len(mitigate_hook._descriptions))"
    )
    process, reports = run_loop(tmp_path, code)
    assert process.stdout == "True False 0 0\n" and reports.repeated == 5
