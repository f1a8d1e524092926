"""Fixtures: one Ray cluster for all tests of a process, and SLURM jobs as local processes."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from mitigate.cluster.launcher import RayConfig, SlurmConfig

# Ray notices after 15 seconds that a worker died at its start (Ray's default is a minute).
HEAD = {
    "num_cpus": 1,
    "include_dashboard": False,
    # With Ray's default niceness of 15, workers get too little CPU time on a busy machine.
    "_system_config": {"worker_register_timeout_seconds": 15, "worker_niceness": 0},
}


@pytest.fixture(scope="session")
def cluster():
    """Start a Ray test cluster: three nodes on this machine with one CPU each."""
    ray = pytest.importorskip("ray", reason="ray is not installed (the extra cluster)")
    from ray.cluster_utils import Cluster

    path = os.environ.get("PYTHONPATH")
    os.environ["PYTHONPATH"] = os.pathsep.join([str(Path(__file__).parents[2]), path or ""])
    built = Cluster(initialize_head=True, head_node_args=HEAD)
    built.nodes = [built.add_node(num_cpus=1) for _ in range(2)]
    ray.init(address=built.address, log_to_driver=False)
    yield built
    ray.shutdown()
    built.shutdown()


@pytest.fixture
def ray_launcher(cluster):
    return RayConfig(cpus=1)


@pytest.fixture
def slurm_launcher(tmp_path, monkeypatch):
    """Return a launcher whose SLURM jobs are processes on this machine."""
    pytest.importorskip("submitit", reason="submitit is not installed (the extra cluster)")
    from submitit.core.core import Job

    # the folder is local, so the result of a finished job is either there at once or missing
    monkeypatch.setattr(Job, "_results_timeout_s", 1)

    def make(**settings):
        settings = {"processes": 1, "minutes": 2, **settings}
        return SlurmConfig(cluster="local", folder=str(tmp_path / "slurm"), **settings)

    return make
