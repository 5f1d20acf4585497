#!/usr/bin/env bash
# Does every link and reference to a page hold? docs/links.sh [FOLDER]
# Looks at all Markdown files: targets of links, and their #anchors. Looks at all sources and pages too:
# docs/NAME.md, and what follows as in `NAME.md, "Heading"` or `NAME.md, Heading`. Exits 1 with file and line.
# Addresses of the web are not asked.
set -euo pipefail
cd "${1:-$(dirname "${BASH_SOURCE[0]}")/..}"
all=$(find . \( -name '.?*' -o -name node_modules -o -name 'build*' -o -path ./tests/docs \) -prune -o -print |
  sed 's|^\./||' | sort)
pages=$(grep '\.md$' <<<"$all" || true)
[ -n "$pages" ] || { echo "there is no Markdown in $PWD" >&2; exit 2; }
sources=$(grep -E '\.(md|h|cpp|py|sh|mjs|ts|txt|cmake|yaml)$' <<<"$all")

awk -v all="$all" '
function slug(text) {
  text = tolower(text)
  gsub(/[^a-z0-9 _-]/, "", text)
  gsub(/ /, "-", text)
  return text
}
function resolved(folder, target,    parts, n, i, out, depth) {
  n = split(folder "/" target, parts, "/")
  for (i = 1; i <= n; i++) {
    if (parts[i] == ".." && depth) depth--
    else if (parts[i] != "" && parts[i] != ".") out[++depth] = parts[i]
  }
  target = out[1]
  for (i = 2; i <= depth; i++) target = target "/" out[i]
  return target
}
function fault(what) {
  what = FILENAME ":" FNR ": " what
  if (what in told) return
  told[what] = 1
  print what
  faults++
}
# A heading of `page` begins with `text`.
function has_heading(page, text,    i) {
  for (i = 1; i <= headings[page]; i++) if (index(heading[page, i], text) == 1) return 1
  return 0
}
function take_link(target,    at, anchor, path) {
  if (target ~ /^[a-z]+:/) return
  at = index(target, "#")
  anchor = at ? substr(target, at + 1) : ""
  path = at ? substr(target, 1, at - 1) : target
  path = path == "" ? FILENAME : resolved(folder, path)
  links++
  if (!(path in there)) fault("`" target "` is not there")
  else if (anchor != "" && !((path, anchor) in anchors)) fault("`" path "` has no heading #" anchor)
}
function take_reference(text,    name, page) {
  name = text
  sub(/\.md.*/, ".md", name)
  page = "docs/" name
  if (!(page in there)) return
  sub(/^[^,]*, /, "", text)
  gsub(/"/, "", text)
  links++
  if (!has_heading(page, text)) fault("`" page "` has no heading `" text "`")
}
BEGIN { n = split(all, names, "\n"); for (i = 1; i <= n; i++) there[names[i]] = 1 }
FNR == 1 {
  fenced = 0
  folder = FILENAME
  if (!sub(/\/[^\/]*$/, "", folder)) folder = ""
}
/^ *```/ { fenced = !fenced }
pass == 1 {
  if (!fenced && /^#+ /) {
    text = $0
    sub(/^#+ /, "", text)
    heading[FILENAME, ++headings[FILENAME]] = text
    anchors[FILENAME, slug(text)] = 1
  }
  next
}
{
  line = $0
  if (FILENAME ~ /\.md$/ && !fenced) {
    rest = line
    gsub(/`[^`]*`/, "", rest)
    while (match(rest, /\]\([^)]+\)/)) {
      take_link(substr(rest, RSTART + 2, RLENGTH - 3))
      rest = substr(rest, RSTART + RLENGTH)
    }
  }
  rest = line
  while (match(rest, /docs\/[a-z-]+\.(md|sh)/)) {
    links++
    path = substr(rest, RSTART, RLENGTH)
    if (!(path in there)) fault("`" path "` is not there")
    rest = substr(rest, RSTART + RLENGTH)
  }
  rest = line
  while (match(rest, /[a-z-]+\.md, ("[A-Z][^"]*|[A-Z][a-z]+)/)) {
    take_reference(substr(rest, RSTART, RLENGTH))
    rest = substr(rest, RSTART + RLENGTH)
  }
}
END {
  printf "%d links and references, %d wrong\n", links, faults
  exit faults > 0
}
' pass=1 $pages pass=2 $sources
