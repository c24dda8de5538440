"""Processes of this machine: nobody else reaches them."""

from __future__ import annotations

import socket
import ssl
import sys

import psutil
import pytest
from distributed import Client
from distributed.security import Security

from fissura.ensemble.cluster import check_scheduler, connected


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
