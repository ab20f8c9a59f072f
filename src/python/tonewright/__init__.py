# SPDX-License-Identifier: Apache-2.0
"""Tone mapping operators: pictures, colors, LUTs and OpenColorIO configs.

    import tonewright
    tonewright.tonemap_file("shot.exr", "shot.png", "agx_blender", exposure=1)

Functions that take an operator share these options:

    settings         dict of the operator's parameters, see operators()
    exposure         exposure before the operator, in stops
    input            "auto" (as the picture says), a color space ("acescg") or an encoding ("sRGB", "Gamma2.2")
    display          "srgb", "rec1886", "rec2100_pq", ... (see displays()), "linear" or "native"
    look             look of the operator
    reference_white  luminance of scene-linear 1.0 in inputs of PQ, HLG or cd/m2 and on HDR displays, in cd/m2

A wrong type raises TypeError, a wrong value ValueError, a file OSError or one of its subclasses. Too little memory raises
MemoryError. Warnings about a file are UserWarnings; with `python -W error`, they are errors and the file is not written.
Other threads run while a function works.
"""

from __future__ import annotations

import operator as _operator
import os as _os
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any, Union

try:
    import numpy as _np
except ImportError as error:
    raise ImportError("tonewright needs NumPy (Debian: python3-numpy)", name="numpy") from error

from . import _tonewright
from ._tonewright import __version__

if TYPE_CHECKING:
    import numpy.typing as npt
    import OpenImageIO

    Path = Union[str, bytes, _os.PathLike]
    Picture = Union[npt.NDArray[Any], "OpenImageIO.ImageBuf"]

__all__ = ["__version__", "applications", "bake", "change_config", "displays", "evaluate", "info", "make_config", "meter",
           "operators", "tonemap", "tonemap_file", "tonemap_frames", "verify"]


def _text(name: str, value: Any) -> str:
    if not isinstance(value, str):
        raise TypeError(f"{name} must be str, not {type(value).__name__}")
    if "\0" in value:
        raise ValueError(f"{name}: embedded null character")
    return value


def _number(name: str, value: Any) -> float:
    if isinstance(value, (str, bytes)):
        raise TypeError(f"{name} must be a number, not {type(value).__name__}")
    return float(value)


def _index(name: str, value: Any) -> int:
    number = _operator.index(value)
    if not -2**31 <= number < 2**31:
        raise ValueError(f"{name} is {number}; expected a number of 32 bits")
    return number


def _optional_index(name: str, value: Any) -> int | None:
    return None if value is None else _index(name, value)


def _path(name: str, value: Any) -> bytes:
    path = _os.fsencode(value)
    if b"\0" in path:
        raise ValueError(f"{name}: embedded null character")
    return path


def _cache(value: Any) -> bytes:
    return b"" if value is None else _path("cache", value)


def _texts(name: str, values: Any) -> list[str]:
    if isinstance(values, str):
        raise TypeError(f"{name} must be a sequence of str, not str")
    return [_text(name, value) for value in values]


def _choice(name: str, value: Any) -> str:
    """A text, or a bool for yes or no."""
    return ("yes" if value else "no") if isinstance(value, bool) else _text(name, value)


def _options(settings: Mapping[str, Any] | None, exposure: float, input: str, display: str, look: str,
             reference_white: float) -> dict[str, Any]:
    if settings is not None and not isinstance(settings, Mapping):
        raise TypeError(f"settings must be a mapping, not {type(settings).__name__}")
    return {"settings": {_text("settings", name): value for name, value in (settings or {}).items()},
            "exposure": _number("exposure", exposure), "input": _text("input", input), "display": _text("display", display),
            "look": _text("look", look), "reference_white": _number("reference_white", reference_white)}


