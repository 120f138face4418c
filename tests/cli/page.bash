# A page of analyze report: `page PAGE.html EXPRESSION...` and `said PAGE.html ARGUMENTS OF GREP` (page.py).
page() { /usr/bin/python3 "$BATS_TEST_DIRNAME/page.py" "$@"; }
said() { page "$1" | grep "${@:2}"; }
