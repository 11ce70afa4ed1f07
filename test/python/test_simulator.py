"""What a simulator in Python gives."""
import numpy as np
import pytest

import tissue_contact as tc
from conftest import press


def test_names(simulator, scene):
    assert simulator.instruments == scene.instruments == ["probe"]
    assert simulator.tissues == scene.tissues == ["block"]
    assert simulator.joint_names("probe") == ["x", "y", "z"]
    assert simulator.joint_limits("probe").shape == (3, 2)
    assert len(simulator.contact_links("probe")) == 1
    assert scene.max_step_s == 0.002 and scene.world_frame == "world" and scene.file.endswith("press.yaml")


def test_press(simulator):
    assert np.all(simulator.wrench("probe") == 0.0)
    wrench = press(simulator)
    assert wrench.shape == (6,) and wrench[2] > 0.01
    contacts = simulator.contacts()
    on_tissue = contacts["force"].sum(axis=0)
    world = simulator.wrench("probe", frame="world")
    assert np.allclose(on_tissue, -world[:3], rtol=1e-9)
    tip = simulator.tip_pose("probe")
    assert np.allclose(tip[:3, :3] @ wrench[:3], world[:3]) and np.allclose(tip[:3, :3] @ wrench[3:], world[3:])
    arms = contacts["point"] - tip[:3, 3]
    assert np.allclose(np.cross(arms, -contacts["force"]).sum(axis=0), world[3:], atol=1e-6)
    assert set(contacts["state"]) <= {tc.OPEN, tc.STATIC, tc.KINETIC}
    assert np.allclose(np.linalg.norm(contacts["normal"], axis=1), 1.0)
    report = simulator.report()
    assert report.substeps == 3 and report.converged and report.stop == "tolerance" and report.iterations > 0
    assert report.static_contacts + report.kinetic_contacts + report.open_contacts == len(contacts)
    assert simulator.step_count == 12
    errors = simulator.force_errors()
    assert errors.shape == (1,) and 0.0 < errors["total_n"][0] < 1.0
    assert 0.0 <= simulator.residuals()["momentum"] < 1e-2


def test_mesh(simulator):
    press(simulator)
    mesh, x = simulator.topology("block"), simulator.positions("block")
    assert x.shape == simulator.velocities("block").shape == mesh.rest_positions.shape and x.shape[1] == 3
    corners = x[mesh.tetrahedra]
    volumes = np.einsum("ij,ij->i", np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), corners[:, 3] - corners[:, 0])
    assert np.all(volumes > 0.0)
    assert mesh.triangles.max() < len(x) and mesh.tetrahedra.dtype == np.int32
    assert np.array_equal(x[mesh.fixed], mesh.rest_positions[mesh.fixed])
    assert not np.array_equal(x, mesh.rest_positions)
    assert simulator.topology("block") is mesh


def test_joint_velocities(scene):
    """A parabola is met in the middle of an interval, as in two intervals; a velocity that is not known leaves the way straight."""
    def wrench(way):
        simulator = tc.Simulator(scene)
        press(simulator)
        for duration_s, z, velocities in way:
            known = {"probe": [[0.0, 0.0, v] for v in velocities]}
            simulator.advance(duration_s, {"probe": [0.0, 0.0, z]}, velocities=known)
        return simulator.wrench("probe")
    z = -0.003
    once = wrench([(0.008, z - 0.0002, (0.0, -0.05))])
    twice = wrench([(0.004, z - 0.00005, (0.0, -0.025)), (0.004, z - 0.0002, (-0.025, -0.05))])
    straight = wrench([(0.008, z - 0.0002, (0.0, np.nan))])
    assert np.allclose(once, twice, rtol=1e-6, atol=1e-9)
    assert abs(straight[2] - once[2]) > 1e-3 * once[2]


def test_joint_positions(simulator):
    simulator.place("probe", [0.01, 0.0, 0.005])
    assert np.array_equal(simulator.joint_positions("probe"), [0.01, 0.0, 0.005])
    simulator.advance(0.01)
    assert np.array_equal(simulator.joint_positions("probe"), [0.01, 0.0, 0.005])
    simulator.advance(0.01, [np.array([0, 0, 1], dtype=np.float32)])
    assert np.array_equal(simulator.joint_positions("probe"), [0.0, 0.0, 1.0])


def test_state_goes_on_to_the_same_bits(simulator, scene):
    press(simulator)
    state = simulator.save_state()
    assert isinstance(state, bytes)
    other = tc.Simulator(scene)
    other.load_state(state)
    for one in (simulator, other):
        one.advance(0.01, {"probe": [0.002, 0.0, -0.003]})
    assert simulator.wrench("probe").tobytes() == other.wrench("probe").tobytes()
    assert simulator.positions("block").tobytes() == other.positions("block").tobytes()


def test_reset(simulator):
    first = press(simulator)
    simulator.reset()
    assert simulator.step_count == 0
    assert press(simulator).tobytes() == first.tobytes()


def test_settings_and_retune(source, scene):
    soft = tc.Simulator(scene)
    stiff_scene = tc.load_scene(str(source / "test/ros/press.yaml"), set={"tissues.block.material.youngs_modulus_pa": np.float64(10000)})
    ratio = press(tc.Simulator(stiff_scene))[2] / press(soft)[2]
    assert 1.7 < ratio < 2.3
    soft.retune(stiff_scene)
    soft.reset()
    retuned = tc.Simulator(scene)
    retuned.retune(stiff_scene)
    assert press(soft).tobytes() == press(retuned).tobytes()


def test_text(source):
    text = (source / "test/ros/press.yaml").read_text()
    scene = tc.parse_scene(text, set=["step.max_step_s=0.001"])
    assert scene.max_step_s == 0.001 and scene.settings == ["step.max_step_s=0.001"]


def test_frames_and_urdf(source):
    text = (source / "test/ros/press.yaml").read_text()
    by_frame = tc.parse_scene(text.replace("base_pose: {", "base_pose: {tf_frame: robot, "))
    with pytest.raises(ValueError, match="robot"):
        tc.Simulator(by_frame)
    lifted = np.eye(4)
    lifted[2, 3] = 0.5
    assert tc.Simulator(by_frame, frames={"robot": lifted}).tip_pose("probe")[2, 3] > 0.5
    by_parameter = tc.parse_scene(text.replace("urdf: package://tissue_contact/urdf/probe.urdf", "robot_description: /robot"))
    with pytest.raises(ValueError, match="urdf=FILE"):
        tc.Simulator(by_parameter)
    assert tc.Simulator(by_parameter, urdf=source / "urdf/probe.urdf").joint_names("probe") == ["x", "y", "z"]
    with pytest.raises(ValueError, match="urdf='/there/is.none' would change nothing"):
        tc.Simulator(tc.load_scene(source / "config/press_drag.yaml"), urdf="/there/is.none")
