# A page of analyze report: `page PAGE.html EXPRESSION...` and `said PAGE.html ARGUMENTS OF GREP` (page.py).
page() { /usr/bin/python3 "$BATS_TEST_DIRNAME/page.py" "$@"; }
said() { page "$1" | grep "${@:2}"; }

# PAGE...: that no element of PAGE.html is wider than a telephone. Chromium has no window under 500 pixels: each page is held
# to 390, and its widest element is measured.
narrow() {
  for page in "$@"; do
    sed 's#</head>#<style>html { width: 390px; }</style></head>#;s#</body>#<script>setTimeout(() => {\
      const inside = e => e \&\& (["auto", "scroll", "hidden"].includes(getComputedStyle(e).overflowX) || inside(e.parentElement));\
      const wide = [...document.body.querySelectorAll("*")].filter(e => (!inside(e.parentElement) || e.closest(".tensor")) \&\&\
        e.getBoundingClientRect().right > 391).map(e => e.tagName + "." + e.className);\
      document.title = "wide:" + wide.join(",") + ";"; }, 3000)</script></body>#' $page.html > narrow.html
    browse narrow.html > dom.html
    grep -o "<title>[^<]*" dom.html
    grep -q "<title>wide:;" dom.html || { echo "$page"; false; }
  done
}
# OPTION... FILE: a browser on a page of this folder.
in_browser() {
  timeout 120 chromium --headless --no-sandbox --disable-quic --no-first-run --disable-background-networking \
    --disable-component-update --disable-sync --user-data-dir="$PWD/profile" --use-angle=swiftshader --window-size=500,900 \
    --enable-unsafe-swiftshader --virtual-time-budget=20000 "${@:1:$#-1}" "file://$PWD/${!#}" 2> /dev/null
}
# PAGE.html: what a browser makes of it; and how many sheets it prints.
browse() { in_browser --dump-dom "$1"; }
sheets() {
  in_browser --no-pdf-header-footer --print-to-pdf="$PWD/paper.pdf" "$1" > /dev/null
  grep -a -o "/Type */Page\b" paper.pdf | wc -l
}
