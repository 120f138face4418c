"""named_files.py: exit 1 where a comment of a source file names a source file that is not there."""
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
for line in missing:
    print(line)
sys.exit(bool(missing))
