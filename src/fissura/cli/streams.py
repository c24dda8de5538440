"""Standard output and error that never end a program: what nobody reads, or no disk has room for, is dropped."""

import errno
import io
from typing import Any

#: What a stream says whose reader has gone: the other end of a pipe, a terminal that was closed.
_GONE = {errno.EPIPE, errno.EIO, errno.EBADF, errno.ENXIO, errno.ECONNRESET, errno.ESHUTDOWN}


class _Forgiving(io.FileIO):
    """A file descriptor that is written to until that fails, and from then on swallows everything."""

    failed: OSError | None = None

    def write(self, data: Any) -> int:
        """Write bytes, or drop them; returns how many are done with."""
        if self.failed is None:
            try:
                return int(super().write(data) or 0)
            except OSError as error:
                self.failed = error
        return len(memoryview(data).cast("B"))


def forgiving(stream: Any) -> Any:
    """The same stream, forgiving; a stream without a file descriptor, as in tests and notebooks, is left as it is."""
    try:
        number, encoding, lines = stream.fileno(), stream.encoding, stream.line_buffering
        stream.flush()
    except (AttributeError, OSError, ValueError):
        return stream
    raw = _Forgiving(number, "wb", closefd=False)
    return io.TextIOWrapper(io.BufferedWriter(raw), encoding, errors="replace", line_buffering=lines)


def unwritten(stream: Any) -> str:
    """Why something was not written, though somebody wanted it: a full disk, not a reader that has gone; or ``""``."""
    try:
        stream.flush()
        failed = stream.buffer.raw.failed
    except (AttributeError, OSError, ValueError):
        return ""
    return "" if failed is None or failed.errno in _GONE else str(failed.strerror or failed)
