#!/usr/bin/python3
"""Fits numbers of a scene to measured forces: stiffness, damping, friction, thickness, the height of first touch.

  fit.py --scene S.yaml --measured press.csv --measured drag.bag --fit youngs_modulus_pa:1e3..1e5 --fit kinetic --fit offset_m

Each recording moves the tool of the scene as it was moved, from rest, and the forces on it are compared. Prints estimates with 95 % intervals,
their correlation, the error of predicting held-out data, and which parameters these data do not identify: then nothing is written, and the exit
code is 1. With --out, a folder with the fitted scene.yaml, fit.yaml, residuals.csv and residuals.png. How to measure, and how exact it is:
doc/calibration.md.
"""
import argparse
import math
import os
import shlex
import sys

import numpy

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))  # rosrun starts us through a relay elsewhere
from whole_file import whole_file


def parse_arguments():
    def number(low, high):
        def read(text):
            value = float(text)
            if not low <= value <= high:
                raise argparse.ArgumentTypeError("%s is not from %g to %g" % (text, low, high))
            return value
        return read

    def whole(low, high):
        return lambda text: int(number(low, high)(str(int(text))))

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene", required=True, help="scene file; what is not fitted is as it says")
    parser.add_argument("--measured", required=True, action="append", metavar="FILE", help="table (CSV) or bag; give it again for more")
    parser.add_argument("--fit", required=True, action="append", metavar="KEY[:LOW..HIGH[:START]]",
                        help="a number of the scene, by the end of its path or all of it; thickness_m of a block; offset_m: how much deeper "
                             "along --approach the tool is than recorded. Common ones have bounds of their own")
    parser.add_argument("--held-out", action="append", default=[], metavar="FILE", help="recording that is predicted, not fitted; "
                        "without one a fifth of every recording is")
    parser.add_argument("--finer", action="append", default=[], metavar="KEY=VALUE", help="a key of the scene with a finer mesh or a shorter "
                        "step, as --set of tissue_contact_replay has it: what was found is then corrected to that scene, for the price of a "
                        "few runs of it")
    parser.add_argument("--out", metavar="FOLDER", help="for the fitted scene, figures and plot")
    parser.add_argument("--instrument", help="whose motion and force were measured; needed where the scene has several")
    parser.add_argument("--force-topic", default="/force_sensor", help="of bags, WrenchStamped; default: %(default)s")
    parser.add_argument("--pose-topic", metavar="TOPIC", help="of bags, PoseStamped or TransformStamped: poses of the scene's tip_link in its world, "
                        "in place of joint states")
    parser.add_argument("--force-on", choices=["tool", "tissue"], default="tool", help="on what the measured force acts; default: %(default)s")
    parser.add_argument("--axes", choices=["world", "tip"], default="world", help="in which axes forces were measured; default: %(default)s")
    parser.add_argument("--approach", type=number(-1e6, 1e6), nargs=3, default=[0.0, 0.0, -1.0], metavar=("X", "Y", "Z"),
                        help="direction of the tool towards the tissue, in the world; default: 0 0 -1")
    parser.add_argument("--tare", type=number(0.0, 1e4), default=0.0, metavar="S", help="take off the mean force of the first S seconds")
    parser.add_argument("--smooth", action="append", default=[], metavar="[RECORDING=]S",
                        help="smooth the motion over S seconds: of all recordings, or of one by its file's name without .csv or .bag")
    parser.add_argument("--rate", type=number(0.0, 1e4), default=0.0, metavar="HZ", help="thin recordings to this rate by means; default: as recorded")
    parser.add_argument("--starts", type=whole(0, 1000), default=8, help="points of a Latin hypercube tried besides the scene's; default: %(default)s")
    parser.add_argument("--seed", type=whole(0, 2 ** 31), default=1, help="of the hypercube; default: %(default)s")
    parser.add_argument("--workers", type=whole(1, 1024), default=os.cpu_count() or 1, help="runs at once; the answer does not depend on it")
    return parser.parse_args()


def instrument_of(keys, name):
    from fitting import FitError
    known = {one.get("name"): one for one in keys.instruments()}
    if name is None and len(known) == 1:
        return next(iter(known.values()))
    if name not in known:
        raise FitError("--instrument %s: %s has %s; give one of them" % (name or "is missing", keys.path, ", ".join(map(str, known)) or "no instrument"))
    return known[name]


def joint_topics(instrument):
    return [topic["topic"] if isinstance(topic, dict) else topic for topic in instrument.get("joint_state_topics", [])]


def smoothing(arguments):
    """{recording: seconds}, with None for those that are not named."""
    from fitting import FitError, measured
    windows = {None: 0.0}
    known = [measured.name_of(path) for path in arguments.measured + arguments.held_out]
    for text in arguments.smooth:
        name, equals, seconds = measured.printable(text).rpartition("=")
        try:
            window = float(seconds)
        except ValueError:
            window = math.nan
        if not 0.0 <= window <= 1e3:
            raise FitError("--smooth '%s' is not S or RECORDING=S with S from 0 to 1000 s" % text)
        if equals and name not in known:
            raise FitError("--smooth '%s': there is no recording '%s'; given are %s" % (text, name, ", ".join(known)))
        windows[name if equals else None] = window
    return windows


