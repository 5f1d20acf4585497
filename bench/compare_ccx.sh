#!/bin/sh
# CalculiX on a reference deck beside Hookeye's cold solve, one thread each, CPU seconds.
# Usage: bench/compare_ccx.sh BUILD_DIR REFERENCE_DIR [DECK, default q30k_B]
set -eu
build=$1 reference=$2 deck=${3:-q30k_B}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$reference/$deck.inp" "$work/"
cd "$work"
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
echo "ccx $deck:"
bash -c "time ccx $deck > ccx.log"
cd - > /dev/null
echo "Hookeye, q30k B:"
"$build/bench/bench_simulation" --benchmark_filter='^(factor|cold)'
