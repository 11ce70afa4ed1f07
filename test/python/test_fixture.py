"""TissueFixture: what it complains about. Without a node."""
import threading


def fixture_that_heard(*statuses):
    from tissue_contact_testing import TissueFixture
    fixture = TissueFixture.__new__(TissueFixture)
    fixture._changed = threading.Condition()
    fixture._wrenches = {"probe": []}
    fixture._statuses = list(statuses)
    return fixture


def status(**counts):
    from tissue_contact.msg import Status
    return Status(**counts)


def test_what_a_node_went_through_before_is_no_complaint():
    """A second test on a node was told of the first one's 3 refused joint states and its loop."""
    before = {"joint_states_accepted": 500, "joint_states_refused": 3, "resets": 1, "gaps": 2, "joint_states_merged": 4, "joint_states_dropped": 5}
    fixture = fixture_that_heard(status(**before), status(**dict(before, joint_states_accepted=600)))
    assert fixture.complaints() == []
    fixture = fixture_that_heard(status(**before), status(**dict(before, joint_states_refused=5, resets=2)))
    assert fixture.complaints() == ["2 joint states were refused (the node's log says why)", "1 times time went back, and the scene was reset"]


def test_what_a_new_node_refuses_first_is_a_complaint():
    """Before its first status."""
    fixture = fixture_that_heard(status(joint_states_accepted=1, joint_states_refused=2), status(joint_states_accepted=50, joint_states_refused=2))
    assert fixture.complaints() == ["2 joint states were refused (the node's log says why)"]


def test_silence_is_a_complaint():
    assert fixture_that_heard().complaints() == ["no status came"]