def _file_arguments(*, settings: Mapping[str, Any] | None = None, exposure: float = 0, input: str = "auto",
                    display: str = "srgb", look: str = "", reference_white: float = 100, input_units: str = "relative",
                    mix: float = 1, unpremult: str | bool = "auto", statistics: str = "picture", dtype: str | None = None,
                    alpha: str = "keep", subimage: int | str = "", layer: str = "", nthreads: int = 0, in_place: bool = False,
                    max_pixels: float | None = None, compression: str = "", quality: int = 0, subsampling: str = "",
                    verify_output: bool = False, resize: int | str = "") -> dict[str, Any]:
    options = _options(settings, exposure, input, display, look, reference_white)
    options.update(input_units=_text("input_units", input_units), mix=_number("mix", mix),
                   unpremult=_choice("unpremult", unpremult), statistics=_text("statistics", statistics))
    options["file"] = {"type": "" if dtype is None else _text("dtype", dtype), "alpha": _text("alpha", alpha),
                       "nthreads": _index("nthreads", nthreads), "subimage": str(subimage), "layer": _text("layer", layer),
                       "in_place": bool(in_place), "max_pixels": None if max_pixels is None else _number("max_pixels", max_pixels),
                       "compression": _text("compression", compression), "quality": _index("quality", quality),
                       "subsampling": _text("subsampling", subsampling), "verify_output": bool(verify_output),
                       "resize": str(resize)}
    return options


def tonemap(image: Picture, op: str, *, settings: Mapping[str, Any] | None = None, exposure: float = 0, input: str = "auto",
            display: str = "srgb", look: str = "", reference_white: float = 100, input_units: str = "relative",
            mix: float = 1, unpremult: str | bool = "auto", statistics: str = "picture", axis: int | None = None,
            roi: OpenImageIO.ROI | None = None, nthreads: int = 0, progress: Callable[[float], object] | None = None,
            resize: int | str = "") -> Picture:
    """Tone map a picture and return the result as float32 values of the same kind.

    image: an OpenImageIO.ImageBuf, or an array of shape (height, width) or (height, width, channels) of float16, float32,
    float64, uint8, uint16 or uint32; integers represent [0, 1]. The first three channels are color (or the first of one or
    two channels); the fourth (or second) is alpha.
    op: operator id, optionally with :preset, or the path of a .tone file or a LUT.
    input_units: units of linear numbers: "relative" (1.0 is diffuse white) or "cd/m2", divided by reference_white.
    mix: share of the operator, [0, 1]; the rest is a plain clamp, blended in code values.
    unpremult: "auto", "yes" or "no": un-premultiply color first.
    statistics: "picture" (measure it for operators that need it) or "defaults".
    axis: the axis of the channels of an array, such as 0 for (channels, height, width).
    roi: part of an ImageBuf.
    nthreads: number of threads; 0 uses all cores.
    progress: called with the finished fraction, from 0 to 1; a true result cancels.
    resize: size of the result, in linear light before the operator: "1920x1080", 1920 (the width) or "50%".

    Example: tonewright.tonemap(OpenImageIO.ImageBuf("shot.exr"), "agx_blender", exposure=1)
    """
    options = _options(settings, exposure, input, display, look, reference_white)
    options.update(input_units=_text("input_units", input_units), mix=_number("mix", mix),
                   unpremult=_choice("unpremult", unpremult), statistics=_text("statistics", statistics))
    if axis is not None:
        if not isinstance(image, _np.ndarray) or image.ndim != 3:
            raise ValueError("axis is given; expected an array of three dimensions")
        image = _np.moveaxis(image, axis, -1)
    result = _tonewright.tonemap(image, _text("op", op), roi=roi, nthreads=_index("nthreads", nthreads), progress=progress,
                                 resize=str(resize), **options)
    return result if axis is None else _np.moveaxis(result, -1, axis)


