#!/usr/bin/env bash
# The figures and pictures of docs/real-data.md: docs/real-data.sh SHARED_DATA/real OUT [CASE]
# CASE: reference, hidden, openhole, red, blue, tango or laws; without it all of them.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source cmake/bootstrap.sh
install_packages
build_hookeye real_data_figures
exec "$build_folder/tests/real/real_data_figures" "$@"
