"""What the binding asks of Python: packages, settings as text, a log."""
import json
import logging

import tissue_contact


def package_directory(name):
    """Directory of a ROS package, "" where it is not found: what rospack finds."""
    try:
        import rospkg
    except ImportError as error:
        raise ValueError("package://%s: packages are found by rospkg; install python3-rospkg" % name) from error
    try:
        return rospkg.RosPack.get_instance().get_path(name)  # has crawled once per ROS_PACKAGE_PATH
    except rospkg.ResourceNotFound:
        return ""


def _number(value):
    """Of NumPy: what JSON does not know."""
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError("set: a value must be text, a number, a bool, or a list or dict of those, not %s" % type(value))


def settings(given):
    """["KEY=VALUE"] of {key: value}: what --set takes on the command line, and which may be given as it is. Floats keep all their digits."""
    if given is None:
        return []
    if isinstance(given, (list, tuple)) and all(isinstance(one, str) for one in given):
        return list(given)
    if not isinstance(given, dict):
        raise TypeError("set must be a dict {key: value} or a list of 'KEY=VALUE', not %s" % type(given))
    found = []
    for key, value in given.items():
        if not isinstance(key, str):
            raise TypeError("set: a key must be text, not %s" % type(key))
        found.append("%s=%s" % (key, value if isinstance(value, str) else json.dumps(value, default=_number)))
    return found


def load_scene_again(file, given):
    """Of a pickle: a compiled function has no name that pickle could write."""
    return tissue_contact.load_scene(file, given)


def parse_scene_again(yaml, file, given):
    """Of a pickle, as load_scene_again()."""
    return tissue_contact.parse_scene(yaml, file, given)


def say(line):
    """Progress of long preparations."""
    logging.getLogger("tissue_contact").info(line)