def tonemap_file(source: Path, target: Path, op: str, *, settings: Mapping[str, Any] | None = None, exposure: float = 0,
                 input: str = "auto", display: str = "srgb", look: str = "", reference_white: float = 100,
                 input_units: str = "relative", mix: float = 1, unpremult: str | bool = "auto", statistics: str = "picture",
                 dtype: str | None = None, alpha: str = "keep", subimage: int | str = "", layer: str = "",
                 nthreads: int = 0, in_place: bool = False, max_pixels: float | None = None, compression: str = "",
                 quality: int = 0, subsampling: str = "", verify_output: bool = False, resize: int | str = "") -> None:
    """Tone map a picture file into another file, as `tonewright apply` does. Its warnings are UserWarnings.

    target: replaced only when the new file is complete; its extension sets the format.
    dtype: "uint8", "uint16", "half" or "float", for DPX also "uint10" and "uint12" (default: the format's; of EXR the
    source's: half for half and 8 bits, else float).
    alpha: "keep", "ignore" (leave it out), "opaque" (make it 1), or "over:R,G,B" (composite over a background in code
    values, [0, 1]).
    subimage: part or page of the file: its number from 0 or its name (default: the first picture).
    layer: layer of an EXR file (default: R, G, B, else the first that is a picture).
    in_place: allow the target to be the source, which is lost then.
    max_pixels: most pixels that the source may declare (default: 1e9), and the target, with what is filled (default: 1e8).
    compression: a method of the format, with ":quality" if it has one, such as "zip" or "dwaa:45" (default: the source's if
    the format has it, else the format's).
    quality: of JPEG, WebP, HEIF and AVIF, [1, 100] (default 0: the format's).
    subsampling: chroma of JPEG: "4:4:4", "4:2:2", "4:2:0" or "4:1:1" (default: 4:4:4 from quality 90 on, else 4:2:0).
    verify_output: read the written file and compare all pixels, before it gets its name.
    resize: size of the picture, in linear light before the operator: "1920x1080", 1920 (the width) or "50%".
    Other options: as tonemap().

    Example: tonewright.tonemap_file("shot.exr", "shot.png", "hable", settings={"white": 8})
    """
    _tonewright.tonemap_file(_path("source", source), _path("target", target), _text("op", op), **_file_arguments(
        settings=settings, exposure=exposure, input=input, display=display, look=look, reference_white=reference_white,
        input_units=input_units, mix=mix, unpremult=unpremult, statistics=statistics, dtype=dtype, alpha=alpha,
        subimage=subimage, layer=layer, nthreads=nthreads, in_place=in_place, max_pixels=max_pixels, compression=compression,
        quality=quality, subsampling=subsampling, verify_output=verify_output, resize=resize))


def tonemap_frames(source: Path, target: Path, op: str, frames: str | Iterable[int], *, missing: str = "error",
                   skip_existing: bool = False, jobs: int = 0, statistics: str = "picture", auto_exposure: str = "",
                   key: float | None = None, compensation: float = 0, adapt: bool = False, fps: float = 24,
                   meter_frames: str | Iterable[int] | None = None, meter_cache: Path | None = None,
                   **options: Any) -> list[dict[str, Any]]:
    """Tone map the frames of a shot, as `tonewright apply --frames` does. A frame that fails does not stop the others.

    source, target: names with %04d, #### or @@@@ for the number.
    frames: numbers, or a text such as "1001-1100", "1-9x2" or "1,5,10-20".
    missing: missing source frames: "error", "skip", or "hold" (use the last earlier frame).
    skip_existing: skip frames whose target is complete and newer than the source.
    jobs: number of frames at a time; 0 is the number of threads.
    statistics: "picture", "sequence" (operators measure all metered frames together) or "defaults".
    auto_exposure: meter the frames by "log-average", "histogram", "mean" or "max" (default: no metering).
    key, compensation: as meter(). The exposure is added.
    adapt: adapt the exposure from frame to frame, as an eye does, at `fps` frames per second.
    meter_frames: frames of the whole shot, if `frames` has only some of them.
    meter_cache: file that keeps metered luminances; changed frames are metered again.
    options: as tonemap_file().

    The result has a dict for each frame with frame, source, target, exposure (stops), skipped, and error (None or a text).

    Example: tonewright.tonemap_frames("shot.####.exr", "shot.####.png", "hable", "1001-1100", auto_exposure="mean")
    """
    def numbers(name: str, value: str | Iterable[int]) -> str | list[int]:
        if isinstance(value, (bytes, bytearray)):
            raise TypeError(f"{name} must be str or a sequence of int, not {type(value).__name__}")
        return value if isinstance(value, str) else [_index(name, number) for number in value]

    for name, value in (("adapt", adapt or None), ("key", key), ("compensation", compensation or None),
                        ("fps", fps if fps != 24 else None)):
        if value is not None and not auto_exposure:
            raise ValueError(f"{name} is {value}; expected auto_exposure with it")
    if fps != 24 and not adapt:
        raise ValueError(f"fps is {fps}; expected adapt=True with it")
    for name, value in (("meter_frames", meter_frames), ("meter_cache", meter_cache)):
        if value is not None and not auto_exposure and _text("statistics", statistics).strip().lower() != "sequence":
            raise ValueError(f'{name} is given; expected auto_exposure or statistics="sequence" with it')
    if meter_frames is not None:
        meter_frames = numbers("meter_frames", meter_frames)
        if not meter_frames:
            raise ValueError("meter_frames is empty; expected all frames of the shot")
    if _index("jobs", jobs) < 0:
        raise ValueError(f"jobs is {jobs}; expected 0 or more")
    return _tonewright.tonemap_frames(
        _path("source", source), _path("target", target), _text("op", op),
        shot={"frames": numbers("frames", frames), "missing": _text("missing", missing), "skip_existing": bool(skip_existing),
              "jobs": _index("jobs", jobs), "statistics": _text("statistics", statistics),
              "auto_exposure": _text("auto_exposure", auto_exposure),
              "key": None if key is None else _number("key", key), "compensation": _number("compensation", compensation),
              "adapt": bool(adapt), "fps": _number("fps", fps),
              "meter_frames": meter_frames, "meter_cache": b"" if meter_cache is None else _path("meter_cache", meter_cache)},
        **_file_arguments(**options))


