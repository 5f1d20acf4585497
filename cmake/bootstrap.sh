# Sourced by ./check, ./demo and .ci/run: Debian packages, then an incremental build.
# Callers have `set -euo pipefail` and stand in the source folder.

say() { printf '== %s\n' "$*"; }
die() { printf 'error: %s\n' "$*" >&2; exit 1; }

# Package names of packages.txt: one a line, comments after '#'. Lines whose comment begins with
# "check:" are wanted where tests are (HOOKEYE_TESTS=1), with "ci:" by .ci/run alone (HOOKEYE_CI=1).
wanted_packages() {
  local keep='{ if ($0 ~ /#[ ]*check:/ && !tests) next; if ($0 ~ /#[ ]*ci:/ && !ci) next
    sub(/#.*/, ""); if (NF) print $1 }'
  awk -v tests="${HOOKEYE_TESTS:-}" -v ci="${HOOKEYE_CI:-}" "$keep" packages.txt
}

missing_packages() {
  local have
  # dpkg-query fails when it does not know one of the names; what it knows is printed all the same.
  have=$(wanted_packages | xargs dpkg-query -W -f '${db:Status-Abbrev} ${Package}\n' 2>/dev/null |
    awk '$1 == "ii" { print $2 }') || true
  # Another Node.js (18 or newer) serves as well.
  if command -v node >/dev/null; then have+=$'\nnodejs'; fi
  if command -v npm >/dev/null; then have+=$'\nnpm'; fi
  wanted_packages | grep -vxF -f <(printf '%s\n' "$have") || true
}

install_packages() {
  if ! command -v dpkg-query >/dev/null; then
    say "Not a Debian system: taking the packages of packages.txt for granted"
    return
  fi
  local missing root=()
  mapfile -t missing < <(missing_packages)
  [ "${#missing[@]}" -gt 0 ] || return 0
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || die "not root and no sudo. As root, run:
  apt-get update && apt-get install -y --no-install-recommends ${missing[*]}"
    root=(sudo)
  fi
  say "Installing ${#missing[@]} Debian packages (once): ${missing[*]}"
  local apt=("${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q
    -o Acquire::Retries=3 -o DPkg::Lock::Timeout=300)
  "${apt[@]}" update || die "apt-get update failed: no network, or see the message above"
  "${apt[@]}" install -y --no-install-recommends "${missing[@]}" ||
    die "apt-get install failed. Hookeye is built on Debian 12 (bookworm); see the message above"
  mapfile -t missing < <(missing_packages)
  [ "${#missing[@]}" -eq 0 ] || die "still missing after apt-get install: ${missing[*]}"
}

# One compiler takes up to 1.5 GB on the files that are heaviest with templates.
build_jobs() {
  local jobs fit
  jobs=$(nproc)
  fit=$(awk '/^MemAvailable:/ { print int($2 / 1572864) }' /proc/meminfo 2>/dev/null || echo "$jobs")
  [ "${fit:-0}" -ge 1 ] || fit=1
  echo $((jobs < fit ? jobs : fit))
}

# build_hookeye [TARGET...]: sets `build_folder`. HOOKEYE_WERROR=1 makes warnings errors, HOOKEYE_TESTS=1
# configures the tests; without it those that are configured stay so. HOOKEYE_UNITY=0 compiles each
# source by itself, for those who change some.
build_hookeye() {
  local werror=OFF unity=ON wanted
  [ "${HOOKEYE_WERROR:-0}" = 0 ] || werror=ON
  [ "${HOOKEYE_UNITY:-1}" = 1 ] || unity=OFF
  wanted=("HOOKEYE_WERROR:BOOL=$werror" "HOOKEYE_UNITY:BOOL=$unity")
  # Benchmarks are built where nobody waits for them, so that they do not rot.
  [ -z "${HOOKEYE_CI:-}" ] || wanted+=("HOOKEYE_BENCH:BOOL=ON")
  build_folder=build/release
  if [ -n "${HOOKEYE_TESTS:-}" ]; then
    wanted+=("HOOKEYE_TESTS:BOOL=ON")
  elif ! grep -q '^HOOKEYE_TESTS:BOOL=ON$' "$build_folder/CMakeCache.txt" 2>/dev/null; then
    wanted+=("HOOKEYE_TESTS:BOOL=OFF")
  fi
  # What a build can do without may have been installed since.
  if [ ! -f "$build_folder/build.ninja" ] ||
    grep -qE '^(GMSH_LIBRARY|CGAL_DIR|VTK_DIR):.*-NOTFOUND$' "$build_folder/CMakeCache.txt" ||
    [ "$(grep -cxF -f <(printf '%s\n' "${wanted[@]}") "$build_folder/CMakeCache.txt")" -lt ${#wanted[@]} ]; then
    say "Configuring ($build_folder)"
    cmake --preset release "${wanted[@]/#/-D}" || die "configuring failed (see above)"
  fi
  say "Building with $(build_jobs) jobs"
  cmake --build "$build_folder" -j "$(build_jobs)" ${1:+--target "$@"} ||
    die "the build failed (see above)"
}
