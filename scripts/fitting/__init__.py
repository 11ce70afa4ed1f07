"""From measured forces back to a scene's parameters: the parts of fit.py, in reading order.

  measured.py      tables and bags of tool motion and force -> Recording
  parameters.py    --fit KEY:LOW..HIGH -> a number between 0 and 1, and the scene keys it sets
  forward.py       a scene and a recording's motion -> forces, many in parallel
  solve.py         starts, robust least squares
  uncertainty.py   intervals, correlation, and what the data do not identify
  results.py       report, picture, fitted scene
  breakaway.py     of static_friction.py: peaks and levels of a torque -> static and kinetic friction

They use NumPy, SciPy and the module tissue_contact; measured.py uses rosbag for bags.
"""


class FitError(Exception):
    """What a user did or gave, why it is refused, and what to do."""
