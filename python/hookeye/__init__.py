"""Hookeye: the elastic model of a soft object from photos under known loads.

The same engine as the program `hookeye`; docs/python.md tells the whole interface.
"""

import logging as _logging

from . import importers
from ._hookeye import Camera, __version__
from ._registered import register, unregister
from .batches import Batch, batch
from .calibration import Calibration, calibrate
from .capture import Capture
from .catalogue import effects, options
from .contract import check_effect, check_sensor
from .effect import Effect, Setup
from .equilibrium import Equilibrium
from .errors import Cancelled, EffectError, InputError, NumericalError, SensorError, UnknownName
from .kinematics import cofactor, determinant, invariants
from .measured_field import MeasuredField
from .model import Evaluation, Model, Parameter, Picture
from .progress import Progress, ProgressBar
from .run import Diagnosis, Field, Run, Step, discover, fit
from .sensor import Sensor
from .tables import Table
from .threads import set_threads

# A library leaves it to the program that uses it what is logged where.
_logging.getLogger("hookeye").addHandler(_logging.NullHandler())

__all__ = [
    "Batch", "Calibration", "Camera", "Cancelled", "Capture", "Diagnosis", "Effect", "EffectError", "Equilibrium",
    "Evaluation", "Field", "InputError", "MeasuredField", "Model", "NumericalError", "Parameter", "Picture",
    "Progress", "ProgressBar", "Run", "Sensor", "SensorError", "Setup", "Step", "Table",
    "UnknownName", "__version__", "batch",
    "calibrate", "check_effect", "check_sensor", "cofactor", "determinant", "discover", "effects", "fit", "importers", "invariants",
    "options", "register", "set_threads", "unregister",
]
