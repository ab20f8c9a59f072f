# SPDX-License-Identifier: Apache-2.0
"""OpenEXR files without compression, as the file layout document of OpenEXR describes them."""
import struct

UINT, HALF, FLOAT = 0, 1, 2


def attribute(name, kind, data):
    return f"{name}\0{kind}\0".encode() + struct.pack("<I", len(data)) + data


def write(path, channels, data_window, display_window=None, more=b""):
    """channels: name -> (type, value of all pixels)."""
    x0, y0, x1, y1 = data_window
    names, width = sorted(channels), x1 - x0 + 1
    listed = b"".join(n.encode() + struct.pack("<xI4xII", channels[n][0], 1, 1) for n in names) + b"\0"
    header = (struct.pack("<II", 20000630, 2) + attribute("channels", "chlist", listed)
              + attribute("compression", "compression", b"\0") + attribute("dataWindow", "box2i", struct.pack("<4i", *data_window))
              + attribute("displayWindow", "box2i", struct.pack("<4i", *(display_window or data_window)))
              + attribute("lineOrder", "lineOrder", b"\0") + attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
              + attribute("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0))
              + attribute("screenWindowWidth", "float", struct.pack("<f", 1)) + more + b"\0")
    row = b"".join(struct.pack(f"<{width}{'Ief'[channels[n][0]]}", *[channels[n][1]] * width) for n in names)
    start, step = len(header) + 8 * (y1 - y0 + 1), 8 + len(row)
    with open(path, "wb") as file:
        file.write(header + b"".join(struct.pack("<Q", start + i * step) for i in range(y1 - y0 + 1)))
        file.write(b"".join(struct.pack("<iI", y, len(row)) + row for y in range(y0, y1 + 1)))
