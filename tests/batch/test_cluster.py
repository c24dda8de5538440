"""Tasks on a Dask cluster."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from distributed import LocalCluster

import fissura.batch.cluster as cluster
from fissura.batch.cluster import on_cluster


def test_a_cluster_may_get_its_workers_later(monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture) -> None:
    taken, told = [], []

    def tasks() -> Iterator[int]:
        for task in range(1, 6):
            taken.append(task)
            yield task

    monkeypatch.setattr(cluster, "_AHEAD", 2)
    monkeypatch.setattr(cluster, "_LOOK", 0.05)
    monkeypatch.setattr(cluster, "_ALONE", 0.1)
    with LocalCluster(n_workers=0, threads_per_worker=1, processes=False, dashboard_address=None) as processes:

        def tell(record: object) -> None:
            told.append(record)
            processes.scale(1)

        monkeypatch.setattr(caplog.handler, "emit", tell)
        cluster.check_scheduler(processes)
        arriving = on_cluster(lambda task: 10 * task, tasks(), processes)
        first, result, error = next(arriving)
        assert (first, result, error, taken, len(told)) == (1, 10, None, [1, 2], 1)
        assert sorted((task, result) for task, result, _ in arriving) == [(k, 10 * k) for k in (2, 3, 4, 5)]
