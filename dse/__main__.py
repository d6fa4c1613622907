"""``python -m dse``."""

import sys

if __name__ == "__main__" and not sys.flags.safe_path:
    # What lies in the current folder must not be taken for the standard library's; dse itself may lie there.
    sys.path.append(sys.path.pop(0))

from dse.cli import main

if __name__ == "__main__":
    main()
