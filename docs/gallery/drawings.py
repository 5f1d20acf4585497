#!/usr/bin/python3
"""Draws docs/images/speckle.svg and docs/images/setup.svg, of docs/taking-photos.md: docs/gallery/drawings.py"""
import math
import random
from pathlib import Path

IMAGES = Path(__file__).resolve().parents[1] / "images"
FONT = 'font-family="sans-serif" font-size="13"'


def svg(width, height, body):
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}">\n'
            f'<rect width="{width}" height="{height}" fill="white"/>\n' + "\n".join(body) + "\n</svg>\n")


def text(x, y, words, anchor="middle", fill="#222"):
    return f'<text x="{x:g}" y="{y:g}" text-anchor="{anchor}" fill="{fill}" {FONT}>{words}</text>'


def speckle():
    """Patches of 30 x 30 px; half of each is dark."""
    pixel, side, gap = 6, 30, 24
    dice = random.Random(4)
    out, x0 = [], 10
    for diameter, words, more in ((1.5, "1.5 px", "too fine: it aliases"), (4, "3 to 5 px", "right"),
                                  (14, "14 px", "too few edges to follow")):
        width = side * pixel
        out.append(f'<clipPath id="c{x0}"><rect x="{x0}" y="10" width="{width}" height="{width}"/></clipPath>')
        out.append(f'<g clip-path="url(#c{x0})"><rect x="{x0}" y="10" width="{width}" height="{width}" fill="#e8e8e4"/>')
        radius = 0.5 * diameter * pixel
        count = round(-math.log(0.5) * width**2 / (math.pi * radius**2))
        out += [f'<circle cx="{x0 + dice.random() * width:.0f}" cy="{10 + dice.random() * width:.0f}" r="{radius:.1f}" fill="#444"/>'
                for _ in range(count)]
        lines = "".join(f"M{x0 + i * pixel} 10v{width}M{x0} {10 + i * pixel}h{width}" for i in range(side + 1))
        out.append(f'<path d="{lines}" stroke="#6aa0d8" stroke-width="0.4"/></g>')
        out += [text(x0 + width / 2, width + 28, words), text(x0 + width / 2, width + 45, more, fill="#666")]
        x0 += width + gap
    return svg(x0 - gap + 10, side * pixel + 56, out)


def setup():
    """From above: body, two cameras, two lamps."""
    out, (bx, by) = [], (260, 90)
    out.append(f'<rect x="{bx - 90}" y="{by - 62}" width="180" height="26" fill="#d8d8d8"/>')
    out.append(text(bx, by - 44, "machine"))
    out.append(f'<rect x="{bx - 22}" y="{by - 18}" width="44" height="36" fill="#b9c7d8" stroke="#456"/>' + text(bx, by + 5, "body"))
    for turn, name in ((-13, "left"), (13, "right")):
        a = math.radians(90 + turn)
        x, y = bx + 190 * math.cos(a), by + 190 * math.sin(a)
        out.append(f'<path d="M{x:.0f} {y:.0f}L{bx} {by + 18}" stroke="#888" stroke-dasharray="4 3"/>')
        out.append(f'<g transform="translate({x:.0f} {y:.0f}) rotate({turn})"><rect x="-14" y="0" width="28" height="30" fill="#333"/>'
                   '<rect x="-8" y="-12" width="16" height="12" fill="#777"/></g>')
    out.append(f'<path d="M{bx - 52} {by + 236}h104" stroke="#333" stroke-width="5"/>' + text(bx, by + 256, "one stand, on the floor, not on the machine"))
    out.append(text(bx, by + 118, "15 to 35°"))
    for side in (-1, 1):
        x = bx + side * 190
        out.append(f'<g transform="translate({x} {by + 96}) rotate({-side * 62})"><rect x="-34" y="-7" width="68" height="14" rx="3" fill="#f3d98b" '
                   'stroke="#a80"/></g>' + text(x, by + 150, "wide, soft lamp"))
    return svg(520, 362, out)


(IMAGES / "speckle.svg").write_text(speckle())
(IMAGES / "setup.svg").write_text(setup())
