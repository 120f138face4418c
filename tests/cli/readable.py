"""readable.py ROOT: the pages for readers keep their rules. Lines of at most 120 characters; no commit hashes, no history
("was 9.3"); links lead to files that are there. Prints what does not keep them."""
import glob
import os
import re
import sys

HASH = re.compile(r"\b(?=[0-9a-f]*\d)(?=[0-9a-f]*[a-f])[0-9a-f]{7,40}\b")
PAST = re.compile(r"\(was \S|\bwas \.?\d|\bwere \.?\d")
LINK = re.compile(r"\]\(([^)#]+?)(?:#[^)]*)?\)")


def complaints(path):
    with open(path) as file:
        for number, line in enumerate(file, 1):
            at = f"{path}:{number}"
            if len(line.rstrip("\n")) > 120:
                yield f"{at}: {len(line) - 1} characters"
            if HASH.search(line):
                yield f"{at}: a commit: {HASH.search(line)[0]}"
            if PAST.search(line):
                yield f"{at}: history belongs in the log of git: {PAST.search(line)[0]}"
            for link in LINK.findall(line):
                if "://" not in link and not os.path.exists(os.path.join(os.path.dirname(path), link)):
                    yield f"{at}: no such page: {link}"


def main():
    root = sys.argv[1]
    pages = [os.path.join(root, name) for name in ("README.md", "CHANGELOG.md", "CONTRIBUTING.md")]
    pages += sorted(glob.glob(os.path.join(root, "docs", "**", "*.md"), recursive=True))
    pages += sorted(glob.glob(os.path.join(root, "*", "README.md")) + glob.glob(os.path.join(root, "data-samples", "*", "README.md")))
    found = [c for page in pages for c in complaints(page)]
    print("\n".join(found))
    return len(found) > 0


if __name__ == "__main__":
    sys.exit(main())