def evaluate(op: str, colors: npt.ArrayLike, *, settings: Mapping[str, Any] | None = None, exposure: float = 0,
             input: str = "auto", display: str = "srgb", look: str = "",
             reference_white: float = 100) -> npt.NDArray[Any]:
    """Return the code values of scene-linear colors.

    colors: shape (..., 3). float32 goes through the SIMD engine and stays float32; other numbers go through the
    double-precision reference and become float64. Parameters that operators measure from a picture keep their defaults.

    Example: tonewright.evaluate("hable", [0.18, 0.18, 0.18])
    """
    return _tonewright.evaluate(_text("op", op), colors,
                                **_options(settings, exposure, input, display, look, reference_white))


def meter(image: Path | Picture, *, method: str = "log-average", key: float | None = None, compensation: float = 0,
          delta: float = 1e-3, percentiles: tuple[float, float] = (0, 100), input: str = "auto",
          input_units: str = "relative", reference_white: float = 100, unpremult: str | bool = "auto",
          subimage: int | str = "", layer: str = "", nthreads: int = 0,
          max_pixels: float = 1e9) -> dict[str, Any]:
    """Measure the luminance of a picture and suggest an exposure, in stops, as `tonewright meter` does.

    image: a file, an OpenImageIO.ImageBuf or an array (see tonemap()).
    method: "log-average", "histogram", "mean" or "max".
    key: target for the metered luminance (default 0.18; 1 with "max").
    compensation: stops on top of the metered exposure.
    delta: added to each luminance inside the logarithm.
    percentiles: "histogram" averages between these.
    input_units, reference_white: as tonemap().
    max_pixels: most pixels that a file may declare.

    Example: tonewright.meter("shot.exr")["exposure"]
    """
    low, high = percentiles
    if isinstance(image, (str, bytes, _os.PathLike)):
        image = _path("image", image)
    return _tonewright.meter(image, _text("method", method), None if key is None else _number("key", key),
                             _number("compensation", compensation), _number("delta", delta), _number("percentiles", low),
                             _number("percentiles", high), _text("input", input), _text("input_units", input_units),
                             _number("reference_white", reference_white), _choice("unpremult", unpremult),
                             str(subimage), _text("layer", layer), _index("nthreads", nthreads),
                             _number("max_pixels", max_pixels))


def info(image: Path, *, input: str = "auto", subimage: int | str = "", layer: str = "") -> dict[str, Any]:
    """Return what the header of a picture file says, as `tonewright info --json` does.

    The dict has space, transfer, primaries (xy of red, green, blue), white (xy), orientation (Exif's, 1 is upright), layer,
    subimage, units ("relative" or "cd/m2"), alpha ("none", "associated" or "straight"), rule (what decided the space),
    ignored (lines about tags that are not used) and choices (lines about the layer and the subimage).

    Example: tonewright.info("photo.jpg")["space"]
    """
    return _tonewright.info(_path("image", image), _text("input", input), str(subimage), _text("layer", layer))


