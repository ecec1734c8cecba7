"""Exit with one sentence unless this Python can create the project's virtual environment. Runs on any Python."""

import importlib
import sys

MINIMUM = (3, 11)
MAXIMUM = (3, 13)


def complaint():
    """Return a sentence that names what is missing, or None."""
    if not MINIMUM <= sys.version_info[:2] <= MAXIMUM:
        return "ictamp_drake needs Python %d.%d to %d.%d, and %s is %d.%d; name another: make PYTHON=python3.12 ..." % (
            MINIMUM + MAXIMUM + (sys.executable,) + tuple(sys.version_info[:2])
        )
    try:
        importlib.import_module("venv")
        importlib.import_module("ensurepip")
    except ImportError:
        return "%s cannot make virtual environments; on Debian, Ubuntu: apt-get install python3-venv" % sys.executable
    return None


if __name__ == "__main__":
    sys.exit(complaint())
