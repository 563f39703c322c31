"""Fails unless the library's crates have the licences, and the ages, that docs/dependencies.md tells.

    cargo metadata --format-version 1 --locked | python3 tests/licences.py
"""
import json
import pathlib
import re
import sys

ALLOWED = {"MIT", "Apache-2.0", "BSD-2-Clause", "BSD-3-Clause", "Zlib", "Unlicense", "Unicode-3.0"}
OLDEST_RUST = (1, 85)

metadata = json.load(sys.stdin)
packages = {package["id"]: package for package in metadata["packages"]}
nodes = {node["id"]: node for node in metadata["resolve"]["nodes"]}


def is_allowed(licence):
    """Of alternatives one will do, of what is required together all must."""
    alternatives = re.split(r" OR |/", licence.replace("(", "").replace(")", ""))
    if " AND " in licence:
        required = [part.strip("() ") for part in licence.split(" AND ")]
        return all(is_allowed(part) for part in required)
    return any(alternative in ALLOWED for alternative in alternatives)


def in_library(name):
    """The crate and all that are compiled into it."""
    found, waiting = set(), [key for key, package in packages.items() if package["name"] == name]
    while waiting:
        key = waiting.pop()
        if key not in found:
            found.add(key)
            waiting += [
                used["pkg"]
                for used in nodes[key]["deps"]
                if any(kind["kind"] is None for kind in used["dep_kinds"])
            ]
    return [packages[key] for key in found]


page = (pathlib.Path(__file__).parents[1] / "docs" / "dependencies.md").read_text()
library = in_library("midsurface-capi")
assert len(library) > 10, "the list of crates cannot be read"
problems = []
for package in library:
    if not is_allowed(package["license"] or "none"):
        problems.append(f"{package['name']} is under {package['license']}")
    rust = tuple(int(part) for part in (package["rust_version"] or "0").split(".")[:2])
    if rust > OLDEST_RUST:
        problems.append(f"{package['name']} needs Rust {package['rust_version']}")
own = [package for package in packages.values() if package["id"] in metadata["workspace_members"]]
for name in {used["name"] for package in own for used in package["dependencies"]}:
    if f"`{name}`" not in page and name not in {package["name"] for package in own}:
        problems.append(f"docs/dependencies.md does not say why {name} is used")
if problems:
    sys.exit("\n".join(problems))
print(f"{len(library)} crates, all as they should be")