def require_each_once(paths):
    """What is fitted twice counts twice, and what is held out must not be fitted."""
    from fitting import FitError, measured
    for i, path in enumerate(paths):
        for other in paths[:i]:
            if measured.name_of(path) == measured.name_of(other) and os.path.realpath(path) != os.path.realpath(other):
                raise FitError("%s and %s have the same name, by which the report and --smooth know them; rename one" % (other, path))
            if os.path.exists(path) and os.path.exists(other) and os.path.samefile(path, other):
                raise FitError("%s is given twice, as --measured or --held-out; give each recording once" % path)


def require_world(path, recording, world):
    """Poses in other axes are of another place."""
    from fitting import FitError, measured
    if recording.pose_frame not in ("", world):
        frame = measured.printable(recording.pose_frame)
        raise FitError("%s: its poses are in frame '%s', the scene's world_frame is '%s'; if the scene's tissues are placed in '%s', set world_frame: %s in "
                       "the scene; else turn the poses into the scene's world, and give them as a table" % (path, frame, world, frame, frame))


def prepared(arguments, path, tool, topics, frames):
    """frames: {--axes: name of that frame}."""
    from fitting import measured
    windows = smoothing(arguments)
    recording = measured.read(path, tool.recorded_names(), topics, arguments.force_topic, arguments.pose_topic)
    require_world(path, recording, frames["world"])
    recording = measured.smooth(measured.tare(recording, arguments.tare), windows.get(recording.name, windows[None]))
    recording = measured.thin(recording, arguments.rate)
    if recording.force_frame not in ("", frames[arguments.axes]):
        print("%s: forces are in frame '%s'; they are taken to be in the axes of the %s, '%s' (--axes %s)" % (
            recording.name, measured.printable(recording.force_frame), arguments.axes, frames[arguments.axes], arguments.axes))
    if arguments.force_on == "tissue":
        recording.force_n = -recording.force_n
    if arguments.axes == "tip":
        recording.force_n = tool.to_world(recording, tool.motion(recording))
    return recording


def require_folder(folder):
    """Before the fit, which may take long; it is made after it."""
    from fitting import FitError, measured
    if folder and measured.printable(os.path.abspath(folder)) != os.path.abspath(folder):
        raise FitError("--out: %s is not UTF-8, which a scene's file must be; give another folder" % os.path.abspath(folder))
    place = os.path.abspath(folder or ".")
    while not os.path.exists(place):
        place = os.path.dirname(place)
    if not os.path.isdir(place) or not os.access(place, os.W_OK):
        raise FitError("--out %s: %s is no folder that can be written to; give another" % (folder, place))


def fit(arguments):
    from fitting import FitError, fitted_scene, forward, measured, parameters, results, run
    length = math.sqrt(sum(x * x for x in arguments.approach))
    if not length > 1e-6:
        raise FitError("--approach %g %g %g has no direction" % tuple(arguments.approach))
    scene = forward.load_scene(arguments.scene)  # its own reader comes first: it bounds what it reads, and says what is wrong
    keys = parameters.SceneKeys(arguments.scene)
    instrument = instrument_of(keys, arguments.instrument)
    tool = forward.Tool(arguments.scene, instrument["name"], instrument.get("joint_names") or {})
    fitted = parameters.parse_fits(arguments.fit, keys)
    finer = parameters.settings_of(arguments.finer, "--finer")
    forward.load_scene(arguments.scene, finer)
    require_folder(arguments.out)
    require_each_once(arguments.measured + arguments.held_out)
    frames = {"world": scene.world_frame, "tip": instrument.get("tip_link", "")}
    setup = run.Setup(arguments.scene, keys, tool, fitted, numpy.array(arguments.approach) / length, forward.Workers(arguments.workers),
                      arguments.starts, arguments.seed, lambda line: print(line, flush=True))
    if arguments.out:  # whether the keys can be written, before the fit
        fitted_scene.fitted_text(arguments.scene, dict(setup.settings([one.low for one in fitted]), **finer), arguments.out, [])
    recordings, held_out = [[prepared(arguments, path, tool, joint_topics(instrument), frames) for path in paths]
                            for paths in (arguments.measured, arguments.held_out)]
    for one in fitted:
        setup.say("%s from %g to %g %s" % (one.key, one.low, one.high, one.unit))
    answer, quality, problem, costs = run.fit(setup, recordings, held_out, finer=finer)
    print("\n" + results.report(answer, problem, quality, costs))
    if answer.unidentified:
        print("\nnothing was written" if arguments.out else "")
        return 1
    if arguments.out:
        names = results.write(arguments.out, setup, finer, answer, problem, quality, measured.printable("fit.py " + shlex.join(sys.argv[1:])),
                              [arguments.scene] + arguments.measured + arguments.held_out, whole_file)
        print("\nwritten: " + ", ".join(names))
    return 0


def main():
    for stream in (sys.stdout, sys.stderr):
        stream.reconfigure(errors="backslashreplace")  # file names need not be UTF-8
    arguments = parse_arguments()
    try:
        import scipy  # noqa: F401 (looked for, before anything else says so in its own words)
        from tissue_contact import Simulator  # noqa: F401 (likewise)
        from fitting import FitError
    except ImportError as error:
        sys.exit("fit.py: %s (fit.py needs python3-scipy, and `source scripts/env.bash` or setup.bash)" % error)
    try:
        sys.exit(fit(arguments))
    except (FitError, ValueError) as error:
        sys.exit("fit.py: %s" % error)
    except KeyboardInterrupt:
        sys.exit("fit.py: interrupted; nothing was written")
    except OSError as error:
        sys.exit("fit.py: cannot write %s: %s" % (error.filename or arguments.out, error.strerror))


if __name__ == "__main__":
    main()