def operators() -> list[dict[str, Any]]:
    """Return all operators: dicts with the facts of `tonewright list --json`. presets: settings by id. looks: help by id."""
    return _tonewright.operators()


def displays() -> list[dict[str, Any]]:
    """Return all displays: dicts with id, title, aliases, source, hdr and peak (cd/m2)."""
    return _tonewright.displays()


def applications() -> list[dict[str, Any]]:
    """Return the applications of bake(host=...): dicts with the facts of `tonewright list --hosts --json`."""
    return _tonewright.applications()


def bake(op: str, file: Path, *, host: str = "", format: str | None = None, input_encoding: str | None = None,
         dimension: int | None = None, size: int | None = None, max_error: float | None = None, nodes: str = "auto",
         decimals: int | None = None, depth: int | None = None, icc_version: int | None = None,
         settings: Mapping[str, Any] | None = None, exposure: float = 0, input: str = "auto", display: str | None = None,
         look: str = "", reference_white: float = 100, input_units: str = "relative",
         cache: Path | None = None) -> dict[str, Any]:
    """Write an operator as a LUT file, as `tonewright bake` does. Return its size and measured error.

    file: replaced only when the new file is complete.
    host: id of the application that reads it, see applications(); sets format, size, input and display.
    format, input_encoding: as the options of `tonewright bake` (default: by the host or the extension; "acescct").
    dimension: 1, for views that are one curve for each channel, or 3 (default: 1 where that is exact).
    size: grid points a side, [17, 129] in most formats, or entries of a 1D table, [2, 65536].
    max_error: instead of a size: take the smallest up to 129 whose error on photographs (99.9 %), in code values, is at most
    this.
    nodes: values at grid points: "auto" (best on photographs), "sampled", "fitted" or "smooth".
    decimals: of the numbers in a .cube file, [3, 9] (default: all digits of a float).
    depth: bits of a value: 8, 16 or 32 (float) in pictures, 10, 12 or 16 in 3dl.
    icc_version: version of a device link, 2 (default) or 4.
    input_units: as tonemap().
    cache: as make_config(), for a clf or ctf of scene-linear input.

    The result has dimension and size, or operations (of a clf or ctf of scene-linear input), interpolation, max_error and
    mean_error (of every color of the input, code values), and photographs: p999 and mean (99.9 % and mean of the pixels of
    photographs, code values), above_one_code (share of the pixels with an error above 1/255) and outside (share that is
    brighter or more saturated than the input holds). clipped tells which stops the input cuts off and the operator would
    show ("": none), and steps, a list of lines, how the host loads the file.

    Example: tonewright.bake("agx_blender", "agx.cube", host="resolve")
    """
    options = _options(settings, exposure, input, "srgb" if display is None else display, look, reference_white)
    options["input_units"] = _text("input_units", input_units)
    if display is None:
        del options["display"]
    return _tonewright.bake(_text("op", op), _path("file", file), host=_text("host", host),
                            format=None if format is None else _text("format", format),
                            input_encoding=None if input_encoding is None else _text("input_encoding", input_encoding),
                            dimension=_optional_index("dimension", dimension), size=_optional_index("size", size),
                            max_error=None if max_error is None else _number("max_error", max_error),
                            nodes=_text("nodes", nodes), decimals=_optional_index("decimals", decimals),
                            depth=_optional_index("depth", depth), icc_version=_optional_index("icc_version", icc_version),
                            cache=_cache(cache), **options)


def _config_views(views: Iterable[str], displays: Iterable[str], looks: Iterable[str], custom: Mapping[str, str] | None,
                  exposure_views: Iterable[float]) -> tuple[Any, ...]:
    if custom is not None and not isinstance(custom, Mapping):
        raise TypeError(f"custom must be a mapping, not {type(custom).__name__}")
    return (_texts("views", views), _texts("displays", displays), _texts("looks", looks),
            [(_text("custom", name), _text("custom", op)) for name, op in (custom or {}).items()],
            [_number("exposure_views", stops) for stops in exposure_views])


