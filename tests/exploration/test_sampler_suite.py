"""Every sampler that is found, those of installed packages too, in the suite that others run over theirs."""

from __future__ import annotations

from dse.loading.extensions import SAMPLERS
from dse.testing.samplers import SamplerSuite

for _name in SAMPLERS.names():
    globals()[f"Test_{_name}"] = type(f"Test_{_name}", (SamplerSuite,), {"sampler": SAMPLERS.get(_name)})
