"""Processes of this machine: nobody else reaches them."""

from __future__ import annotations

import os
import socket
import ssl
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import psutil
import pytest
from distributed import Client
from distributed.security import Security
from typer.testing import CliRunner

import fissura.ensemble.cluster as cluster
from fissura.case import Case
from fissura.cli import app
from fissura.ensemble.cluster import check_scheduler, connected, outcomes
from fissura.ensemble.local import LocalProcesses
from fissura.ensemble.outcome import Outcome
from fissura.ensemble.plan import Plan, Task
from fissura.errors import EnsembleStopped


def listening() -> set[int]:
    """Ports on which this process and those that it started wait for others."""
    me = psutil.Process()
    return {
        connection.laddr.port
        for process in (me, *me.children(recursive=True))
        for connection in process.net_connections(kind="inet")
        if connection.status == psutil.CONN_LISTEN
    }


def greeted(port: int, context: ssl.SSLContext) -> bool:
    """Whether what listens there says anything to someone with these credentials."""
    context.check_hostname = False
    context.verify_mode = ssl.CERT_NONE  # whoever comes uninvited does not care whom they meet
    try:
        with (
            socket.create_connection(("127.0.0.1", port), timeout=10.0) as plain,
            context.wrap_socket(plain) as secured,
        ):
            return len(secured.recv(1)) == 1
    except (ssl.SSLError, ConnectionError):
        return False


@pytest.mark.skipif(sys.platform == "darwin", reason="connections of other processes need special rights there")
def test_no_one_else_gets_through_to_any_port() -> None:
    before = listening()
    with connected(1) as client:
        ports = listening() - before
        own = client.security.get_connection_args("client")["ssl_context"]
        stranger = Security.temporary().get_connection_args("client")["ssl_context"]
        nobody = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
        # Scheduler, nanny and worker, and no web page beside them.
        assert len(ports) == 3
        for port in ports:
            assert greeted(port, own)
            assert not greeted(port, stranger)
            assert not greeted(port, nobody)
        address = client.scheduler.address
        assert address.startswith("tls://127.0.0.1:")
        for place, credentials in ((address, Security.temporary()), (address.replace("tls", "tcp"), None)):
            with pytest.raises(OSError, match=r"TLS certificate|Timed out|reset by peer|closed"):
                Client(place, security=credentials, timeout="1s", set_as_default=False)
        # Whoever has the cluster has its credentials.
        check_scheduler(client.cluster)
        with connected(0, scheduler=client.cluster) as other:
            assert other.submit(int, "7").result() == 7


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Lose patience soon."""
    monkeypatch.setattr(cluster, "_HEAL", 0.05)
    monkeypatch.setattr(cluster, "_ALONE", 0.1)


@pytest.mark.usefixtures("quick")
def test_no_worker_at_all_ends_the_ensemble(tiny: Callable[..., Case]) -> None:
    with (
        LocalProcesses(0) as processes,
        connected(0, scheduler=processes) as client,
        pytest.raises(EnsembleStopped, match="no worker process could be started"),
    ):
        next(outcomes(client, Plan(tiny(), 1).tasks()))


@pytest.mark.usefixtures("quick")
def test_a_cluster_may_get_its_workers_later(
    tiny: Callable[..., Case], monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    taken = []

    def tasks() -> Iterator[Task]:
        for task in Plan(tiny(), 5, companions="none").tasks():
            taken.append(task.number)
            yield task

    monkeypatch.setattr(cluster, "compute", lambda task: Outcome(task, "finished"))
    monkeypatch.setattr(cluster, "_AHEAD", 2)
    with LocalProcesses(0) as processes, connected(0, scheduler=processes) as client:
        client.cluster = None  # of somebody else
        arriving = outcomes(client, tasks())
        monkeypatch.setattr(caplog.handler, "emit", lambda record: processes.scale(1))
        first = next(arriving)
        assert (first.task.number, taken) == (1, [1, 2])
        assert sorted(outcome.task.number for outcome in arriving) == [2, 3, 4, 5]


def test_a_worker_that_dies_while_it_starts_is_no_crash(
    tiny_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As for lack of memory: new processes end before they have begun."""
    (tmp_path / "sitecustomize.py").write_text('import os, sys\nif "spawn" in str(sys.orig_argv):\n    os._exit(9)\n')
    monkeypatch.setenv("PYTHONPATH", str(tmp_path), prepend=os.pathsep)
    folder = tmp_path / "out"
    done = CliRunner().invoke(app, ["ensemble", str(tiny_file), "--runs", "3", "--output", str(folder)])
    assert done.exit_code == 3
    *_, last = done.stderr.splitlines()
    assert last.startswith("error: a worker process died while it started, perhaps for lack of memory (")
    assert last.endswith(f"what has ended is saved in {folder}; the same command with --resume goes on from there")
    assert "Traceback" not in done.stderr
