"""Cameras that another program calibrated. A function a kind of source."""

from __future__ import annotations

import os
import pathlib
from typing import Any, Dict, List, Optional, Sequence, Tuple, Union

from . import _hookeye
from ._named import Attributes, Named
from .errors import InputError

PathLike = Union[str, "os.PathLike[str]"]


class Imported(Attributes):
    """Cameras by name; `yaml`: the text that a capture takes by `cameras: {from: cameras.yaml}`."""

    def __init__(self, found: Dict[str, Any]) -> None:
        self.cameras: Dict[str, _hookeye.Camera] = Named(
            "camera", {c.name: c for c in found["cameras"]})
        #: Root mean square of the reprojection [px]; None: the source has no points.
        self.rms_px: Dict[str, Optional[float]] = dict(zip(self.cameras, found["rms_px"]))
        self.world: str = found["world"]
        self.said: List[str] = found["said"]
        self.yaml: str = found["yaml"]

    def save(self, folder: PathLike) -> pathlib.Path:
        """Writes FOLDER/cameras.yaml; refuses to overwrite a file."""
        file = pathlib.Path(folder) / "cameras.yaml"
        file.parent.mkdir(parents=True, exist_ok=True)
        try:
            with open(file, "x", encoding="utf-8") as out:
                out.write(self.yaml)
        except FileExistsError:
            raise InputError(f"{file}: there is a file of this name", str(file), 0, 0,
                             "there is a file of this name", "another folder") from None
        return file

    def __repr__(self) -> str:
        return f"<hookeye.importers.Imported: {', '.join(self.cameras)}>"


def read(source: Union[PathLike, Sequence[PathLike]], *, kind: str = "", scale: float = 1.0,
         size: Tuple[int, int] = (0, 0), lens: str = "") -> Imported:
    """Cameras of any kind of source, which is recognised unless told.

    scale: length units of the capture in one of the source; size: width and height of the photos,
    where the source lacks them; lens="opencv": lenses of unpublished formula as k1 k2 k3 p1 p2.
    """
    if lens not in ("", "opencv"):
        raise InputError(f"lens: there is no '{lens}'", wrong=f"lens: there is no '{lens}'",
                         right="opencv, or nothing")
    sources = [source] if isinstance(source, (str, os.PathLike)) else list(source)
    return Imported(_hookeye.import_cameras(kind, sources, scale, tuple(size), lens == "opencv"))


def _of(kind: str, title: str):
    def importer(*source: PathLike, scale: float = 1.0, size: Tuple[int, int] = (0, 0),
                 lens: str = "") -> Imported:
        return read(source, kind=kind, scale=scale, size=size, lens=lens)

    importer.__name__ = importer.__qualname__ = kind
    importer.__doc__ = f"{title}. Options as those of read()."
    return importer


kinds: Dict[str, str] = dict(_hookeye.importers())
globals().update({kind: _of(kind, title) for kind, title in kinds.items()})
__all__ = ["Imported", "kinds", "read", *kinds]