def make_config(folder: Path | None, *, views: Iterable[str] = (), displays: Iterable[str] = (), looks: Iterable[str] = (),
                working: str = "lin_rec709", profiles: Iterable[str] = ("2.1", "2.0", "2.5"),
                custom: Mapping[str, str] | None = None, exposure_views: Iterable[float] = (),
                archive: Path | None = None, cache: Path | None = None) -> None:
    """Write an OpenColorIO config of the operators into a folder. It takes up to two minutes.

    folder: None: an archive only.
    views: names of views or operators, in order; empty: a dozen; ["all"]: all.
    displays, looks: empty: all.
    working: color space in which applications compute.
    profiles: versions of OpenColorIO; the first becomes config.ocio.
    custom: names of views -> operators with their settings, such as {"Studio": "reinhard_extended:white=6"}.
    exposure_views: stops; every view is added again with each of them.
    archive: an .ocioz file that gets the config and its LUTs, for OpenColorIO 2.2 or newer.
    cache: folder that keeps fitted 3D LUTs for the next call, at most 256 MiB (default: none).

    Example: tonewright.make_config("ocio_config", views=["AgX", "hable"], profiles=["2.1"])
    """
    paths = {name: b"" if value is None else _path(name, value) for name, value in (("folder", folder), ("archive", archive))}
    for name, value in (("folder", folder), ("archive", archive)):
        if value is not None and not paths[name]:
            raise ValueError(f"{name} is empty; expected a name")
    _tonewright.make_config(paths["folder"], paths["archive"], _texts("profiles", profiles),
                            _text("working", working), *_config_views(views, displays, looks, custom, exposure_views),
                            _cache(cache))


def change_config(config: Path, change: str = "add", *, views: Iterable[str] = (), displays: Iterable[str] = (),
                  looks: Iterable[str] = (), custom: Mapping[str, str] | None = None, exposure_views: Iterable[float] = (),
                  backup: bool = False, cache: Path | None = None) -> dict[str, Any]:
    """Add views to an existing OpenColorIO config, or remove them, as `tonewright config --into` does.

    config: replaced after all checks; the rest of its text stays. Tables of the views go to tonewright/ beside it.
    change: "add"; "update" (rebuild the added views, or replace them with these views); "remove" (remove the added views).
    views: as make_config(); empty: a dozen, or none if there are custom ones.
    displays: of the config, empty: all that Tonewright knows.
    looks, custom, exposure_views, cache: as make_config().
    backup: keep the config as it was as CONFIG.bak.

    The result has path (of the replaced file, to which config may link), backup (its path or ""), added (kinds, such as "view",
    -> names), removed_tables (their count) and views: a dict with display, view, and the errors max and p999 (99.9 %), in code
    values, for each added view.

    Example: tonewright.change_config("studio.ocio", views=["AgX", "hable"], backup=True)
    """
    return _tonewright.change_config(_path("config", config), _text("change", change), bool(backup),
                                     *_config_views(views, displays, looks, custom, exposure_views), _cache(cache))


def verify(operators: Iterable[str] = (), *, displays: Iterable[str] = (), input: str = "lin_rec709",
           config: Path | None = None, quick: bool = False, gpu: bool = True,
           shaders: Iterable[str] = (), cache: Path | None = None) -> list[dict[str, Any]]:
    """Compare every backend with the double-precision reference and return the errors, one dict for each comparison, with
    the numbers of `tonewright verify --json`.

    operators: empty: all, or those of the config.
    displays: empty: sRGB, or those of the config.
    config: a config to check, or its folder (default: a new config).
    quick: use smaller sample sets.
    gpu: run OpenColorIO's GPU path and shaders.
    shaders: languages to run shaders of, or "none"; empty: all that this machine can run.
    cache: as make_config().

    Example: all(row["ok"] for row in tonewright.verify(["hable"], quick=True))
    """
    return _tonewright.verify(_texts("operators", operators), _texts("displays", displays), _text("input", input),
                              b"" if config is None else _path("config", config), bool(quick), bool(gpu),
                              _texts("shaders", shaders), _cache(cache))
