"""Flexible open shells in 2D: worlds with contact and friction, a laboratory, and the diagnosis of recordings.

    import supercircle as sc
    r = sc.run("two_shells", mu=0.2)
    r.series["force_N"]

SI units, angles in rad. Arrays are NumPy copies. Refused calls raise sc.Error.
"""

try:
    import numpy as _numpy  # noqa: F401
except ImportError as _error:
    raise ImportError("supercircle needs NumPy, and this Python has none: install python3-numpy and call /usr/bin/python3, "
                      "or install numpy into this Python") from _error

from ._files import scenes
from ._loader import library_path, version
from .errors import (BadInputError, BusyError, Error, FailedError, LibraryError, OutOfMemoryError, RefusedError, StaleError,
                     VersionError)
from .lab import (Check, Curve, Diagnosis, Effect, Estimate, Imported, Nominal, Replay, Result, Series, Sweep, check, diagnose,
                  import_recording, replay, run, sweep)
from .records import (BodyState, Energy, EventSettings, Filter, Frame, Reaction, Recovery, Section, ShellState, Sleep, Target)
from .world import (Body, DrawList, Event, Force, Hit, Hold, Joint, MouseJoint, Problem, Scene, Shell, World, Zone, check_scene, effects,
                    scaled_shell, wav)

__version__ = "0.2.0"
