"""tissue_contact_replay from Python: joint states of a bag through a scene, wrenches as arrays."""
import math
import os
import struct

from tissue_contact import _replay
from tissue_contact._core import Scene
from tissue_contact._helpers import settings

_FNV_OFFSET, _FNV_PRIME = 14695981039346656037, 1099511628211  # of LockStep::digest() in C++


class Replayed:
    """What a replay gave: numbers of the CSV file that tissue_contact_replay writes, to the last bit."""

    def __init__(self, rows, instruments, log):
        self.rows = rows  # structured array, a row per line of the CSV
        self.instruments = instruments  # names, in the order of the scene
        self.log = log  # what the program says: warnings and a summary

    def of(self, instrument):
        """Rows of one instrument."""
        if instrument not in self.instruments:
            raise ValueError("the scene has no instrument %r; it has: %s" % (instrument, ", ".join(self.instruments)))
        return self.rows[self.rows["instrument"] == self.instruments.index(instrument)]

    def stamps(self, instrument):
        """(n,) s; rows["stamp_ns"] has them exactly."""
        return self.of(instrument)["stamp_ns"] * 1e-9

    def wrenches(self, instrument):
        """(n, 6): force (N) and torque (N m) on the instrument, at the origin and in the axes of its tip link."""
        return self.of(instrument)["wrench"]

    def tip_poses(self, instrument):
        """(n, 7): position (m) and quaternion x, y, z, w of the tip link in the world."""
        return self.of(instrument)["tip"]

    def digest(self):
        """Of all wrenches with their stamps, to compare runs with: that of TissueFixture and LockStep."""
        digest = _FNV_OFFSET
        for row in self.rows:
            for word in struct.unpack("<7Q", struct.pack("<q6d", row["stamp_ns"], *row["wrench"])):
                digest = (digest ^ word) * _FNV_PRIME % 2 ** 64
                digest ^= digest >> 29
        return digest


def replay(scene, bag, *, set=None, csv=None, urdf=None, from_s=0.0, duration_s=math.inf, changes=""):
    """Plays the joint states of a bag through a scene, as tissue_contact_replay does: the same bits. No roscore.

    scene, bag: files. set: {key: value} of the scene. csv: file to write as well. urdf: file for the parameter a scene takes its URDF
    from. from_s, duration_s: part of the recording. changes: topic of recorded changes, "none", or "" for the only one there.
    Other threads run meanwhile. Raises ValueError or RuntimeError with the program's message.
    """
    if not (math.isfinite(from_s) and from_s >= 0.0):
        raise ValueError("from_s is %s; it must be finite and not negative" % from_s)
    if not duration_s > 0.0:
        raise ValueError("duration_s is %s; it must be more than 0" % duration_s)
    if isinstance(scene, Scene):
        raise TypeError("scene must be a file, and not what load_scene() makes of it; give that file, and its set={...}")
    files = ["" if one is None else os.fspath(one) for one in (csv, urdf)]
    return Replayed(*_replay.replay(os.fspath(scene), os.fspath(bag), settings(set), files[0], files[1], from_s, duration_s, changes))


