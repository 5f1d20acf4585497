"""From linear light to files as cameras write them: noise, levels, PNG or JPEG."""

import struct
import subprocess
import zlib

import numpy as np

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def exposed(light, camera, rng):
    """Photon and read noise. light: rows x columns x channels, full scale 1."""
    light = light * camera.get("gain", 1.0)
    sigma = np.sqrt(np.maximum(light, 0) / camera["full_well"] + camera["read"] ** 2)
    return light + sigma * rng.normal(size=light.shape)


def srgb(linear):
    x = np.clip(linear, 0, 1)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)


def levels(values, bits):
    top = 2 ** bits - 1
    return np.clip(np.round(values * top), 0, top).astype(np.uint8 if bits == 8 else ">u2")


def write_png(path, pixels):
    """Grey (rows x columns) or RGB (x 3), 8 or 16 bit."""
    rows, columns = pixels.shape[:2]
    kind = 0 if pixels.ndim == 2 else 2
    raw = b"".join(b"\0" + row.tobytes() for row in pixels)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        for name, data in ((b"IHDR", struct.pack(">IIBBBBB", columns, rows, 8 * pixels.itemsize, kind, 0, 0, 0)),
                           (b"IDAT", zlib.compress(raw, 6)), (b"IEND", b"")):
            file.write(struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data)))


def write_jpeg(path, pixels, quality):
    rows, columns = pixels.shape[:2]
    kind = b"P5" if pixels.ndim == 2 else b"P6"
    picture = kind + b"\n%d %d\n255\n" % (columns, rows) + pixels.tobytes()
    subprocess.run(["cjpeg", "-quality", str(quality), "-outfile", path], input=picture, check=True)


def develop(light, camera, stem, rng):
    """Writes stem.png or stem.jpg; returns the path."""
    if not camera["colour"]:
        light = (light @ LUMINANCE)[:, :, None]
    noisy = exposed(light, camera, rng)
    coded = srgb(noisy) if camera["encoding"] == "srgb" else noisy
    pixels = levels(coded, camera["bits"]).squeeze()
    if camera["file"] == "jpeg":
        write_jpeg(stem + ".jpg", pixels, camera["quality"])
        return stem + ".jpg"
    write_png(stem + ".png", pixels)
    return stem + ".png"


def keyed(light, camera, stem, rng):
    """A silhouette by chroma key: what is not clearly green is body; the majority of 3 x 3 px wins."""
    noisy = exposed(light, camera, rng)
    body = noisy[:, :, 1] - 1.6 * np.maximum(noisy[:, :, 0], noisy[:, :, 2]) < camera["key"]
    around = np.pad(body.astype(int), 1, mode="edge")
    rows, columns = body.shape
    votes = sum(around[y:y + rows, x:x + columns] for y in range(3) for x in range(3))
    write_png(stem + ".png", np.where(votes > 4, 255, 0).astype(np.uint8))
    return stem + ".png"
