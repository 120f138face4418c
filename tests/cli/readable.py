"""readable.py ROOT: the pages for readers keep their rules. Lines of at most 120 characters; no commit hashes, no history
("was 9.3"), decimals with a zero before the point; links lead to files and to headings that are there. Prints what does not
keep them."""
import glob
import os
import re
import sys

HASH = re.compile(r"\b(?=[0-9a-f]*\d)(?=[0-9a-f]*[a-f])[0-9a-f]{7,40}\b")
PAST = re.compile(r"\(was \S|\bwas \.?\d|\bwere \.?\d")
LINK = re.compile(r"\]\(([^)#]*?)(?:#([^)]*))?\)")
BARE = re.compile(r"(?<![\w.\d/])\.\d")


def anchors(path):
    """What a page's headings are linked by: lower case, without signs, hyphens for spaces."""
    with open(path) as file:
        return {re.sub(r"[^\w\- ]", "", line.lstrip("#").strip().lower()).replace(" ", "-") for line in file if line.startswith("#")}


def complaints(path):
    quoted = False
    with open(path) as file:
        for number, line in enumerate(file, 1):
            at = f"{path}:{number}"
            if len(line.rstrip("\n")) > 120:
                yield f"{at}: {len(line) - 1} characters"
            if HASH.search(line):
                yield f"{at}: a commit: {HASH.search(line)[0]}"
            if PAST.search(line):
                yield f"{at}: history belongs in the log of git: {PAST.search(line)[0]}"
            quoted ^= line.startswith("```")
            if not quoted and BARE.search(line):
                yield f"{at}: no zero before the point: {BARE.search(line)[0]}"
            for link, heading in LINK.findall(line):
                to = os.path.join(os.path.dirname(path), link) if link else path
                if "://" not in link and not os.path.exists(to):
                    yield f"{at}: no such page: {link}"
                elif heading and to.endswith(".md") and heading not in anchors(to):
                    yield f"{at}: no such heading: {link}#{heading}"


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
