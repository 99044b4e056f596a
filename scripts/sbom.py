#!/usr/bin/env python3
"""scripts/sbom.py FILE: what the artifacts contain of others, as CycloneDX JSON.

The list is packaging/dependencies.json; versions are those of the Debian packages in build/sysroot,
which the artifacts are built from (of this machine where there is none), and of nanobind in the
environments of scripts/artifacts.sh. SOURCE_DATE_EPOCH is its time.
"""

import json
import os
import re
import subprocess
import sys
import time
import uuid
from pathlib import Path

import stamp

root = stamp.root


def debian_version(package: str) -> "str | None":
    """The upstream version of a package in build/sysroot, else of an installed one."""
    try:
        listed = (root / "build/sysroot/versions").read_text(encoding="utf-8")
    except OSError:
        listed = ""
    full = dict(line.split("\t") for line in listed.splitlines()).get(package)
    if full is None:
        try:
            ran = subprocess.run(
                ["dpkg-query", "-W", "-f", "${Version}", package],
                capture_output=True, text=True, check=True,
            )
        except (OSError, subprocess.CalledProcessError):
            return None
        full = ran.stdout
    upstream = re.sub(r"^\d+:|-[^-]*$", "", full)
    return re.sub(r"[.+~](dfsg|ds|really).*$", "", upstream)


def pypi_version(package: str) -> "str | None":
    """The version in the newest environment that a wheel was built with."""
    found = sorted((root / "build/wheel").glob(f"venv-*/lib/*/site-packages/{package}-*.dist-info"))
    return found[-1].name[len(package) + 1 : -len(".dist-info")] if found else None


def component(entry: dict) -> dict:
    version = entry.get("version")
    if version is None and "debian" in entry:
        version = debian_version(entry["debian"])
    if version is None and "pypi" in entry:
        version = pypi_version(entry["pypi"])
    purl = entry["purl"] + (f"@{version}" if version else "")
    made = {
        "type": "library",
        "bom-ref": purl,
        "name": entry["name"],
        **({"version": version} if version else {}),
        "licenses": [{"expression": entry["license"]}],
        "copyright": entry["copyright"],
        "purl": purl,
        "externalReferences": [{"type": "website", "url": entry["url"]}],
        "properties": [{"name": "cullhull:in", "value": kind} for kind in entry["in"]],
    }
    return made


def bill() -> dict:
    version, repository = stamp.version(), stamp.repository()
    listed = json.loads((root / "packaging/dependencies.json").read_text(encoding="utf-8"))
    components = [component(entry) for entry in listed["bundled"]]
    own = f"pkg:github/{stamp.slug(repository)}@v{version}"
    epoch = int(os.environ.get("SOURCE_DATE_EPOCH", time.time()))
    return {
        "$schema": "http://cyclonedx.org/schema/bom-1.5.schema.json",
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "serialNumber": f"urn:uuid:{uuid.uuid5(uuid.NAMESPACE_URL, f'{repository}/{version}/{epoch}')}",
        "version": 1,
        "metadata": {
            "timestamp": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(epoch)),
            "component": {
                "type": "application",
                "bom-ref": own,
                "name": "cullhull",
                "version": version,
                "licenses": [{"expression": "MIT"}],
                "purl": own,
                "externalReferences": [{"type": "vcs", "url": repository}],
            },
        },
        "components": components,
        "dependencies": [{"ref": own, "dependsOn": [part["bom-ref"] for part in components]}],
    }


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: scripts/sbom.py FILE")
    Path(sys.argv[1]).write_text(json.dumps(bill(), indent=2) + "\n", encoding="utf-8")
    print(f"written: {sys.argv[1]}")
