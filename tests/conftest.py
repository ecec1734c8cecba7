"""Common setup of all tests: one thread per process, the same hypothesis examples every time, and a browser."""

import os
import shutil

import pytest
from hypothesis import HealthCheck, settings

for _threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_threads, "1")  # numpy, imported later, reads it; workers and subprocesses inherit it

settings.register_profile(
    "project", derandomize=True, deadline=None, suppress_health_check=[HealthCheck.too_slow], print_blob=True
)
settings.load_profile("project")


@pytest.fixture(scope="session")
def chromium() -> str:
    """Path of a Chromium. The test is skipped if there is none (`make test` installs it where possible)."""
    found = filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome")))
    path = next(found, None)
    if path is None:
        pytest.skip("no Chromium on this machine (Debian package: chromium)")
    return path
