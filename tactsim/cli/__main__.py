"""``python -m tactsim.cli``, which must not import the files of the folder that it is started in."""

import os
import sys
from pathlib import Path

import tactsim

if not sys.flags.safe_path and not os.path.samefile(Path(tactsim.__file__).resolve().parents[1], "."):
    sys.path[:] = [folder for folder in sys.path if not (os.path.exists(folder or ".") and os.path.samefile(folder or ".", "."))]

from tactsim.cli.entry import main

if __name__ == "__main__":
    raise SystemExit(main())
