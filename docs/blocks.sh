#!/usr/bin/env bash
# Do the blocks of the guides run? docs/blocks.sh PROGRAM [PAGE...]
# Blocks below a line `<!-- run -->` of docs/*.md (or of the pages named), page by page in a fresh folder: those of the shell in one shell
# that stops at the first error, then those of Python in one interpreter. `hookeye` is PROGRAM there; its module is in HOOKEYE_PYTHON.
# The folder has sample_scenes, with recipes cut down to seconds (tests/docs/run/shrink.py).
# Exits 1 with the page and the line of the block that failed.
set -euo pipefail
[ $# -ge 1 ] || { echo "usage: docs/blocks.sh PROGRAM [PAGE...]" >&2; exit 2; }
program=$(realpath "$1")
shift
root=$(realpath "$(dirname "${BASH_SOURCE[0]}")/..")
pages=("$@")
[ "${#pages[@]}" -gt 0 ] || mapfile -t pages < <(grep -lx '<!-- run -->' "$root"/docs/*.md)
[ "${#pages[@]}" -gt 0 ] || { echo "no page has a block to run" >&2; exit 2; }
if ! /usr/bin/python3 -c 'import yaml' 2>/dev/null; then
  echo "NOT RUN: python3-yaml is missing (apt-get install python3-yaml)"
  exit 0
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/bin"
printf '#!/bin/sh\nexec "%s" --threads 1 "$@"\n' "$program" > "$folder/bin/hookeye"
chmod +x "$folder/bin/hookeye"
export PATH=$folder/bin:$PATH

# The marked blocks as one script; each says where it stands, so that the last one said is the one that failed.
script_of() {
  awk -v file="$(basename "$1")" '
    /^<!-- run -->$/ { marked = 1; next }
    /^```/ && inside { inside = 0; next }
    /^```python$/ && marked { marked = 0; other = 1; next }
    /^```/ && marked { inside = 1; marked = 0; blocks++; printf "at=%s:%d\n", file, FNR; next }
    /^```/ { other = !other }
    inside { print; next }
    marked && NF { print "echo \"" file ":" FNR ": no block follows `<!-- run -->`\" >&2; exit 1"; exit }
    END { if (inside) print "exit 1" }' "$1"
}

# The marked blocks of Python, each line where it stands in the page: a traceback tells the page's own lines.
python_of() {
  awk '
    /^<!-- run -->$/ { marked = 1; print ""; next }
    /^```/ && inside { inside = 0; print ""; next }
    /^```python$/ && marked { inside = 1; marked = 0; print "# block"; next }
    NF { marked = 0 }
    { print inside ? $0 : "" }' "$1"
}

failed=0
count=0
for page in "${pages[@]}"; do
  here=$folder/$(basename "$page" .md)
  mkdir "$here"
  cp -r "$root/sample_scenes" "$here"
  /usr/bin/python3 -B "$root/tests/docs/run/shrink.py" "$here"/sample_scenes/*.yaml
  script_of "$page" > "$here.sh"
  python_of "$page" > "$here.py"
  blocks=$(grep -c '^at=' "$here.sh" || true)
  scripts=$(grep -c '^# block$' "$here.py" || true)
  if [ "$scripts" -gt 0 ]; then
    if [ -z "${HOOKEYE_PYTHON:-}" ]; then
      echo "$(basename "$page"): $scripts blocks of Python are left out (HOOKEYE_PYTHON does not tell where the module is)"
      scripts=0
    else
      printf 'at="%s, Python"\nPYTHONPATH="%s" /usr/bin/python3 -B "%s"\n' "$(basename "$page")" "$HOOKEYE_PYTHON" "$here.py" >> "$here.sh"
    fi
  fi
  count=$((count + blocks + scripts))
  # shellcheck disable=SC2016
  if ! (cd "$here" && bash -c 'set -eu; trap '\''[ $? = 0 ] || echo "$at: this block failed"'\'' EXIT; . "$1"' - "$here.sh" \
    > "$here.log" 2>&1 < /dev/null); then
    tail -n 15 "$here.log"
    failed=$((failed + 1))
  fi
done
echo "$count blocks of ${#pages[@]} pages run, $failed pages failed"
[ "$failed" -eq 0 ]
