# Sourced by ./package and ./release, which stand in the source folder: the source archive, with the page
# built, so that what is built from it asks no network.

version_of_sources() { sed -n 's/^project(hookeye VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt; }

# The files of the project, new ones too: git's; where there is no git, all but what is built.
source_files() {
  if git rev-parse --is-inside-work-tree >/dev/null 2>&1; then
    git ls-files -co --exclude-standard | while IFS= read -r file; do [ ! -f "$file" ] || printf '%s\n' "$file"; done
  else
    find . -mindepth 1 \( -name .git -o -path './build*' -o -name node_modules -o -path './*-out' -o -path ./studio/dist \) \
      -prune -o -type f -print | sed 's|^\./||' | LC_ALL=C sort
  fi
}

# built_page FILE: the page, from studio/ by npm; or HOOKEYE_PAGE=FILE, which is one that is built. The npm
# packages' notices follow it.
built_page() {
  if [ -n "${HOOKEYE_PAGE:-}" ]; then
    cp "$HOOKEYE_PAGE" "$1"
    return
  fi
  if [ -f studio/built/page.html ]; then  # this is an unpacked source archive
    cp studio/built/page.html "$1"
    return
  fi
  [ -f build/release/build.ninja ] || cmake --preset release -DHOOKEYE_TESTS=OFF >/dev/null ||
    die "configuring failed, and with it the page"
  cmake --build build/release --target built_page ||
    die "the page was not built. It wants Node.js and the npm registry; or give one: HOOKEYE_PAGE=FILE"
  cp build/release/page/page.html "$1"
}

# source_archive FOLDER: FOLDER/hookeye-VERSION.tar.xz; sets `archive`. The same sources give the same bytes.
source_archive() {
  local version name described=''
  version=$(version_of_sources)
  [ -n "$version" ] || die "CMakeLists.txt tells no version"
  name=hookeye-$version
  mkdir -p "$1"
  rm -rf "${1:?}/$name"
  mkdir "$1/$name"
  source_files | tar -c --verbatim-files-from -T - | tar -x -C "$1/$name"
  mkdir -p "$1/$name/studio/built"
  built_page "$1/$name/studio/built/page.html"
  grep -q '<!--hookeye:document-->' "$1/$name/studio/built/page.html" ||
    die "$1/$name/studio/built/page.html is not Hookeye's page"
  described=$(git describe --tags --match 'v[0-9]*' --always --dirty 2>/dev/null) ||
    described=$(cat described 2>/dev/null) || true
  [ -z "$described" ] || printf '%s\n' "$described" >"$1/$name/described"
  archive=$1/$name.tar.xz
  local when=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct 2>/dev/null || date +%s)}
  tar -c -C "$1" --sort=name --owner=0 --group=0 --numeric-owner --mode=go=rX,u+rw --mtime="@$when" "$name" |
    xz -6 -T0 >"$archive"
}
