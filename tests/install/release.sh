#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The files of a release that are no Debian packages (debian.sh tests those): checksums, signature, bills of materials, the
# archive in a folder of its own, OpenColorIO archives, LUTs.
# release.sh FOLDER_OF_RELEASE [PUBLIC_KEY_OF_MINISIGN]
set -euo pipefail
source=$(cd "$(dirname "$0")/../.." && pwd)
release=$(cd "$1" && pwd)
key=${2:+$(realpath "$2")}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0
expect() { # WHAT COMMAND...
    local what=$1
    shift
    if "$@" >"$work/log" 2>&1; then echo "ok: $what"; else echo "FAILED: $what" && cat "$work/log" && failed=1; fi
}
refuse() { ! "$@"; }

cd "$release"
expect "checksums" sha256sum --check --strict SHA256SUMS
# shellcheck disable=SC2016 # the inner shell expands
expect "each file has a checksum" bash -c 'for f in *; do
    case $f in SHA256SUMS*) continue ;; esac; grep -qF "  $f" SHA256SUMS || { echo "$f"; exit 1; }; done'
if [ -n "$key" ]; then
    expect "signature" minisign -V -q -m SHA256SUMS -p "$key"
    { cat SHA256SUMS; echo x; } >"$work/SHA256SUMS"
    cp SHA256SUMS.minisig "$work"
    expect "a changed file has none" refuse minisign -V -q -m "$work/SHA256SUMS" -p "$key"
fi
# Both name each package or file that they are about, and neither has the time of its making.
expect "SPDX" grep -q '^FileName: ./src/include/tonewright/version.h$' ./*.spdx
expect "CycloneDX" /usr/bin/python3 - ./*.cdx.json <<'TEXT'
import json
import sys

with open(sys.argv[1], encoding="utf-8") as file:
    bill = json.load(file)
names = {component["name"] for component in bill["components"]}
assert bill["bomFormat"] == "CycloneDX" and bill["specVersion"] == "1.4"
assert any(name.startswith("libopenimageio2") for name in names), names
assert any(name.startswith("libopencolorio2") for name in names), names
assert "libtomlplusplus-dev" in names, names
references = [component["bom-ref"] for component in bill["components"]]
assert len(references) == len(set(references)) and bill["dependencies"][0]["dependsOn"] == references
TEXT

# In a folder with a blank, from another folder, with an empty environment.
mkdir "$work/any where" "$work/elsewhere"
tar -C "$work/any where" -xf ./*.tar.xz
prefix=$(echo "$work/any where"/tonewright-*)
cd "$work/elsewhere"
clean() { env -i PATH=/usr/bin:/bin HOME="$work/elsewhere" LC_ALL=C.UTF-8 "$@"; }
program=$prefix/bin/tonewright
expect "archive: version" clean "$program" --version
expect "archive: chart" clean "$program" chart -o chart.exr --width 320 --height 180
expect "archive: apply" clean "$program" apply chart.exr command.exr --operator agx_blender -d float
expect "archive: bake" clean "$program" bake hable -o hable.cube
expect "archive: manual" clean man -M "$prefix/share/man" -w tonewright
# shellcheck disable=SC2016 # the inner shell expands
expect "archive: no library of another place" bash -c 'found=$(env -i ldd "$1" | grep libtonewright) &&
    [ "$(grep -c . <<<"$found")" -gt 0 ] && ! grep -vF "$2/" <<<"$found"' _ "$program" "$prefix"
plugins=$(dirname "$(find "$prefix" -name 'tonewright.imageio.so')")
expect "archive: plugin" clean OIIO_LIBRARY_PATH="$plugins" oiiotool 'chart.exr.tonewright?op=agx_blender' -d float -o plugin.exr
expect "archive: the plugin's picture is the command's" idiff -fail 0 command.exr plugin.exr
module=$(dirname "$(dirname "$(find "$prefix" -name '_tonewright*.so')")")
expect "archive: Python module" clean PYTHONPATH="$module" /usr/bin/python3 -B -c 'import tonewright
tonewright.tonemap_file("chart.exr", "python.exr", "agx_blender", dtype="float")'
expect "archive: the module's picture is the command's" idiff -fail 0 command.exr python.exr
expect "archive: config" ociocheck --iconfig "$prefix/share/tonewright/ocio_config/config.ocio"
expect "archive: LUTs" diff -r "$source/luts" "$prefix/share/tonewright/luts"
expect "archive: path of the build" refuse grep -rlF "$source/" "$prefix"

# An OpenColorIO archive is a ZIP file with config.ocio at its top; OpenColorIO 2.1 reads what is inside.
for profile in 2.0 2.1 2.5; do
    mkdir "$work/$profile"
    expect "$profile: archive" unzip -q -d "$work/$profile" "$release"/*-ocio-$profile.ocioz
    [ $profile = 2.5 ] || expect "$profile: config" ociocheck --iconfig "$work/$profile/config.ocio"
done
mkdir "$work/zip"
expect "LUTs: ZIP" unzip -q -d "$work/zip" "$release"/*-luts.zip
expect "LUTs: the committed ones" diff -r "$source/luts" "$work/zip/luts"
exit $failed
