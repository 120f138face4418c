"""named_files.py: exit 1 where a comment of a source file names a source file that is not there, or where no README of a
program names one of its source files (by its stem, or by what it adds to the one before it: `_bar` of foo_bar)."""
import os
import re
import subprocess
import sys

files = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], text=True, capture_output=True,
                       check=True).stdout.split()
files = [f for f in files if os.path.exists(f)]
names, missing = {os.path.basename(f) for f in files}, []
for path in files:
    if not path.startswith(("common/", "ct2model/", "sphsolve/", "analyze/")) or not path.endswith((".c", ".h", ".cc")):
        continue
    for comment in re.findall(r"/\*.*?\*/", open(path, encoding="utf-8").read(), re.S):
        for name in re.findall(r"(?<![\w/])[\w/]*\b[a-z]\w+\.(?:c|h|cc|def|bats|py)\b", comment):
            there = any(("/" + f).endswith("/" + name) for f in files) if "/" in name else name in names
            if not there and not name.startswith("METHOD/"):
                missing.append(f"{path}: {name}")
for program in ("common", "ct2model", "sphsolve", "analyze"):
    pages = [f for f in files if f.startswith(program + "/") and f.endswith("/README.md")]
    quoted = re.findall(r"`([^`]+)`", "".join(open(page, encoding="utf-8").read() for page in pages))
    told = {word.split("/")[-1].split(".")[0] for words in quoted for word in re.split(r"[ ,]+", words)}
    for path in files:
        stem = os.path.basename(path).split(".")[0]
        if not path.startswith(program + "/") or not path.endswith((".c", ".h", ".cc")) or "/effects/" in path or "/kernels/" in path:
            continue
        if stem not in told and not any(word.startswith("_") and stem.endswith(word) for word in told):
            missing.append(f"{program}/README.md: {path} is not named")
for line in missing:
    print(line)
sys.exit(bool(missing))
