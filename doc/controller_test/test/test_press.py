"""The controller against tissue, by pytest: python3 -m pytest test_press.py. Needs no roscore."""
import os

import pytest
import rospy
from tissue_contact_testing import TissueFixture, launched

STATES = 150
TARGET_N = os.environ.get("TARGET_FORCE_N", "0.5")


@pytest.fixture(scope="session")  # rospy knows one master in its life
def runs():
    with launched("tissue_contact_controller_test", "twice.launch", "target_force_n:=" + TARGET_N):
        rospy.init_node("test_press", disable_signals=True)
        both = [TissueFixture("/first/tissue_contact", ["probe"]), TissueFixture("/second/tissue_contact", ["probe"])]
        for run, topic in zip(both, ["/first/start", "/second/start"]):
            run.tell_to_start(topic)
        for run in both:
            run.wait_for(STATES)
        yield both


def test_nothing_went_wrong(runs):
    assert [run.complaints() for run in runs] == [[], []]


def test_presses_gently_and_holds(runs):
    assert runs[0].peak_force_n("probe") < 0.6
    assert runs[0].forces_n("probe")[-1] == pytest.approx(0.5, abs=0.02)


def test_the_same_bits_again(runs, record_property):
    record_property("digest", runs[0].digest())
    assert runs[0].digest() == runs[1].digest()
