"""tissue_contact.replay against the program: the same bits; and a Simulator stepped by hand against both."""
import csv
import os
import pathlib
import shutil
import subprocess

import numpy as np
import pytest

import tissue_contact as tc

SCENE, BAG = "config/press_drag.yaml", "config/press_drag.bag"
FIELDS = ["force_x_n", "force_y_n", "force_z_n", "torque_x_nm", "torque_y_nm", "torque_z_nm"]
SECONDS = 1.0


def program(scene, bag, file, *options):
    subprocess.run(["rosrun", "tissue_contact", "tissue_contact_replay", "--scene", str(scene), "--bag", str(bag), "--csv", str(file),
                    *map(str, options)], check=True)


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    from conftest import SOURCE
    file = tmp_path_factory.mktemp("replay") / "program.csv"
    program(SOURCE / SCENE, SOURCE / BAG, file, "--duration", SECONDS)
    return file


def wrenches_of(file):
    return np.array([[float(row[field]) for field in FIELDS] for row in csv.DictReader(file.open())])


def fixture_digest(file):
    """That of a TissueFixture that has had these wrenches."""
    from geometry_msgs.msg import WrenchStamped
    from tissue_contact_testing import TissueFixture

    fixture, heard = TissueFixture.__new__(TissueFixture), []
    for row in csv.DictReader(file.open()):
        wrench = WrenchStamped()
        wrench.header.stamp.secs, wrench.header.stamp.nsecs = map(int, row["stamp_s"].split("."))
        for vector, name in ((wrench.wrench.force, "force_%s_n"), (wrench.wrench.torque, "torque_%s_nm")):
            for axis in "xyz":
                setattr(vector, axis, float(row[name % axis]))
        heard.append(wrench)
    fixture._wrenches = {"probe": None}
    fixture.wrenches = lambda name: heard
    return fixture.digest()


def test_same_bits_as_the_program(source, written, tmp_path):
    ours = tmp_path / "ours.csv"
    result = tc.replay(source / SCENE, source / BAG, csv=ours, duration_s=SECONDS)
    assert ours.read_bytes() == written.read_bytes()
    assert result.wrenches("probe").tobytes() == wrenches_of(written).tobytes()
    stamps = [row["stamp_s"] for row in csv.DictReader(written.open())]
    assert ["%d.%09d" % divmod(int(one), 10 ** 9) for one in result.of("probe")["stamp_ns"]] == stamps
    assert np.abs(result.wrenches("probe")).max() > 0.01
    assert "joint states accepted" in result.log and result.instruments == ["probe"]
    assert result.digest() == tc.replay(source / SCENE, source / BAG, duration_s=SECONDS).digest()
    assert result.digest() == fixture_digest(written)
    softer = tc.replay(source / SCENE, source / BAG, duration_s=SECONDS, set={"tissues.block.material.youngs_modulus_pa": 4000.0})
    assert softer.digest() != result.digest()


def test_same_bits_of_a_real_robot(source, tmp_path):
    """Two seconds in which a dVRK PSM comes down on a slab and slides; skipped without the recording (TISSUE_CONTACT_SHARED_DATA)."""
    folder = pathlib.Path(os.environ.get("TISSUE_CONTACT_SHARED_DATA") or source / "../shared/data")
    bag, scene = folder / "dvrk/psm2_classic_motion.bag", source / "config/psm_dvrk.yaml"
    if not bag.exists():
        pytest.skip("no recording at %s" % bag)
    program(scene, bag, tmp_path / "program.csv", "--from", 14.0, "--duration", 2.0)
    result = tc.replay(scene, bag, csv=tmp_path / "ours.csv", from_s=14.0, duration_s=2.0)
    assert (tmp_path / "ours.csv").read_bytes() == (tmp_path / "program.csv").read_bytes()
    assert result.wrenches("psm").tobytes() == wrenches_of(tmp_path / "program.csv").tobytes()
    assert np.count_nonzero(np.abs(result.wrenches("psm")).max(axis=1)) > 100


def test_stepped_by_hand(source, written):
    """The motion of the recording through Simulator.advance: the intervals between its stamps."""
    rosbag = pytest.importorskip("rosbag")
    moments = [(message.header.stamp.to_nsec(), dict(zip(message.name, message.position)))
               for _, message, _ in rosbag.Bag(str(source / BAG)).read_messages("/probe/joint_states")]
    simulator = tc.Simulator(tc.load_scene(source / SCENE))
    names, found = simulator.joint_names("probe"), []
    expected = wrenches_of(written)
    for i, (stamp_ns, positions) in enumerate(moments[:len(expected)]):
        target = [positions[name] for name in names]
        if i == 0:
            simulator.place("probe", target)
        else:
            simulator.advance((stamp_ns - moments[i - 1][0]) * 1e-9, {"probe": target})
        found.append(simulator.wrench("probe"))
    assert np.array(found).tobytes() == expected.tobytes()


def test_refusals(source, tmp_path):
    with pytest.raises(ValueError, match="youngs_modulus_pa"):
        tc.replay(source / SCENE, source / BAG, set={"tissues.block.material.youngs_modulus_pa": -1})
    with pytest.raises((ValueError, RuntimeError), match="no_such.bag"):
        tc.replay(source / SCENE, tmp_path / "no_such.bag")
    for bad in ({"from_s": float("nan")}, {"duration_s": 0.0}, {"from_s": 1e6}):
        with pytest.raises(ValueError):
            tc.replay(source / SCENE, source / BAG, **bad)
    with pytest.raises(TypeError):
        tc.replay(3, source / BAG)
    damaged = tmp_path / "damaged.bag"
    damaged.write_bytes((source / BAG).read_bytes()[:5000])
    with pytest.raises(RuntimeError, match="damaged.bag"):
        tc.replay(source / SCENE, damaged)
    assert shutil.which("rosrun")
