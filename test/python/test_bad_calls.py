"""Calls that make no sense: an exception with the core's words, and the simulator as it was."""
import copy
import os
import pickle
import random
import signal
import threading
import time

import numpy as np
import pytest

import tissue_contact as tc
from conftest import press

NAN, INF = float("nan"), float("inf")
WRONG = [
    (ValueError, lambda s: s.wrench("prob"), 'did you mean "probe"'),
    (ValueError, lambda s: s.positions("liver"), "block"),
    (ValueError, lambda s: s.wrench("probe", frame="map"), "tip or world"),
    (ValueError, lambda s: s.place("probe", [0.0, 0.0]), "joint positions"),
    (ValueError, lambda s: s.place("probe", [[0.0, 0.0, 0.0]]), "flat list"),
    (ValueError, lambda s: s.place("probe", [0.0, NAN, 0.0]), "joint 'y'"),
    (TypeError, lambda s: s.place("probe", ["0", "0", "0"]), "real numbers"),
    (ValueError, lambda s: s.place("probe", np.broadcast_to(0.0, (2 ** 45,))), "1000000 are allowed"),
    (TypeError, lambda s: s.place("probe", None), "real numbers"),
    (TypeError, lambda s: s.place("probe", [1j, 0, 0]), "real numbers"),
    (TypeError, lambda s: s.place("probe", {"x": 0.0}), "real numbers"),
    (TypeError, lambda s: s.place("probe", [[0.0], [0.0, 1.0]]), "real numbers"),
    (ValueError, lambda s: s.advance(0.0), "duration"),
    (ValueError, lambda s: s.advance(-1.0), "duration"),
    (ValueError, lambda s: s.advance(1e-12), "1e-9"),
    (ValueError, lambda s: s.advance(NAN), "duration"),
    (ValueError, lambda s: s.advance(INF), "duration"),
    (ValueError, lambda s: s.advance(1e300), "duration"),
    (TypeError, lambda s: s.advance("1"), ""),
    (TypeError, lambda s: s.advance(0.01, 3.0), "dict"),
    (TypeError, lambda s: s.advance(0.01, "abc"), "dict"),
    (TypeError, lambda s: s.advance(0.01, {3: [0, 0, 0]}), "name of an instrument"),
    (ValueError, lambda s: s.advance(0.01, {"arm": [0, 0, 0]}), "probe"),
    (ValueError, lambda s: s.advance(0.01, {"probe": [0, 0, INF]}), "joint 'z'"),
    (ValueError, lambda s: s.advance(0.01, []), "probe"),
    (TypeError, lambda s: s.advance(0.01, None, [0, 0, 0]), "dict"),
    (TypeError, lambda s: s.advance(0.01, None, {3: ([0, 0, 0], [0, 0, 0])}), "name of an instrument"),
    (TypeError, lambda s: s.advance(0.01, None, {"probe": 3.0}), "must be two"),
    (TypeError, lambda s: s.advance(0.01, None, {"probe": [0, 0, 0]}), "must be two"),
    (ValueError, lambda s: s.advance(0.01, None, {"probe": ([0, 0], [0, 0, 0])}), "as many"),
    (ValueError, lambda s: s.advance(0.01, None, {"arm": ([0, 0, 0], [0, 0, 0])}), "probe"),
    (ValueError, lambda s: s.advance(0.01, np.zeros((2, 3))), "2 instruments"),
    (ValueError, lambda s: s.load_state(b""), ""),
    (ValueError, lambda s: s.load_state(s.save_state()[:-1]), ""),
    (TypeError, lambda s: s.load_state(3), ""),
    (TypeError, lambda s: s.retune("scene.yaml"), ""),
    (TypeError, lambda s: s.positions(0), ""),
    (TypeError, lambda s: pickle.dumps(s), "save_state"),
    (TypeError, lambda s: pickle.dumps(s, 0), "save_state"),
    (TypeError, lambda s: pickle.dumps(s.report(), 0), "save_state"),
    (TypeError, lambda s: pickle.dumps(s.topology("block"), 1), "save_state"),
    (TypeError, lambda s: type(s.report()).__new__(type(s.report())), "made by"),
    (TypeError, lambda s: type(s.topology("block")).__new__(type(s.topology("block"))), "made by"),
    (TypeError, lambda s: tc.Scene.__new__(tc.Scene), "made by"),
    (TypeError, lambda s: copy.copy(s), ""),
    (TypeError, lambda s: tc.Simulator("scene.yaml"), ""),
    (TypeError, lambda s: tc.Simulator(), ""),
    (AttributeError, lambda s: setattr(s, "tissues", []), ""),
]


