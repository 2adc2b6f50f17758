"""A server that speaks as much of S3's protocol as a client of a zarr store needs:
objects in memory, written, read, listed and deleted; requests are counted.
"""

import threading
import time
import xml.etree.ElementTree as xml
from collections import Counter
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from urllib.parse import parse_qs, unquote, urlsplit
from xml.sax.saxutils import escape


class Server(ThreadingHTTPServer):
    """At `url`; `objects` are contents by "bucket/key", `requests` counts by kind, and
    each request takes `delay` seconds.
    """

    daemon_threads = True

    def __init__(self, delay=0.0):
        super().__init__(("127.0.0.1", 0), Handler)
        self.url = f"http://127.0.0.1:{self.server_port}"
        self.delay, self.objects, self.requests = delay, {}, Counter()
        self.refused = "nothing"  # ends the name of an object that is not accepted

    def __enter__(self):
        threading.Thread(target=self.serve_forever, args=(0.05,), daemon=True).start()
        return self

    def __exit__(self, *error):
        self.shutdown()
        self.server_close()


class Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"  # connections are kept
    wbufsize = -1  # an answer is sent at once, when it is complete

    def log_message(self, *about):
        pass

    def handle_expect_100(self):
        super().handle_expect_100()
        self.wfile.flush()  # the client waits for it before it sends the content
        return True

    def answer(self, status, content=b"", **header):
        self.send_response(status)
        for name, value in header.items():
            self.send_header(name.replace("_", "-"), value)
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(content)

    def error(self, status, code):
        self.answer(
            status,
            f"<Error><Code>{code}</Code><Message>{code}</Message></Error>".encode(),
        )

    def begin(self, kind=""):
        """The key and the query, once the request is read and counted."""
        time.sleep(self.server.delay)
        parts = urlsplit(self.path)
        self.query = {
            name: values[0]
            for name, values in parse_qs(parts.query, keep_blank_values=True).items()
        }
        self.key = unquote(parts.path).lstrip("/")
        self.body = self.rfile.read(int(self.headers.get("Content-Length", 0)))
        kind = kind or ("LIST" if "list-type" in self.query else self.command)
        self.server.requests[kind] += 1
        if self.command == "PUT" and self.key.endswith(self.server.refused):
            self.error(403, "AccessDenied")
            return False
        return True

    def do_PUT(self):
        if self.begin():
            self.server.objects[self.key] = self.body
            self.answer(200, ETag='"0"')

    def do_DELETE(self):
        if self.begin():
            self.server.objects.pop(self.key, None)
            self.answer(204)

    def do_POST(self):
        """Deletes several objects."""
        if self.begin("DELETE"):
            bucket = self.key.partition("/")[0]
            for element in xml.fromstring(self.body).iter():
                if element.tag.endswith("Key"):
                    self.server.objects.pop(f"{bucket}/{element.text}", None)
            self.answer(200, b"<DeleteResult/>", Content_Type="application/xml")

    def do_GET(self):
        if not self.begin():
            return
        if "list-type" in self.query:
            self.list()
            return
        content = self.server.objects.get(self.key)
        if content is None:
            self.error(404, "NoSuchKey")
            return
        span = self.headers.get("Range")
        if span:
            first, last = span.removeprefix("bytes=").split("-")
            content = content[int(first) : int(last) + 1 if last else None]
        self.answer(
            206 if span else 200,
            content,
            ETag='"0"',
            Last_Modified="Thu, 01 Jan 2026 00:00:00 GMT",
        )

    do_HEAD = do_GET

    def list(self):
        """Up to a thousand keys of a bucket, those of a folder as its name."""
        bucket, most = self.key.partition("/")[0], 1000
        prefix, delimiter = self.query.get("prefix", ""), self.query.get("delimiter")
        entries = {}
        for path in sorted(self.server.objects):
            key = path.removeprefix(f"{bucket}/")
            if key == path or not key.startswith(prefix):
                continue
            rest = key[len(prefix) :]
            if delimiter and delimiter in rest:
                folder = prefix + rest.partition(delimiter)[0] + delimiter
                entries[folder] = (
                    f"<CommonPrefixes><Prefix>{escape(folder)}</Prefix></CommonPrefixes>"
                )
            else:
                entries[key] = (
                    f"<Contents><Key>{escape(key)}</Key><Size>{len(self.server.objects[path])}</Size>"
                    '<ETag>"0"</ETag><LastModified>2026-01-01T00:00:00.000Z</LastModified></Contents>'
                )
        start = self.query.get("continuation-token", "")
        keys = [key for key in entries if key > start]
        more = (
            f"<IsTruncated>true</IsTruncated><NextContinuationToken>{escape(keys[most - 1])}</NextContinuationToken>"
            if len(keys) > most
            else "<IsTruncated>false</IsTruncated>"
        )
        listed = "".join(entries[key] for key in keys[:most])
        count = f"<KeyCount>{min(len(keys), most)}</KeyCount>"
        self.answer(
            200,
            f"<ListBucketResult>{count}{more}{listed}</ListBucketResult>".encode(),
            Content_Type="application/xml",
        )
