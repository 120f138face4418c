"""documented_keys.py DOCS FILE.json...: each key of what the programs print with --json stands in a reference page (json.md, analyze.md,
formats.md) between backquotes. Names that a scene or a model gives are no keys. Prints those that do not; returns how many."""
import json
import re
import sys

NAMED = {"effects": False, "heads_m": True, "fluxes_m2_per_s": True, "levels_m": True, "taken_m2_per_s": True, "columns": True}


def keys(value):
    if isinstance(value, dict):
        for key, inner in value.items():
            yield key
            yield from keys(list(inner.values()) if NAMED.get(key) and isinstance(inner, dict) else inner)
    elif isinstance(value, list):
        for inner in value:
            yield from keys(inner)


def main():
    pages = "".join(open(f"{sys.argv[1]}/{page}.md").read() for page in ("json", "analyze", "formats"))
    known = {word for quoted in re.findall(r"`([^`\n]+)`", pages) for word in re.findall(r"\w+", quoted)}
    missing = [(path, key) for path in sys.argv[2:] for key in sorted(set(keys(json.load(open(path))))) if key not in known]
    for path, key in missing:
        print(f"{path}: the key {key} stands in no reference page")
    return len(missing) > 0


if __name__ == "__main__":
    sys.exit(main())
