#!/usr/bin/env bats
# ct2model survey: the page to look at before a model is made.

bats_require_minimum_version 1.5.0
load page
setup_file() {
  export ROOT=$(cd "$BATS_TEST_DIRNAME/../.." && pwd)
  local build=${BUILD:-build}
  case $build in /*) ;; *) build=$ROOT/$build ;; esac
  export PATH="$build/bin:$PATH" OMP_NUM_THREADS=1
  export SCAN="$ROOT/data-samples/small --voxel-size 8.745um --quiet"
  cd "$BATS_FILE_TMPDIR"
  ct2model survey $SCAN --void-ratio 0.725+-0.01 --crop 8,16,3,96,80,20 -o scan.html
}
setup() { cd "$BATS_FILE_TMPDIR"; }

@test "curve, threshold and scanner are those of sweep" {
  ct2model sweep $SCAN --void-ratio 0.725+-0.01 --crop 8,16,3,96,80,20 --json > sweep.json
  /usr/bin/python3 - << 'END'
import json, os, sys
import numpy as np
sys.path.insert(0, os.environ["ROOT"] + "/tests/cli")
import page
survey, sweep = page.read("scan.html"), json.load(open("sweep.json"))
for own, other in (survey, sweep), (survey["scanner"], sweep["scanner"]), (survey["sweep"], sweep["sweep"]):
    for key in {"threshold_original", "threshold_otsu", "pore_peak", "void_ratio_original", "blur_m", "threshold", "void_ratio", "histogram"} & set(own):
        if key != "threshold" or own is survey["sweep"]:  # that of a survey is the scan's own
            assert np.allclose(own[key], other[key], rtol=1e-10), key
assert survey["size_original"] == [96, 80, 20] and survey["void_ratio_measured"] == 0.725 and "labels" not in survey
END
}

@test "without a void ratio it begins at Otsu's threshold; of labels it says how much each fills" {
  ct2model survey $SCAN -o otsu.html
  page otsu.html 'page["void_ratio_measured"] is None and page["threshold_original"] == page["threshold_otsu"]'
  ct2model survey "$ROOT/data-samples/berea/berea-96.tif" --quiet -o labels.html
  page labels.html '[l["label"] for l in page["labels"]] == [0, 255]' \
    'abs(sum(l["fraction"] for l in page["labels"]) - 1) < 1e-12' \
    'abs(page["labels"][0]["fraction"] / page["labels"][1]["fraction"] / page["void_ratio_original"] - 1) < 1e-9'
}

@test "slices are the scan's voxels, within the crop" {
  /usr/bin/python3 -c "
import numpy as np
z, y, x = np.indices((30, 90, 110))
np.save('scan.npy', np.clip(np.sin(x / 5) * np.sin(y / 6) * np.sin(z / 4 + 1) * 60 + 100 + np.random.default_rng(1).normal(0, 5, x.shape), 0, 255).astype(np.uint8))"
  ct2model survey scan.npy --void-ratio 1 --crop 8,6,3,96,80,20 --quiet -o crop.html 2> /dev/null
  /usr/bin/python3 - << 'END'
import os, sys
import numpy as np
sys.path.insert(0, os.environ["ROOT"] + "/tests/cli")
import page
scan, slices = np.load("scan.npy").astype(float), page.read("crop.html")["pictures"]["slices"]
assert slices["size"] == [96, 80] and slices["number"] == [6, 10, 14, 18, 22]
for number, grey in zip(slices["number"], slices["grey"]):  # to half a step of a byte, between the ends of the curve
    own = np.clip(scan[number - 1, 6:86, 8:104], grey["low"], grey["high"])
    assert abs(page.field(grey).reshape(80, 96) - own).max() <= 0.51 * (grey["high"] - grey["low"]) / 254
END
}

@test "a wide scan: its middle voxel by voxel, and one slice in all its width" {
  /usr/bin/python3 -c "
import numpy as np
x = np.indices((3, 60, 1000))
np.save('wide.npy', (np.sin(x[2] / 9) * 60 + 100 + x[1] / 10 + np.random.default_rng(1).normal(0, 5, x[0].shape)).astype(np.uint8))"
  ct2model survey wide.npy --void-ratio 1 --quiet -o wide.html 2> /dev/null
  page wide.html '(lambda p: (p["slices"]["size"], p["slices"]["from"], p["whole"]["size"], p["whole"]["every"]))(page["pictures"]) == ([400, 60], [300, 0], [333, 20], 3)' \
    'page["voxel_size_m"] is None and "edge" not in page' \
    'abs(field(page["pictures"]["whole"]["grey"]).reshape(20, 333)[:, 100:233] - field(page["pictures"]["slices"]["grey"][1]).reshape(60, 400)[::3, ::3][:, :133]).max() == 0'
}

@test "the page needs nothing beside it, and is no other file's place" {
  ! grep -qE '(src|href)="(https?:)?//|@import|url\(' scan.html
  for id in $(grep -o "by('[a-z-]*')" "$ROOT/ct2model/survey_page.js" | sort -u | cut -d"'" -f2); do
    grep -q "id=\"$id\"" "$ROOT/ct2model/survey_page.html" || { echo "no $id in survey_page.html"; false; }
  done
  run -2 ct2model survey $SCAN --void-ratio 0.725
  [[ $output == *"-o page.html is missing" ]]
  run -2 ct2model survey $SCAN --void-ratio 0.725 -o page.hdf
  run -2 ct2model survey $SCAN --void-ratio 0.7,0.8 -o page.html
  [[ $output == *"one --void-ratio is possible"* ]]
  run -2 ct2model survey $SCAN --size 10x10x10 -o page.html
  echo mine > own.html
  run -2 ct2model survey $SCAN -o own.html
  [ "$(cat own.html)" = mine ]
}

@test "in a browser: the threshold moves the void ratio and the command, by keyboard; on a telephone nothing is too wide" {
  command -v chromium > /dev/null || skip "chromium is not installed"
  narrow scan
  # A browser without a screen and with a clock of its own draws no frames of its own accord.
  sed 's#</body>#<script>window.requestAnimationFrame = draw => setTimeout(draw, 0); setTimeout(() => {\
    const by = id => document.getElementById(id), said = [by("state").textContent, by("command").textContent];\
    const pixels = () => { const c = document.querySelector("\#slice canvas"); return c.toDataURL(); }, before = pixels();\
    by("value").value = 80;\
    by("value").dispatchEvent(new Event("change"));\
    setTimeout(() => {\
      by("height").value = 0;\
      by("height").dispatchEvent(new Event("input"));\
      document.title = JSON.stringify([...said, by("state").textContent, by("command").textContent, before !== pixels()]); }, 500); }, 2000)</script></body>#' scan.html > moved.html
  browse moved.html > dom.html
  /usr/bin/python3 - << 'END'
import html, json, os, re, subprocess
first, command, moved, other, redrawn = json.loads(html.unescape(re.search("<title>(.*?)</title>", open("dom.html").read())[1]))
assert first.startswith("Void ratio 0.725, porosity 0.420, at threshold 56.8") and "measured: 0.725 ± 0.010" in first, first
assert "--threshold" not in command and "--void-ratio 0.725+-0.01 --voxel-size 8.745um --crop 8,16,3,96,80,20 -o model.hdf" in command, command
assert "at threshold 80.0" in moved and moved != first and "--threshold 80 " in other and redrawn, (moved, other, redrawn)
# The command is one that runs, and gives what the page says.
made = json.loads(subprocess.run(other.replace("build", "sweep").replace("-o model.hdf", "--json"), shell=True, capture_output=True).stdout)
assert f"{made['void_ratio_original']:.3g}" in moved, (made["void_ratio_original"], moved)
END
}
