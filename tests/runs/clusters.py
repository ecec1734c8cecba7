"""A Ray cluster on this machine, with one core per node."""

from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from ray.cluster_utils import Cluster

MEMORY = 100_000_000
"""Memory of each node for the results of tasks [bytes]."""


@contextmanager
def two_nodes() -> Iterator[Cluster]:
    """A head and another node, which may die."""
    with pytest.MonkeyPatch.context() as environment:
        environment.setenv("RAY_ENABLE_UV_RUN_RUNTIME_ENV", "0")
        cluster = Cluster(
            initialize_head=True,
            head_node_args={"num_cpus": 1, "object_store_memory": MEMORY, "include_dashboard": False},
        )
        cluster.add_node(num_cpus=1, object_store_memory=MEMORY)
        try:
            yield cluster
        finally:
            cluster.shutdown()
