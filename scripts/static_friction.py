#!/usr/bin/python3
"""Static and kinetic friction from a ring of tissue on which a flat plate turns, again and again from rest.

  static_friction.py --scene ring.yaml --measured twist.csv

The table has time_s, z and yaw (joints of the plate: m above the untouched ring, rad), fz_n and tz_nm (force and torque on it). Prints both
coefficients, with --finer also 95 % intervals; exit code 1 if the table does not tell them. How to measure, and how exact it is: doc/calibration.md.
"""
import argparse
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))  # rosrun starts us through a relay elsewhere


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene", required=True, help="scene file, as config/calibration/ring.yaml")
    parser.add_argument("--measured", required=True, metavar="FILE", help="table (CSV)")
    parser.add_argument("--finer", action="append", default=[], metavar="KEY=VALUE", help="a key of the scene with a finer mesh or a shorter step: what "
                        "was found is then corrected to that scene")
    parser.add_argument("--tare", type=float, default=0.0, metavar="S", help="take off the mean force and torque of the first S seconds")
    return parser.parse_args()


def find(arguments):
    from fitting import FitError, breakaway, forward, measured, parameters
    forward.load_scene(arguments.scene)  # its own reader comes first: it says what is wrong
    keys = parameters.SceneKeys(arguments.scene)
    instruments = keys.instruments()
    if len(instruments) != 1:
        raise FitError("%s has %d instruments; one is needed, the plate" % (arguments.scene, len(instruments)))
    tool = forward.Tool(arguments.scene, instruments[0]["name"], {})
    (static, first), (kinetic, second) = keys.resolve("static"), keys.resolve("kinetic")
    recording = measured.tare(measured.read_twist(arguments.measured, tool.joint_names), arguments.tare)
    found, count = breakaway.find(arguments.scene, (static, kinetic), tool, recording, (first, second), parameters.settings_of(arguments.finer, "--finer"))
    print("\n%s: %d starts" % (recording.name, count))
    for name, one in zip(("static", "kinetic"), found):
        if arguments.finer:
            print("%-8s %.4f   95 %%: %.4f .. %.4f   of it noise ± %.4f, mesh and step ± %.4f" % (
                name, one.value, *one.interval(), one.noise_half, one.model_half))
        else:  # an interval without a part of it that is as large as the other does not hold the truth as often as it says
            print("%-8s %.4f   noise ± %.4f; mesh and step not known: give --finer" % (name, one.value, one.noise_half))


def main():
    sys.stdout.reconfigure(errors="backslashreplace")
    arguments = parse_arguments()
    try:
        import scipy  # noqa: F401 (looked for, before anything else says so in its own words)
        from tissue_contact import Simulator  # noqa: F401 (likewise)
        from fitting import FitError
    except ImportError as error:
        sys.exit("static_friction.py: %s (it needs python3-scipy, and `source scripts/env.bash` or setup.bash)" % error)
    try:
        find(arguments)
    except (FitError, ValueError) as error:
        sys.exit("static_friction.py: %s" % error)
    except KeyboardInterrupt:
        sys.exit("static_friction.py: interrupted")


if __name__ == "__main__":
    main()
