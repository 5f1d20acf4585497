#!/usr/bin/env bash
# How long are the sentences of README.md and docs/*.md? docs/words.sh [FOLDER]
# Prints a line a file. Exits 1 where a file's mean is above 20 words, and says its longest sentence.
#
# What is read as prose counts: paragraphs, list items, cells of tables with more than 8 words. Code blocks,
# headings, shorter cells, pictures and targets of links do not. `code` is one word, and so is a formula
# between $; one between $$ is a code block. A word has a letter or a digit. A sentence ends at . ! ? before a capital,
# a digit or code, and with its paragraph, item or cell. No colon and no semicolon ends one.
set -euo pipefail
cd "${1:-$(dirname "${BASH_SOURCE[0]}")/..}"
shopt -s nullglob
files=(README.m[d] docs/*.md)
[ "${#files[@]}" -gt 0 ] || { echo "there is no README.md and no docs/*.md in $PWD" >&2; exit 2; }

awk -v most=20 '
function words_of(text,    parts, n, i, count) {
  n = split(text, parts, /[ \t]+/)
  for (i = 1; i <= n; i++) if (parts[i] ~ /[A-Za-z0-9]/) count++
  return count + 0
}
function take_sentence(text,    n) {
  n = words_of(text)
  if (!n) return
  words += n
  sentences++
  if (n > longest) { longest = n; longest_text = text }
}
function take_prose(text) {
  gsub(/`[^`]*`/, "Code", text)
  gsub(/\$[^$]+\$/, "Code", text)                  # a formula
  gsub(/!\[[^]]*\]\([^)]*\)/, "", text)
  gsub(/\]\([^)]*\)/, "", text)
  gsub(/[*_\[\]]/, "", text)
  gsub(/ \.\.+ /, " to ", text)                    # 1 .. 2 is a range
  while (match(text, /[.!?][")\047]*[ ]+["(\047]*[A-Z0-9]/)) {
    take_sentence(substr(text, 1, RSTART))
    text = substr(text, RSTART + 1)
  }
  take_sentence(text)
}
function take_row(row,    cells, n, i) {
  gsub(/\\\|/, "/", row)
  n = split(row, cells, "|")
  for (i = 1; i <= n; i++) if (words_of(cells[i]) > 8) take_prose(cells[i])
}
function end_block() {
  if (block != "") take_prose(block)
  block = ""
}
function end_file(    mean) {
  if (file == "") return
  end_block()
  mean = sentences ? words / sentences : 0
  printf "%-22s %5d words %5d sentences %6.1f words a sentence%s\n", file, words, sentences, mean,
    (mean > most ? ", above " most : "")
  if (mean > most) printf "  the longest, %d words:%s\n", longest, longest_text
  if (fenced) printf "%s: a code block does not end\n", file
  if (mean > most || fenced) faults++
}
FNR == 1 {
  end_file()
  file = FILENAME
  words = sentences = longest = fenced = in_list = 0
  after_blank = 1
}
/^[^ ]/ && !/^([-*]|[0-9]+\.) / && after_blank { in_list = 0 }
/^ *```/ { end_block(); fenced = !fenced; next }
/^ *\$\$/ { end_block(); if ($0 !~ /\$\$.*\$\$/) fenced = !fenced; next }
fenced { next }
/^ *$/ { end_block(); after_blank = 1; next }
/^    / && after_blank && !in_list { next }        # a code block by its indent
{ after_blank = 0 }
/^#/ { end_block(); next }
/^ *\|/ { end_block(); take_row($0); next }
/^ *([-*]|[0-9]+\.) / { end_block(); in_list = 1; sub(/^ *([-*]|[0-9]+\.) /, ""); block = " " $0; next }
{ block = block " " $0 }
END { end_file(); exit faults > 0 }
' "${files[@]}"