@pytest.mark.parametrize("kind,call,words", WRONG)
def test_refused(simulator, kind, call, words):
    press(simulator)
    before = simulator.save_state()
    with pytest.raises(kind) as error:
        call(simulator)
    assert words in str(error.value)
    assert simulator.save_state() == before


@pytest.mark.parametrize("key,value,part", [
    ("step.max_step_s", 0.0005, "step"),
    ("tissues.block.block.cells", "[5, 4, 3]", "the mesh of a tissue"),
    ("tissues.block.material.model", "neo_hookean", "a tissue's material"),
])
def test_retune_takes_no_other_scene(source, simulator, key, value, part):
    with pytest.raises(ValueError, match="this one has other " + part):
        simulator.retune(tc.load_scene(str(source / "test/ros/press.yaml"), set={key: value}))


def test_replay_wants_a_file(scene):
    with pytest.raises(TypeError, match="a file"):
        tc.replay(scene, "x.bag")


@pytest.mark.parametrize("kind,set_,words", [
    (ValueError, {"tissues.block.material.youngs_modulus_pa": -4}, "youngs_modulus_pa"),
    (ValueError, {"tissues.block.material.youngs_modulus_pa": NAN}, "youngs_modulus_pa"),
    (ValueError, {"tissues.blok.material.youngs_modulus_pa": 4}, "block"),
    (ValueError, {"no.such": 1}, "no"),
    (ValueError, ["nonsense"], "nonsense"),
    (TypeError, {3: 4}, "text"),
    (TypeError, {"step.max_step_s": object()}, "set"),
    (TypeError, 3, "dict"),
])
def test_refused_settings(source, kind, set_, words):
    with pytest.raises(kind) as error:
        tc.load_scene(source / "test/ros/press.yaml", set=set_)
    assert words in str(error.value)


def test_refused_scenes(source, tmp_path):
    with pytest.raises(ValueError, match="no_such.yaml"):
        tc.load_scene(tmp_path / "no_such.yaml")
    with pytest.raises(ValueError, match="no_such_package"):
        tc.load_scene("package://no_such_package/scene.yaml")
    with pytest.raises(TypeError):
        tc.load_scene(7)
    with pytest.raises(ValueError, match="here.yaml:1"):
        tc.parse_scene("tisues: []", file="here.yaml")
    scene = tc.load_scene(source / "test/ros/press.yaml")
    for frames in (3, {"robot": np.eye(3)}, {"robot": np.zeros((4, 4))}, {4: np.eye(4)}, {"robot": np.full((4, 4), NAN)}):
        with pytest.raises((TypeError, ValueError), match="frame"):
            tc.Simulator(scene, frames=frames)


def test_scene_is_pickled(source):
    file = source / "test/ros/press.yaml"
    changed = {"tissues.block.material.youngs_modulus_pa": 4000.0}
    for scene in (tc.load_scene(file, set=changed), tc.parse_scene(file.read_text(), set=changed)):
        again = pickle.loads(pickle.dumps(scene))
        assert (again.file, again.settings) == (scene.file, scene.settings)
        assert press(tc.Simulator(again)).tobytes() == press(tc.Simulator(scene)).tobytes()


