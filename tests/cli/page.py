"""page.py PAGE.html: every text of the JSON in a page of analyze report, a line each, without the pictures.
page.py PAGE.html EXPRESSION...: fails where one is not so; `page` is the JSON, `field(f)` the values of a field of a picture."""
import base64
import json
import re
import sys


def read(path):
    with open(path, encoding="utf-8") as file:
        return json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', file.read(), re.S)[1])


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
