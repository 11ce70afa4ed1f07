#!/usr/bin/python3
"""Prints the URDF of a robot model for the launch files' argument model:=, which loads it into ~robot_description.

usage: read_model.py MODEL SCENE
  MODEL  a .urdf, or a .xacro where the package xacro is installed; a path or package://PACKAGE/PATH
  SCENE  the scene that is to use it; refused if no instrument of it takes its URDF from robot_description
"""
import os
import re
import shutil
import subprocess
import sys
from urllib.parse import unquote

import rospkg
import yaml

PARAMETER = "robot_description"


def fail(message):
    sys.exit("read_model.py: " + message)


def resolved(path):
    if path.startswith("file://"):
        return unquote(path[len("file://"):])
    if not path.startswith("package://"):
        return path
    package, _, rest = unquote(path[len("package://"):]).partition("/")
    try:
        return os.path.join(rospkg.RosPack().get_path(package), rest)
    except rospkg.ResourceNotFound:
        fail("%s: the package %s is not known; install it or source its setup file" % (path, package))


def require_use(scene):
    """A scene that names its own URDF would take no notice of the model."""
    try:
        with open(resolved(scene), encoding="utf-8") as stream:
            instruments = (yaml.safe_load(stream) or {}).get("instruments") or []
        names = [instrument.get("name") for instrument in instruments if "urdf" in instrument]
        used = any("urdf" not in instrument and instrument.get(PARAMETER, PARAMETER) == PARAMETER
                   for instrument in instruments)
    except (OSError, UnicodeDecodeError, yaml.YAMLError, AttributeError):
        return  # the node says what is wrong with the scene
    if not used:
        fix = "without the key urdf of '%s'" % names[0] if names else "with robot_description: robot_description"
        fail("model:= would change nothing: no instrument of %s takes its URDF from the parameter %s; make a copy of the "
             "scene %s and give it as scene:=" % (scene, PARAMETER, fix))


def decoded(data):
    """The text of XML, whose first line may name an encoding; a parameter's is UTF-8."""
    declared = re.match(rb"""(?:\xef\xbb\xbf)?\s*<\?xml[^>]*?encoding\s*=\s*["']([A-Za-z0-9._-]+)["']""", data)
    if not declared:
        return data.decode("utf-8-sig")
    text = data[:declared.start(1)] + b"UTF-8" + data[declared.end(1):]
    return text.decode(declared[1].decode()).lstrip("\ufeff")


def text_of(model):
    path = resolved(model)
    if not os.path.isfile(path):
        fail("%s does not exist; correct model:=" % path)
    if not path.endswith(".xacro"):
        try:
            with open(path, "rb") as stream:
                return decoded(stream.read())
        except (OSError, ValueError, LookupError) as error:
            fail("%s cannot be read: %s; save it as UTF-8" % (path, error))
    xacro = shutil.which("xacro")
    if not xacro:
        fail("%s is a xacro file and xacro is not installed here (Debian 12 has no package of it). Where it is: "
             "xacro %s > model.urdf; then give model:=model.urdf" % (path, path))
    done = subprocess.run([xacro, path], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          universal_newlines=True, check=False)
    if done.returncode != 0:
        fail("xacro %s ended with exit code %d: %s" % (path, done.returncode, done.stderr.strip()))
    return done.stdout


def main():
    if sys.argv[1:2] in (["--help"], ["-h"]):
        print(__doc__)
        return
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    require_use(sys.argv[2])
    sys.stdout.write(text_of(sys.argv[1]))


if __name__ == "__main__":
    main()
