#!/usr/bin/python3
"""Runs a launch file of this package on a ROS master of its own, and tells whether it did what it is for.

usage: run_launch.py demo.launch|grasp.launch|two_psm.launch|incline.launch [arg:=value ...]
       run_launch.py scene.launch scene:=FILE bag:=FILE [arg:=value ...]

roslaunch returns 0 whatever became of its nodes. This returns 0 only when the plots were written, else 1. The master
listens on a free port, so neither topics nor parameters (/use_sim_time) of a robot that is up on this machine are touched.
"""
import os
import signal
import subprocess
import sys
import tempfile

from tissue_contact_testing import free_port


def run(arguments):
    """Exit code; 1 as well when roslaunch succeeds without plots."""
    port = str(free_port())
    environment = dict(os.environ, ROS_MASTER_URI="http://localhost:" + port, PWD=os.getcwd())  # scene.launch takes paths from there
    print("to look at its topics: export ROS_MASTER_URI=" + environment["ROS_MASTER_URI"], flush=True)
    with tempfile.TemporaryDirectory() as folder:
        done = os.path.join(folder, "done")
        environment["TISSUE_CONTACT_DONE_FILE"] = done
        # In a session of its own, so that a terminal's Ctrl-C reaches it once: through us.
        launch = subprocess.Popen(["roslaunch", "-p", port, "tissue_contact"] + arguments, env=environment,
                                  stdin=subprocess.DEVNULL, start_new_session=True)
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, lambda *_: launch.send_signal(signal.SIGINT))
        code = launch.wait()
        if code == 0 and not os.path.exists(done):
            print("run_launch.py: %s did not end well; the messages above say why" % arguments[0], file=sys.stderr)
            code = 1
        return 1 if code else 0


if __name__ == "__main__":
    if sys.argv[1:2] in (["--help"], ["-h"]):
        print(__doc__)
        sys.exit(0)
    if len(sys.argv) < 2 or not sys.argv[1].endswith(".launch"):
        sys.exit(__doc__)
    sys.exit(run(sys.argv[1:]))
