#!/usr/bin/env python3
"""Asks a running viewer for its page, and through a WebSocket for frames with people.

usage: view_answers.py ADDRESS
"""
import base64
import gzip
import json
import os
import socket
import sys
import urllib.parse
import urllib.request

TEXT, BINARY = 1, 2


def exactly(stream, size):
    data = stream.read(size)
    if len(data) != size:
        sys.exit("the viewer hung up")
    return data


def message_of(stream):
    """Returns kind and bytes of the next message; the viewer sends each in one piece or several."""
    kind, data = None, b""
    while True:
        first, second = exactly(stream, 2)
        size = second & 127
        if size >= 126:
            size = int.from_bytes(exactly(stream, 2 if size == 126 else 8), "big")
        piece = exactly(stream, size)
        opcode = first & 15
        if opcode > BINARY:
            continue
        kind, data = kind or opcode, data + piece
        if first & 128:
            return kind, data


def send(connection, text):
    """Sends a short text; what clients send is masked."""
    mask, data = os.urandom(4), text.encode()
    connection.sendall(bytes([0x80 | TEXT, 0x80 | len(data)]) + mask + bytes(c ^ mask[i % 4] for i, c in enumerate(data)))


def main():
    address = urllib.parse.urlsplit(sys.argv[1])
    with urllib.request.urlopen(sys.argv[1], timeout=20) as page:
        html = gzip.decompress(page.read()).decode()  # the only way in which the viewer has it
    if "<script" not in html:
        sys.exit(f"no page: {html[:200]!r}")
    with socket.create_connection((address.hostname, address.port), timeout=60) as connection:
        key = base64.b64encode(os.urandom(16)).decode()
        connection.sendall(f"GET /stream HTTP/1.1\r\nHost: {address.netloc}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                           f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n".encode())
        stream = connection.makefile("rb")
        status = stream.readline()
        if b" 101 " not in status:
            sys.exit(f"no WebSocket: {status!r}")
        while stream.readline().strip():
            pass
        frames = size = 0
        while frames < 3:
            kind, data = message_of(stream)
            if kind == BINARY:
                frames, size = frames + 1, size + len(data)
                send(connection, "next")
            elif json.loads(data)["type"] == "notice":
                sys.exit(f"the viewer says: {data.decode()}")
    print(f"page of {len(html)} characters, {frames} frames of {size} bytes together")


if __name__ == "__main__":
    main()
