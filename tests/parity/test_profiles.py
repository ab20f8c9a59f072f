# SPDX-License-Identifier: Apache-2.0
"""The profiles of the OpenColorIO config: one config for every OpenColorIO.

    python3 -m pytest tests/parity/test_profiles.py

Takes the files that the PyOpenColorIO of this Python reads: with 2.1 config.ocio and config-2.0.ocio, with 2.5
config-2.5.ocio too. Each must load and validate without a line in the log; names must be the same in all; and numbers
must be probe.csv's. What config-2.5.ocio adds is looked at as YAML.
"""

import contextlib
import re

import check_config
import pytest
from pictures import PROJECT

ocio = pytest.importorskip("PyOpenColorIO")

FILES = {(2, 1): "config.ocio", (2, 0): "config-2.0.ocio", (2, 5): "config-2.5.ocio"}
FOLDER = PROJECT / "ocio_config"
VERSION = tuple(int(n) for n in ocio.GetVersion().split(".")[:2])
# OpenColorIO's ACES 2.0 is float32: 2.3e-5 from the double reference on random colors (tests/parity/test_builtins.py),
# where one channel is near black and another bright; Rec.1886 and the pure powers are steeper there than sRGB.
ACES_20 = 4e-5
# Color Interop Forum and OpenColorIO's own configs: the spaces that have an id, by their names in this config.
INTEROP_IDS = {"sRGB": "srgb_rec709_display", "Display P3": "srgb_p3d65_display", "Rec.1886": "g24_rec709_display",
               "Gamma 2.2": "g22_rec709_display", "Rec.2020": "tonewright:g24_rec2020_display", "Rec.2100-PQ": "pq_rec2020_display",
               "Rec.2100-HLG": "hlg_rec2020_display", "P3-D65 PQ": "pq_p3d65_display", "ACEScg": "lin_ap1_scene",
               "ACES2065-1": "lin_ap0_scene", "Linear Rec.709": "lin_rec709_scene",
               "Linear Rec.2020": "lin_rec2020_scene", "Linear P3-D65": "lin_p3d65_scene", "Non-Color": "data",
               "sRGB - Texture": "srgb_rec709_scene", "ACEScct": "ocio:acescct_ap1_scene",
               "ARRI LogC3 (EI800)": "ocio:arrilogc3_awg3_scene", "ARRI LogC4": "ocio:arrilogc4_awg4_scene"}
# SMPTE ST 2067-50: what an ACES Metadata File calls the transform of a view and its display.
AMF = "urn:ampas:aces:transformId:"
AMF_IDS = {("ACES 2.0", "sRGB"): AMF + "v2.0:Output.Academy.Rec709-D65_100nit_in_Rec709-D65_sRGB-Piecewise.a2.v1",
           ("ACES 2.0", "Display P3"): AMF + "v2.0:Output.Academy.P3-D65_100nit_in_P3-D65_sRGB-Piecewise.a2.v1",
           ("ACES 1.3", "Rec.1886"): AMF + "v1.5:ODT.Academy.Rec709_100nits_dim.a1.0.3",
           ("ACES 1.3 - HDR 1000 nits", "Rec.2100-PQ"): AMF + "v1.5:RRTODT.Academy.Rec2020_1000nits_15nits_ST2084.a1.1.0"}


@pytest.fixture(scope="module", autouse=True)
def logging_level():
    """OpenColorIO's warnings are messages, whatever level another file has set."""
    level = ocio.GetLoggingLevel()
    ocio.SetLoggingLevel(ocio.LOGGING_LEVEL_WARNING)
    yield
    ocio.SetLoggingLevel(level)


@contextlib.contextmanager
def logged():
    """OpenColorIO's messages."""
    lines = []
    ocio.SetLoggingFunction(lambda message: lines.append(message.strip()))
    try:
        yield lines
    finally:
        ocio.ResetToDefaultLoggingFunction()


def names(config):
    spaces = list(config.getColorSpaces(ocio.SEARCH_REFERENCE_SPACE_ALL, ocio.COLORSPACE_ALL))
    return {"displays": list(config.getDisplays()), "views": {d: list(config.getViews(d)) for d in config.getDisplays()},
            "spaces": sorted(s.getName() for s in spaces), "looks": list(config.getLookNames()),
            "default view transform": config.getDefaultViewTransformName(),
            "view transforms": list(config.getViewTransformNames()),
            "virtual display": [list(config.getVirtualDisplayViews(kind))
                                for kind in (ocio.VIEW_DISPLAY_DEFINED, ocio.VIEW_SHARED)],
            "roles": dict(zip(config.getRoleNames(), (config.getColorSpace(r).getName() for r in config.getRoleNames())))}