def test_random_calls(simulator):
    """Any method with any of these: nothing but these exceptions, and a simulator that goes on."""
    dice = random.Random(17)
    things = [None, True, 0, -1, 2 ** 70, 0.001, NAN, INF, "", "probe", "block", "x" * 5000, "\0", b"", b"\xff", [], [0.0] * 3, [NAN] * 3, (),
              {}, {"probe": [0, 0, -0.002]}, {"probe": None}, np.zeros(3), np.zeros((3, 3)), np.zeros(0), np.array(["a"]), object(), simulator,
              np.float32(0.002), [[0, 0, 0]], set(), 1j, simulator.save_state(), simulator.positions("block"), np.zeros(3)[::-1]]
    methods = [name for name in dir(simulator) if not name.startswith("_") and callable(getattr(simulator, name))]
    assert len(methods) > 15
    done = 0
    for _ in range(3000):
        method, arguments = dice.choice(methods), [dice.choice(things) for _ in range(dice.choice([0, 1, 1, 2, 2, 3]))]
        if method == "advance" and arguments and arguments[0] is True:
            continue  # a whole second
        try:
            getattr(simulator, method)(*arguments)
            done += 1
        except (TypeError, ValueError, IndexError, OverflowError):
            pass
    assert done > 100
    simulator.reset()
    assert press(simulator)[2] > 0.01


def advance_until(simulator, seen, to):
    """A thread that advances until `seen` holds something; a hundred times at most, however seldom the others get a turn."""

    def work():
        for _ in range(100):
            if seen:
                return
            simulator.advance(1.0, {"probe": to})

    thread = threading.Thread(target=work)
    thread.start()
    return thread


def test_two_threads(simulator):
    """One advances without the GIL; the other goes on meanwhile, and is told when it uses the same simulator."""
    refused = []
    thread = advance_until(simulator, refused, [0.0, 0.0, -0.003])
    while thread.is_alive():
        try:
            simulator.positions("block")
        except RuntimeError as error:
            refused.append(str(error))
        time.sleep(0.001)
    thread.join()
    assert refused and "another thread" in refused[0]
    assert simulator.step_count > 0 and simulator.step_count % 500 == 0 and simulator.wrench("probe")[2] > 0.01


def test_arrays_are_read_while_another_thread_advances(simulator):
    press(simulator)
    x = simulator.positions("block")
    expected, looks = x.copy(), []
    thread = advance_until(simulator, looks, [0.01, 0.0, -0.003])
    while thread.is_alive():
        assert np.array_equal(x, expected)
        try:
            simulator.positions("block")
        except RuntimeError:  # the other is advancing
            looks.append(np.array_equal(x, expected))
        time.sleep(0.001)
    thread.join()
    assert looks and all(looks)


def test_interrupted(simulator):
    before, handler = simulator.step_count, signal.signal(signal.SIGINT, signal.default_int_handler)  # a job in the background ignores it
    threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        simulator.advance(1e6, {"probe": [0.0, 0.0, -0.002]})
    signal.signal(signal.SIGINT, handler)
    assert simulator.step_count > before
    simulator.reset()
    assert press(simulator)[2] > 0.01


def test_forked(simulator):
    press(simulator)
    child = os.fork()
    if child == 0:
        simulator.advance(0.01, {"probe": [0.0, 0.0, -0.004]})
        os._exit(0 if simulator.wrench("probe")[2] > 0.0 else 3)
    assert os.waitpid(child, 0)[1] == 0
    assert simulator.step_count == 12


def test_never_initialised():
    """What no constructor has made."""
    blank = tc.Simulator.__new__(tc.Simulator)
    child = os.fork()
    if child == 0:
        try:
            blank.wrench("probe")
        except (TypeError, ValueError, RuntimeError):
            os._exit(0)
        os._exit(3)
    assert os.waitpid(child, 0)[1] == 0
