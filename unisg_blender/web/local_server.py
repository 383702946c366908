"""A folder shown on this machine only, at 127.0.0.1."""

from __future__ import annotations

import threading
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

from ..errors import UniSGError

ADDRESS = "127.0.0.1"


class LocalServer:
    """Serves a folder from a thread until it is closed.

    Raises
    ------
    UniSGError
        If the port is not free; 0 takes any that is.
    """

    def __init__(self, folder: Path, port: int = 0) -> None:
        self.folder = folder
        try:
            self._server = ThreadingHTTPServer((ADDRESS, port), partial(_QuietHandler, directory=str(folder)))
        except OSError as error:
            raise UniSGError(f"cannot show {folder} on port {port}: {error.strerror}; give another --port") from None
        self._thread = threading.Thread(target=self._server.serve_forever, name="UniSG page", daemon=True)
        self._thread.start()

    @property
    def address(self) -> str:
        """Where a browser finds it."""
        return f"http://{ADDRESS}:{self._server.server_port}/"

    def wait(self) -> None:
        """Until it is closed, or Ctrl+C is pressed."""
        self._thread.join()

    def close(self) -> None:
        """Stop serving."""
        self._server.shutdown()
        self._server.server_close()


class _QuietHandler(SimpleHTTPRequestHandler):
    def end_headers(self) -> None:
        self.send_header("Cache-Control", "no-store")  # a scene that has changed since is asked for anew
        super().end_headers()

    def log_message(self, format: str, *args: object) -> None:
        """Nothing: nobody asked for a log."""