def check_numbers(report, name, config):
    """Every view on every display, as applications compute it and without optimization, against probe.csv."""
    config.setWorkingDir(str(FOLDER))
    probes = check_config.read_probes(FOLDER / "probe.csv")
    failed, largest = [], 0.0
    for key, colors in probes.items():
        line, ok = check_config.compare(ocio, config, key, colors)
        if not ok:
            failed.append(line)
        if config.getMinorVersion() >= 4 and key[1] == "ACES 2.0":
            processor = config.getProcessor(key[2], key[0], key[1], ocio.TRANSFORM_DIR_FORWARD)
            error, _ = check_config.worst(processor.getDefaultCPUProcessor(), colors)
            largest = max(largest, error)
    report.check(f"{name}: {len(probes)} views on displays are the reference's", not failed and len(probes) >= 80,
                 failed[:3])
    if config.getMinorVersion() >= 4:
        report.check(f"{name}: ACES 2.0 is OpenColorIO's own: {largest:.1e} from the reference, at most {ACES_20:g}",
                     0 < largest <= ACES_20)


def check_ids(report, config):
    wrong = [(space, config.getColorSpace(space).getInteropID()) for space, id_ in INTEROP_IDS.items()
             if config.getColorSpace(space).getInteropID() != id_]
    report.check(f"{len(INTEROP_IDS)} interop ids", not wrong, wrong[:3])
    missing = []
    for (view, display), urn in AMF_IDS.items():
        transform = config.getViewTransform(config.getDisplayViewTransformName(display, view))
        for thing in (transform, config.getColorSpace(display)):
            if urn not in thing.getInterchangeAttributes().get("amf_transform_ids", "").splitlines():
                missing.append((view, display))
    report.check("an output's AMF id is with its view transform and its display", not missing, missing)
    ids = config.getColorSpace("ACEScct").getInterchangeAttributes().get("amf_transform_ids", "")
    report.check("AMF ids of spaces", AMF + "v2.0:CSC.Academy.ACEScct_to_ACES.a2.v1" in ids.splitlines(), ids)


def check_same_ids(report, config):
    """The same interop ids as in OpenColorIO's own config: equal from 0 to 1; docs/config.md says what is below 0."""
    theirs = ocio.Config.CreateFromBuiltinConfig("ocio://cg-config-latest")
    linear = {"rec709": "lin_rec709_scene", "p3d65": "lin_p3d65_scene", "ap1": "lin_ap1_scene"}
    ids = [space.getInteropID() for space in theirs.getColorSpaces(ocio.SEARCH_REFERENCE_SPACE_ALL, ocio.COLORSPACE_ALL)]
    ids = [id_ for id_ in ids if re.match(r"(ocio:)?(srgb|g22|g24|pq)_.*_(scene|display)$", id_) and config.getColorSpace(id_)]
    wrong, below = [], {}
    for id_ in ids:
        for value in (-0.1, 0.001, 0.18, 0.5, 1):
            pair = []
            for one in (theirs, config):
                start = linear[id_.split("_")[1]] if id_.endswith("_scene") else one.getRoleColorSpace("cie_xyz_d65_interchange")
                white = [1, 1, 1] if id_.endswith("_scene") else [0.9504559, 1, 1.0890578]
                light = [value * w for w in white]
                pair.append(one.getProcessor(start, id_).getDefaultCPUProcessor().applyRGB(light)[1])
            if value < 0:
                below[id_] = [round(v, 3) for v in pair]
            elif abs(pair[0] - pair[1]) > 3e-4:
                wrong.append((id_, value, pair))
    report.check(f"{len(ids)} interop ids of both configs: the same codes from 0 to 1", len(ids) >= 10 and not wrong, wrong)
    wanted = {"g22_rec709_scene": [-0.1, 0], "srgb_rec709_scene": [-1.292, -1.292], "srgb_rec709_display": [-0.349, -1.292],
              "g22_rec709_display": [-0.351, 0], "pq_rec2020_display": [-0.3, 0]}
    found = {id_: below.get(id_) for id_ in wanted}
    report.check("and below 0 what docs/config.md says", found == wanted, found)


