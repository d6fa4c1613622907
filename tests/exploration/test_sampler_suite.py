"""Every sampler that is found, those of installed packages too, in the suite that others run over theirs."""

from __future__ import annotations

from dse.loading.extensions import SAMPLERS
from dse.testing.samplers import SamplerSuite

for _name in SAMPLERS.names():
    _members = {"sampler": SAMPLERS.get(_name), "listed": _name == "csv"}
    globals()[f"Test_{_name}"] = type(f"Test_{_name}", (SamplerSuite,), _members)
