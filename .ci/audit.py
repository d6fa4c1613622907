"""Looks the locked versions up among known weaknesses; where that list cannot be reached, says so and fails nothing."""

import json
import subprocess
import sys
from pathlib import Path

LOCK = Path(__file__).parents[1] / "requirements.lock"

options = ["--requirement", str(LOCK), "--no-deps", "--disable-pip", "--format", "json"]
answer = subprocess.run([sys.executable, "-m", "pip_audit", *options], capture_output=True, text=True, check=False)
try:
    asked = json.loads(answer.stdout)["dependencies"]
except ValueError:
    asked = []
known = [entry for entry in asked if "skip_reason" not in entry]
found = [(entry, weakness) for entry in known for weakness in entry["vulns"]]
for entry, weakness in found:
    mended = ", ".join(weakness["fix_versions"]) or "nothing yet"
    print(f"{entry['name']} {entry['version']}: {weakness['id']}, mended in {mended}")
if not known:
    print("audit: the list of known weaknesses is not reachable, skipped")
else:
    print(f"audit: {len(found)} known weaknesses in {len(known)} of {len(asked)} packages that could be looked up")
sys.exit(bool(found))
