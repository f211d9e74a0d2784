"""A web server that takes locations as an omlox hub does."""

from __future__ import annotations

import json
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

Put = tuple[str, dict[str, object], str]


class FakeHub:
    """`puts`: path, body and authorization of what it took; `status`: what it answers."""

    def __init__(self) -> None:
        self.puts: list[Put] = []
        self.status = 204
        hub = self

        class Handler(BaseHTTPRequestHandler):
            def do_PUT(self) -> None:
                body = self.rfile.read(int(self.headers["Content-Length"]))
                if hub.status < 300:
                    authorization = self.headers.get("Authorization", "")
                    hub.puts.append((self.path, json.loads(body), authorization))
                self.send_response(hub.status)
                self.send_header("Content-Length", "0")
                self.end_headers()

            def log_message(self, *_: object) -> None:
                pass

        self.server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.url = f"http://127.0.0.1:{self.server.server_port}/v2"
        threading.Thread(target=self.server.serve_forever, daemon=True).start()

    def close(self) -> None:
        self.server.shutdown()
        self.server.server_close()
