"""Points of a unit cube that fill each of its axes evenly; sweep/study.py takes them from here as well."""
import numpy


def latin_hypercube(count, dimensions, seed):
    """(count, dimensions): along each axis one in each of `count` equal parts. McKay, Beckman & Conover, Technometrics 21 (1979).

    Not scipy.stats.qmc, which is of SciPy 1.7: Ubuntu 20.04 has 1.3.
    """
    random = numpy.random.default_rng(seed)
    parts = numpy.array([random.permutation(count) for _ in range(dimensions)]).reshape(dimensions, count)
    return ((parts + random.random(parts.shape)) / max(count, 1)).T
