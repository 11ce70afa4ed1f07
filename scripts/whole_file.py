"""Results that are whole or absent, and that replace nothing but results: for the scripts beside this file."""
import contextlib
import errno
import os
import stat
import tempfile


def refuse(path, why):
    raise OSError(errno.EINVAL, why, path)


def refuse_unless_result(path, inputs):
    """Only a regular file may be replaced, and none that was read."""
    try:
        found = os.lstat(path)
    except FileNotFoundError:
        return None
    for name in inputs:
        if os.path.exists(path) and os.path.exists(name) and os.path.samefile(path, name):
            refuse(path, "it is the same file as the input %s; give another name" % name)
    if stat.S_ISLNK(found.st_mode):
        refuse(path, "it is a symbolic link to %s; give the path of the file itself" % os.readlink(path))
    if not stat.S_ISREG(found.st_mode):
        refuse(path, "it is a directory, a device, a FIFO or a socket; give the name of a file")
    if not os.access(path, os.W_OK):
        refuse(path, "it is there and write-protected")
    return found


def permissions(found):
    """Those of the file that is replaced, or what the user's mask leaves."""
    if found:
        return stat.S_IMODE(found.st_mode)
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask


@contextlib.contextmanager
def whole_file(path, inputs=()):
    """Yields the name of an empty file beside `path` that nobody could foresee. When the block ends well it takes the place
    of `path`; else it is removed. OSError says what is wrong (strerror)."""
    found = refuse_unless_result(path, inputs)
    folder, name = os.path.split(path)
    handle, part = tempfile.mkstemp(prefix=name[:200] + ".partial-", suffix=os.path.splitext(name)[1], dir=folder or ".")
    os.close(handle)
    try:
        yield part
        os.chmod(part, permissions(found))
        refuse_unless_result(path, inputs)
        os.replace(part, path)
    except BaseException:
        with contextlib.suppress(FileNotFoundError):
            os.remove(part)
        raise
