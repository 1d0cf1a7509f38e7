"""PNG files and X framebuffers as rows of (r, g, b), without libraries."""
import struct
import zlib


def read_png(path):
    """Rows of an 8-bit RGB file."""
    with open(path, "rb") as file:
        data = file.read()
    if data[:8] != b"\x89PNG\r\n\x1a\n":
        raise ValueError(f"{path} is no PNG file")
    at, packed = 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height, depth, color = struct.unpack(">IIBB", body[:10])
            if (depth, color) != (8, 2):
                raise ValueError(f"{path} is not 8-bit RGB")
        elif kind == b"IDAT":
            packed += body
        at += size + 12
    raw, stride = zlib.decompress(packed), 3 * width
    rows, above = [], bytes(stride)
    for y in range(height):
        start = y * (stride + 1)
        above = _unfiltered(raw[start], bytearray(raw[start + 1:start + 1 + stride]), above)
        rows.append(_pixels(above, 3, (0, 1, 2)))
    return rows


def _unfiltered(kind, line, above):
    for i in range(len(line)):
        a = line[i - 3] if i >= 3 else 0
        b = above[i]
        c = above[i - 3] if i >= 3 else 0
        if kind == 1:
            guess = a
        elif kind == 2:
            guess = b
        elif kind == 3:
            guess = (a + b) // 2
        elif kind == 4:
            guess = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
        else:
            guess = 0
        line[i] = (line[i] + guess) & 255
    return bytes(line)


def _pixels(line, step, order):
    return list(zip(*(line[k::step] for k in order)))


def read_framebuffer(path):
    """Rows of the file that Xvfb -fbdir keeps (XWD, 32 bits a pixel, low byte first)."""
    with open(path, "rb") as file:
        data = file.read()
    header = struct.unpack(">20I", data[:80])
    size, width, height, order, bits, stride, colors = (header[k] for k in (0, 4, 5, 7, 11, 12, 19))
    if (order, bits) != (0, 32):
        raise ValueError(f"{path}: pixels are not 32 bits with the low byte first")
    start = size + 12 * colors
    return [_pixels(data[start + y * stride:start + y * stride + 4 * width], 4, (2, 1, 0))
            for y in range(height)]


def write_png(path, rows):
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    raw = b"".join(b"\0" + bytes(v for pixel in row for v in pixel) for row in rows)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" +
                   chunk(b"IHDR", struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 2, 0, 0, 0)) +
                   chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b""))
