# SPDX-License-Identifier: Apache-2.0
"""A CycloneDX 1.4 bill of materials of the packages: what they load, and the headers that are compiled into them.

    python3 debian/cyclonedx.py VERSION COMMIT SECONDS_SINCE_1970 DEBIAN_CONTROL PACKAGE.deb... >bom.json

Versions are those of the machine that built the packages. The same packages on the same machine give the same bytes.
"""

import datetime
import json
import re
import subprocess
import sys
import uuid

# Of debian/control: headers without a library of their own at run time.
HEADERS = ("libcli11-dev", "libtomlplusplus-dev", "libxbyak-dev", "nlohmann-json3-dev", "pybind11-dev")


def output_of(*line):
    return subprocess.run(line, stdout=subprocess.PIPE, text=True, check=True).stdout


def installed(names):
    """{package: (version, architecture)} of those that are installed."""
    line = ["dpkg-query", "-W", "-f=${db:Status-Status} ${Package} ${Version} ${Architecture}\n", *sorted(names)]
    rows = subprocess.run(line, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, check=False).stdout
    words = [row.split() for row in rows.splitlines()]
    return {name: (version, architecture) for status, name, version, architecture in words if status == "installed"}


def main():
    version, commit, seconds, control, *packages = sys.argv[1:]
    own = {output_of("dpkg-deb", "-f", package, "Package").strip() for package in packages}
    wanted = set()
    for package in packages:
        for choice in output_of("dpkg-deb", "-f", package, "Depends").split(","):
            wanted |= {re.split(r"[ (:]", name.strip())[0] for name in choice.split("|")} - {""}
    # What libtonewright-dev depends on is for programs that are built with it.
    libraries = installed({name for name in wanted - own if not name.endswith("-dev")})
    with open(control, encoding="utf-8") as file:
        text = file.read()
    headers = installed({name for name in HEADERS if re.search(rf"^ {re.escape(name)}\b", text, re.MULTILINE)})
    components = []
    for scope, found in (("required", libraries), ("excluded", headers)):
        for name, (its_version, architecture) in sorted(found.items()):
            purl = f"pkg:deb/debian/{name}@{its_version.replace('+', '%2B').replace(':', '%3A')}?arch={architecture}"
            component = {"type": "library", "bom-ref": purl, "name": name, "version": its_version, "scope": scope, "purl": purl}
            if scope == "excluded":  # at run time
                component["description"] = "headers, compiled into the libraries and the command"
            components.append(component)
    moment = datetime.datetime.fromtimestamp(int(seconds), datetime.timezone.utc)
    document = {
        "bomFormat": "CycloneDX",
        "specVersion": "1.4",
        "serialNumber": uuid.uuid5(uuid.NAMESPACE_URL, f"tonewright-{version}-{commit}").urn,
        "version": 1,
        "metadata": {
            "timestamp": moment.strftime("%Y-%m-%dT%H:%M:%SZ"),
            "component": {"type": "application", "bom-ref": "tonewright", "name": "tonewright", "version": version,
                          "licenses": [{"license": {"id": "Apache-2.0"}}]},
        },
        "components": components,
        "dependencies": [{"ref": "tonewright", "dependsOn": [component["bom-ref"] for component in components]}],
    }
    json.dump(document, sys.stdout, indent=2)
    print()


if __name__ == "__main__":
    main()
