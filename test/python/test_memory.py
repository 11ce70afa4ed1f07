"""Arrays that show the simulator's memory: not copied, never changed, never dangling; and no leaks."""
import gc
import resource

import numpy as np
import pytest

import tissue_contact as tc
from conftest import press

REFINED = {"tissues.block.refinement": "auto"}


def test_not_copied(simulator):
    x = simulator.positions("block")
    assert not x.flags.owndata and x.flags.c_contiguous and np.shares_memory(x, simulator.positions("block"))
    mesh = simulator.topology("block")
    assert np.shares_memory(mesh.tetrahedra, simulator.topology("block").tetrahedra)


@pytest.mark.parametrize("array", ["positions", "velocities"])
def test_read_only(simulator, array):
    x = getattr(simulator, array)("block")
    with pytest.raises(ValueError):
        x[0, 0] = 1.0
    with pytest.raises(ValueError):
        x.setflags(write=True)
    with pytest.raises(ValueError):
        simulator.topology("block").tetrahedra[0, 0] = 7


@pytest.mark.parametrize("settings", [None, REFINED])
def test_holds_its_moment(source, settings):
    simulator = tc.Simulator(tc.load_scene(source / "test/ros/press.yaml", set=settings))
    press(simulator)
    kept = [(simulator.positions("block"), simulator.velocities("block"), simulator.topology("block").tetrahedra)]
    copies = [[one.copy() for one in kept[0]]]
    moves = [lambda: simulator.advance(0.02, {"probe": [0.01, 0.0, -0.003]}), lambda: simulator.advance(0.05, {"probe": [-0.015, 0.01, -0.003]}),
             simulator.reset, lambda: press(simulator), lambda: simulator.load_state(state)]
    state = simulator.save_state()
    for move in moves:
        move()
        kept.append((simulator.positions("block")[3:], simulator.velocities("block").T, simulator.topology("block").tetrahedra[::2]))
        copies.append([one.copy() for one in kept[-1]])
    sizes = {len(one[0]) for one in kept}
    assert len(sizes) > 1 if settings else True  # the mesh did change
    del simulator, moves, move
    gc.collect()
    for arrays, expected in zip(kept, copies):
        for array, copy in zip(arrays, expected):
            assert np.array_equal(array, copy)


def test_held_arrays_change_no_bit(scene):
    alone, watched = tc.Simulator(scene), tc.Simulator(scene)
    held = []
    for step in range(20):
        for one in (alone, watched):
            one.advance(0.004, {"probe": [0.0002 * step, 0.0, -0.001 - 0.0001 * step]})
        held.append((watched.positions("block"), watched.velocities("block")))
    assert alone.positions("block").tobytes() == watched.positions("block").tobytes()
    assert alone.wrench("probe").tobytes() == watched.wrench("probe").tobytes()
    assert len({x.tobytes() for x, _ in held}) == 20


def test_no_leak(source):
    scene = tc.parse_scene((source / "test/ros/press.yaml").read_text().replace("cells: [6, 6, 2]", "cells: [2, 2, 1]"))

    def make(count):
        for _ in range(count):
            simulator = tc.Simulator(scene)
            simulator.advance(0.002, {"probe": [0.0, 0.0, -0.0015]})
            x = simulator.positions("block")
            simulator.advance(0.002, {"probe": [0.0, 0.0, -0.002]})
            assert len(x) == len(simulator.topology("block").fixed) and len(simulator.save_state()) > len(simulator.contacts())
        gc.collect()
        with open("/proc/self/statm", encoding="ascii") as stream:  # of now; ru_maxrss is the most that other tests had
            return int(stream.read().split()[1]) * resource.getpagesize() // 1024

    make(200)  # what pools keep
    before_kb = make(200)
    assert make(1000) - before_kb < 4000  # 4 kB each would show
