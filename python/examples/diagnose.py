"""Fits, asks which effect is missing, and prints why: the decision log of the diagnosis.

python3 diagnose.py CAPTURE RUN
"""

import logging
import sys

import hookeye as he

logging.basicConfig(level=logging.WARNING)  # the program's lines, under the name "hookeye"

run = he.fit(he.Capture(sys.argv[1]), out=sys.argv[2])
diagnosis = run.diagnose()
print(diagnosis.table[["effect", "evidence", "explains", "named"]].head(8).to_string(index=False))
print(diagnosis.verdict)
print("cannot be told apart:", ", ".join(diagnosis.ties) or "none may be named")

for effect in diagnosis.ties[:1]:
    for line in run.why(effect).itertuples():
        print(f"{line.asked}: {'yes' if line.accepted else 'no'}, {line.why} "
              f"({line.value} against {line.limit}) [{line.where}]")
