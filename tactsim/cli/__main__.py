"""``python -m tactsim.cli``, which must not import the files of the folder that it is started in."""

import os
import sys
from pathlib import Path

import tactsim

if not sys.flags.safe_path and Path(tactsim.__file__).resolve().parents[1] != Path(os.getcwd()).resolve():
    sys.path[:] = [folder for folder in sys.path if os.path.realpath(folder or ".") != os.path.realpath(".")]

from tactsim.cli.entry import main

if __name__ == "__main__":
    raise SystemExit(main())
