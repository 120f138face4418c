"""page.py PAGE.html: every text of the JSON in a page of analyze report, a line each, without the pictures.
page.py PAGE.html EXPRESSION...: fails where one is not so; `page` is the JSON, `field(f)` the values of a field of a picture.

The JSON is as the page's own script page_words.js completes it with its sentences, which needs nodejs."""
import base64
import hashlib
import json
import os
import re
import subprocess
import sys


def read(path, change=None):
    """The JSON of the page, with what change(data) makes of it before the sentences are."""
    with open(path, encoding="utf-8") as file:
        html = file.read()
    data = json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', html, re.S)[1])
    script = next((s for s in re.findall(r"<script>(.*?)</script>", html, re.S) if "const words = (function" in s), None)
    if script is None:  # a page of ct2model
        return data
    if change:
        change(data)
    # What node takes longest for is to start: once for each page, whichever of a run's tests ask.
    folder = os.environ.get("BATS_RUN_TMPDIR")
    kept = folder and not change and os.path.join(folder, hashlib.sha256(html.encode()).hexdigest() + ".page")
    if kept and os.path.exists(kept):
        with open(kept, encoding="utf-8") as file:
            return json.load(file)
    call = "const data = JSON.parse(require('fs').readFileSync(0, 'utf8')); process.stdout.write(JSON.stringify(words.fill(data)));"
    told = subprocess.run(["node", "-e", script + call], input=json.dumps(data), capture_output=True, text=True)
    assert told.returncode == 0, told.stderr
    if kept:
        with open(kept, "w", encoding="utf-8") as file:
            file.write(told.stdout)
    return json.loads(told.stdout)


def field(f):
    import numpy as np  # takes longer to load than all else here

    values = np.frombuffer(base64.b64decode(f["bytes"]), np.uint8).astype(float)
    return np.where(values == 255, np.nan, f["low"] + values / 254 * (f["high"] - f["low"]))


def texts(value):
    if isinstance(value, dict):
        for one in value.values():
            yield from texts(one)
    elif isinstance(value, list):
        for one in value:
            yield from texts(one)
    elif isinstance(value, str):
        yield value


if __name__ == "__main__":
    page = read(sys.argv[1])
    for expression in sys.argv[2:]:
        assert eval(expression), (expression, {k: v for k, v in page.items() if k in ("verdict", "headline", "model")})
    if len(sys.argv) == 2:
        page.pop("pictures")
        print("\n".join(t for t in texts(page) if len(t) < 5000))
