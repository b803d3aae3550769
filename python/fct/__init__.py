"""Strength of torn soft tissue from tearing tests, and the physical effect that a model lacks.

The engine is that of the command ``fct``: the same input gives the same numbers, to the last bit. Units everywhere: mm,
N, s, MPa (= N/mm²), rad; where a name ends in a unit (``length_mm``, ``mu_kPa``) it is that one.

>>> import fct
>>> strip = fct.Specimen(length_mm=8, width_mm=6, thickness_mm=0.8, tests=[
...     fct.Test("uniaxial", protocol=[{"to_mm": 0.4, "rate_mm_per_s": 0.05}])])
>>> run = fct.simulate(strip, fct.Model(mesh={"divisions": [4, 4, 1]}, solver={"step_mm": 0.2}))
>>> list(run.tests["uniaxial"].columns[:3])
['time_s', 'displacement_mm', 'force_N']
"""

from . import campaign
from ._fct import ComputeError, FctError, InputError, Interrupted, __version__
from .analyses import Problem, check, diagnose, discover, effects, identify, simulate
from .case import Model, Specimen, Test
from .own import Trial, try_law
from .records import Record, read_record
from .results import Diagnosis, Discovery, Fit, Ladder, Simulation, ladder

__all__ = [
    "ComputeError",
    "Diagnosis",
    "Discovery",
    "FctError",
    "Fit",
    "InputError",
    "Interrupted",
    "Ladder",
    "Model",
    "Problem",
    "Record",
    "Simulation",
    "Specimen",
    "Test",
    "Trial",
    "__version__",
    "campaign",
    "check",
    "diagnose",
    "discover",
    "effects",
    "identify",
    "ladder",
    "read_record",
    "simulate",
    "try_law",
]
