#!/usr/bin/env bash
# Do the shell blocks of the guides run? docs/blocks.sh PROGRAM [PAGE...]
# Blocks below a line `<!-- run -->` of docs/*.md (or of the pages named), page by page in a fresh folder, in one shell that stops at the
# first error. `hookeye` is PROGRAM there. The folder has sample_scenes, with recipes cut down to seconds (tests/docs/run/shrink.py).
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
    /^```/ && marked { inside = 1; marked = 0; blocks++; printf "at=%s:%d\n", file, FNR; next }
    /^```/ { other = !other }
    inside { print; next }
    marked && NF { print "echo \"" file ":" FNR ": no block follows `<!-- run -->`\" >&2; exit 1"; exit }
    END { if (inside) print "exit 1" }' "$1"
}

failed=0
count=0
for page in "${pages[@]}"; do
  here=$folder/$(basename "$page" .md)
  mkdir "$here"
  cp -r "$root/sample_scenes" "$here"
  /usr/bin/python3 -B "$root/tests/docs/run/shrink.py" "$here"/sample_scenes/*.yaml
  script_of "$page" > "$here.sh"
  blocks=$(grep -c '^at=' "$here.sh" || true)
  count=$((count + blocks))
  # shellcheck disable=SC2016
  if ! (cd "$here" && bash -c 'set -eu; trap '\''[ $? = 0 ] || echo "$at: this block failed"'\'' EXIT; . "$1"' - "$here.sh" \
    > "$here.log" 2>&1 < /dev/null); then
    tail -n 15 "$here.log"
    failed=$((failed + 1))
  fi
done
echo "$count blocks of ${#pages[@]} pages run, $failed pages failed"
[ "$failed" -eq 0 ]
