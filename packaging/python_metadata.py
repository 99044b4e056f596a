"""What pyproject.toml leaves to the build: the version, the links, and README.md with absolute links.

A page on PyPI has no files beside it, so every relative link of the README gets the address of the
file in the repository (repository.txt) at the tag of this version.
"""

import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

root = Path(__file__).resolve().parents[1]
repository = (root / "packaging/repository.txt").read_text(encoding="utf-8").strip()
pictures = (".png", ".svg", ".jpg", ".gif", ".webp")


def version() -> str:
    header = (root / "include/cullhull/version.hpp").read_text(encoding="utf-8")
    found = re.search(r'#define CULLHULL_VERSION "(.+)"', header)
    assert found is not None
    return found[1]


def labelled_version() -> str:
    """With the label of a build that differs from the one on PyPI: 0.1.0+cu13."""
    label = os.environ.get("CULLHULL_LOCAL_VERSION", "")
    return f"{version()}+{label}" if label else version()


def absolute(target: str) -> str:
    """The address of a file that the README links to; what is absolute already is left alone."""
    if re.match(r"[a-z]+:|#|//", target):
        return target
    path = target.removeprefix("./")
    if path.partition("#")[0].endswith(pictures):
        files = repository.replace("https://github.com/", "https://raw.githubusercontent.com/")
        return f"{files}/v{version()}/{path}"
    return f"{repository}/blob/v{version()}/{path}"


def absolute_links(text: str) -> str:
    text = re.sub(r"(?<=\]\()([^)\s]+)(?=[)\s])", lambda found: absolute(found[1]), text)
    text = re.sub(
        r"^(\[[^\]]+\]:\s+)(\S+)", lambda found: found[1] + absolute(found[2]), text, flags=re.M
    )
    return re.sub(
        r"""(?<=\s)((?:src|href|srcset)=["'])([^"']+)""",
        lambda found: found[1] + absolute(found[2]),
        text,
    )


def readme(text: str) -> str:
    """Markdown with the relative targets of links, pictures and HTML attributes made absolute."""
    parts = re.split(r"^(```.*?^```$)", text, flags=re.M | re.S)  # code stays as it is
    return "".join(part if i % 2 else absolute_links(part) for i, part in enumerate(parts))


def documentation() -> str:
    """The site that GitHub Pages makes of docs/."""
    owner, name = repository.split("/")[-2:]
    return f"https://{owner.lower()}.github.io/{name}/"


def dynamic_metadata(settings: Mapping[str, Any], project: Mapping[str, Any]) -> "dict[str, Any]":
    """Called by scikit-build-core: the fields that [project] names as dynamic."""
    text = (root / "README.md").read_text(encoding="utf-8")
    return {
        "version": labelled_version(),
        "readme": {"text": readme(text), "content-type": "text/markdown"},
        "urls": {
            "Homepage": repository,
            "Documentation": documentation(),
            "Source": repository,
            "Issues": f"{repository}/issues",
            "Changelog": f"{repository}/blob/v{version()}/CHANGELOG.md",
        },
    }