def test_text(report):
    """Where the library cannot read 2.5: what is not in the other files is what 2.5 is for."""
    old = (FOLDER / "config.ocio").read_text()
    older = (FOLDER / "config-2.0.ocio").read_text()
    report.check("config-2.0.ocio says the same", older == re.sub("^ocio_profile_version: 2.1", "ocio_profile_version: 2",
                                                                 old), "it differs")
    try:
        import yaml
    except ImportError:
        print("skipped: config-2.5.ocio is not compared, PyYAML is not installed (Debian: python3-yaml)")
        return

    class Loader(yaml.SafeLoader):
        """Tags are a part of what a config says."""

    def tagged(loader, suffix, node):
        if isinstance(node, yaml.MappingNode):
            return (suffix, loader.construct_mapping(node, deep=True))
        return (suffix, loader.construct_sequence(node, deep=True))

    Loader.add_multi_constructor("", tagged)
    a = yaml.load(old, Loader)
    b = yaml.load((FOLDER / "config-2.5.ocio").read_text(), Loader)
    report.check("profile 2.5 says its version", str(b.pop("ocio_profile_version")) == "2.5")
    a.pop("ocio_profile_version")
    spaces = {space["name"]: space for part in ("colorspaces", "display_colorspaces") for _, space in b[part]}
    wrong = [name for name, id_ in INTEROP_IDS.items() if spaces[name].get("interop_id") != id_]
    report.check(f"profile 2.5 has {len(INTEROP_IDS)} interop ids", not wrong, wrong)
    # OpenColorIO 2.6 calls a config compatible with HDR displays if it obeys these rules (its issue 2344).
    views = [(display, kind, view) for display, all_views in b["displays"].items() for kind, view in all_views]
    shared = {view["name"]: view for _, view in b["shared_views"]}
    plain = [(display, name) for display, kind, names in views
             for view in ([shared[name] for name in names] if kind == "Views" else [names]) for name in [view["name"]]
             if not view.get("view_transform") and not spaces[view["colorspace"]].get("isdata")]
    report.check("profile 2.5: every view has a view transform or is data", len(views) > 8 and not plain, plain)
    bare = [display for display in b["displays"] if not spaces[display].get("interop_id") or not spaces[display].get("encoding")]
    report.check("profile 2.5: every display has a space of its name, with interop id and encoding",
                 not bare and "cie_xyz_d65_interchange" in b["roles"], bare)
    unnamed = [name for name, space in spaces.items() if space.get("interop_id") not in (None, name, "data",
                                                                                          *space.get("aliases", []))]
    report.check("profile 2.5: every interop id is an alias", not unnamed, unnamed)
    transforms = {transform["name"]: transform for _, transform in b["view_transforms"]}
    shown = {(view["name"], display): view["view_transform"] for display, views in b["displays"].items()
             for kind, view in views if kind == "View"}
    missing = [key for key, urn in AMF_IDS.items() for thing in (transforms[shown[key]], spaces[key[1]])
               if urn not in thing["interchange"]["amf_transform_ids"].splitlines()]
    report.check("profile 2.5 has the AMF ids of outputs", not missing, missing)
    builtins, ids = [], 0
    for part in ("colorspaces", "display_colorspaces", "view_transforms"):
        for (_, new), (_, base) in zip(b[part], a[part]):
            ids += "interop_id" in new
            new.pop("interop_id", None)
            new.pop("interchange", None)
            if new != base:
                builtins.append(new["name"])
                new.clear()
                new.update(base)
    report.check("profile 2.5 adds ids", ids >= 30, ids)
    report.check("profile 2.5 has the built-in ACES 2.0",
                 builtins and all(name.startswith("ACES 2.0 (") for name in builtins), builtins)
    report.check("the rest of profile 2.5 is the same", a == b, [key for key in a if a[key] != b.get(key)])


def load(name):
    return ocio.Config.CreateFromFile(str(FOLDER / name))


@pytest.mark.parametrize("version", FILES, ids=FILES.get)
def test_file(report, version):
    """It is read and used without a message, or refused by its version."""
    name = FILES[version]
    print(f"OpenColorIO {ocio.GetVersion()}")
    if version > VERSION:
        with logged():
            try:
                load(name)
                refused = ""
            except ocio.Exception as error:
                refused = str(error)
        report.check(f"{name} is refused by its version", "version" in refused, refused)
        return
    with logged() as lines:
        config = load(name)
        config.validate()
    report.check(f"{name} loads and validates without a word", not lines, lines[:3])
    report.check(f"{name} has its version", (config.getMajorVersion(), config.getMinorVersion()) == version)
    with logged() as lines:
        check_numbers(report, name, config)
    report.check(f"{name} is used without a word", not lines, lines[:3])
    if version == (2, 5):
        check_ids(report, config)
        check_same_ids(report, config)


def test_names(report):
    said = {name: names(load(name)) for version, name in FILES.items() if version <= VERSION}
    first = said["config.ocio"]
    differ = [(name, part) for name, others in said.items() for part in first if others[part] != first[part]]
    report.check("scene light is converted to a display as it is", first["default view transform"] == "Un-tone-mapped")
    report.check(f"the same names in {', '.join(said)}", not differ and len(said) > 1, differ)
