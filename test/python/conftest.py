import pathlib

import pytest

import tissue_contact as tc

SOURCE = pathlib.Path(__file__).resolve().parents[2]


@pytest.fixture
def source():
    return SOURCE


@pytest.fixture
def scene():
    return tc.load_scene(SOURCE / "test/ros/press.yaml")


@pytest.fixture
def simulator(scene):
    """A probe whose ball hangs 1 mm above a block."""
    return tc.Simulator(scene)


def press(simulator, depth_m=0.002, steps=4):
    for step in range(1, steps + 1):
        simulator.advance(0.005, {"probe": [0.0, 0.0, -0.001 - depth_m * step / steps]})
    return simulator.wrench("probe")
