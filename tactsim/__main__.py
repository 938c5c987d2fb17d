"""``python -m tactsim``: the command line."""

from tactsim.cli.__main__ import main

if __name__ == "__main__":
    raise SystemExit(main())
