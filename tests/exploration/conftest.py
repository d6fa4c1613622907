"""Makes the fakes of this folder importable by name, here and in worker processes (spawn hands sys.path on)."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
