"""Dask on this machine alone, out of reach of other users of it.

Whoever reaches a Dask scheduler can have any code run by the user who started it. Local schedulers listen on a port of
this machine, which every user of it reaches, so that a port alone is no protection. Here all processes speak TLS and
show each other a certificate that is made for this one ensemble and kept in memory: without its key no connection gets
through. (Dask knows no Unix sockets, and processes that share none of their memory need some transport.) The web pages
that schedulers and workers of Dask offer beside it ask for no certificate, so there are none.
"""

from __future__ import annotations

import logging
from typing import Any

from distributed import Nanny, Scheduler, Worker
from distributed.deploy.spec import SpecCluster
from distributed.security import Security

__all__ = ["LocalProcesses"]

_HOST, _PROTOCOL = "127.0.0.1", "tls://"


class _NoPages:
    """A node of Dask that serves no web pages, and opens no port for them."""

    def start_http_server(self, *arguments: Any, **options: Any) -> None:
        """Start nothing."""


class _Scheduler(_NoPages, Scheduler):
    """Scheduler without web pages."""


class _Worker(_NoPages, Worker):
    """Worker without web pages."""


class LocalProcesses(SpecCluster):
    """A scheduler in this process, and workers of one thread that only this process can give work to.

    Parameters
    ----------
    workers : int
        Number of worker processes.
    """

    def __init__(self, workers: int) -> None:
        security = Security.temporary()
        common = {"host": _HOST, "protocol": _PROTOCOL, "security": security, "dashboard": False}
        options = {
            "nthreads": 1,
            "memory_limit": None,
            "worker_class": _Worker,
            "preload": "fissura.ensemble.preload",
            "silence_logs": logging.CRITICAL,
        }
        worker = {"cls": Nanny, "options": common | options}
        super().__init__(
            scheduler={"cls": _Scheduler, "options": common},
            workers=dict.fromkeys(range(workers), worker),
            worker=worker,
            security=security,
        )
