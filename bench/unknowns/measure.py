"""Time and memory of bodies of many unknowns, CalculiX on the same mesh beside it (README.md)."""

import argparse
import json
import os
import resource
import subprocess
import time

import numpy as np

import block


def run(command, folder, memory):
    """What it printed, and its seconds and peak memory. `memory`: bytes that it may take, None: all."""
    def limit():
        if memory:
            resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    names = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "CCX_NPROC_EQUATION_SOLVER")
    start = time.monotonic()
    with open(os.path.join(folder, "out.txt"), "w+") as out, open(os.path.join(folder, "err.txt"), "w+") as err:
        child = subprocess.Popen(command, cwd=folder, stdout=out, stderr=err, preexec_fn=limit,
                                 env={**os.environ, **{name: "1" for name in names}})
        _, status, used = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0), err.seek(0)
        return {"exit": child.returncode, "wall": round(time.monotonic() - start, 2),
                "cpu": round(used.ru_utime + used.ru_stime, 2), "gb": round(used.ru_maxrss * 1024 / 1e9, 3)}, out.read(), err.read()


def mesh_of(program, folder, unknowns, memory):
    """The mesh that comes nearest: a box is cut at halves of its edges, so that numbers of nodes jump."""
    block.write_surface(os.path.join(folder, "block.obj"))
    edge, nearest = (np.prod(block.SIZE) / (unknowns / 30.0)) ** (1 / 3) * 1.9, None
    low, high = 0.0, np.inf  # edges that give too many and too few
    for _ in range(8):
        used, out, err = run([program, "mesh", "block.obj", "--edge", "%.6g" % edge, "-o", "trial.vtu", "--json"], folder, memory)
        if used["exit"]:
            raise SystemExit("%s\nhookeye mesh --edge %g fails" % (err, edge))
        quality = json.loads(out)["quality"]
        ratio = 3 * quality["nodes"] / unknowns
        if nearest is None or abs(np.log(ratio)) < abs(np.log(nearest["ratio"])):
            nearest = used | {"asked_edge": round(edge, 4), "edge": quality["mean_edge"], "ratio": ratio}
            os.replace(os.path.join(folder, "trial.vtu"), os.path.join(folder, "body.vtu"))
        if abs(ratio - 1) < 0.03:
            break
        low, high = (edge, high) if ratio > 1 else (low, edge)
        edge *= ratio ** (1 / 3)
        if not low < edge < high:
            edge = (low * high) ** 0.5
    return nearest


def hookeye(program, folder, memory):
    block.write_capture(folder)
    used, out, err = run([program, "simulate", folder, "-o", os.path.join(folder, "run"), "--threads", "1", "--json"], folder, memory)
    if used["exit"]:
        return used | {"said": err.strip()}
    told = json.loads(out)
    return used | {"unknowns": told["unknowns"]} | {
        key: told["examples"][0][key] for key in ("newton_iterations", "factorizations", "max_displacement")}


def calculix(folder, memory):
    """Beside Hookeye's displacements, where it has some."""
    mesh = block.Vtu(os.path.join(folder, "body.vtu"))
    block.write_deck(os.path.join(folder, "deck.inp"), mesh)
    used, out, err = run(["ccx", "-i", "deck"], folder, memory)
    points = mesh["Points"]
    u = block.read_displacements(os.path.join(folder, "deck.dat"), len(points))
    if used["exit"] or "*ERROR" in out or u is None:
        return used | {"said": (out + err).strip()[-300:]}
    told = used | {"iterations": out.count("iteration "), "max_displacement": float(np.linalg.norm(u, axis=1).max())}
    ours = os.path.join(folder, "run", "deformed", "weight.vtu")
    if os.path.exists(ours):
        told["difference"] = float(np.abs(block.Vtu(ours)["displacement"] - u).max())
    return told


def solved_by(solver, program, folder, memory):
    """Equilibrium and sensitivities by five parameters, by the functions that commands call."""
    used, out, err = run([program, "body.vtu", solver, solver + ".bin"], folder, memory)
    if used["exit"]:
        return used | {"said": err.strip()[-300:]}
    solves = [line.split() for line in err.splitlines() if "multigrid:" in line and "iterations to" in line]
    exact = [int(words[2]) for words in solves if words[-1] == "1e-10"]  # sensitivities
    told = used | json.loads(out) | {"iterations": sum(int(words[2]) for words in solves) - sum(exact), "last": max(exact, default=0), "mumps": "MUMPS" in err}
    both = [os.path.join(folder, one + ".bin") for one in ("direct", "multigrid")]
    if all(map(os.path.exists, both)):
        points = block.Vtu(os.path.join(folder, "body.vtu"))["Points"].ravel()
        direct, other = (np.fromfile(one).reshape(6, -1) for one in both)
        direct[0] -= points
        other[0] -= points
        apart = np.abs(direct - other).max(axis=1) / np.abs(direct).max(axis=1)
        told |= {"apart": float(apart[0]), "sensitivities_apart": float(apart[1:].max())}
    return told


def solver_table(results):
    rows = ["| unknowns | solver | equilibrium, CPU | Newton steps, tangents | iterations | five sensitivities, CPU | iterations of each | GB | displacement, sensitivities apart |",
            "|---|---|---|---|---|---|---|---|---|"]
    for _, result in sorted(results.items(), key=lambda item: float(item[0])):
        for solver, r in result.get("solvers", {}).items():
            if "said" in r:
                rows.append("| – | %s | %s |" % (solver, r["said"].splitlines()[-1]))
                continue
            steps = "%d, %d" % (r["newton"], r["factors"])
            rows.append("| %s | %s | %.3g s | %s | %s | %.3g s | %s | %.2g | %s |" % (
                format(r["unknowns"], ","), solver + (" (MUMPS)" if r["mumps"] else ""), r["equilibrium_s"], steps, r["iterations"] or "–",
                r["sensitivities_s"], r["last"] or "–", r["gb"],
                "%.0e, %.0e" % (r["apart"], r["sensitivities_apart"]) if "apart" in r else "–"))
    return "\n".join(rows) if len(rows) > 2 else ""


def keep(file, results):
    with open(file + ".part", "w") as there:
        json.dump(results, there, indent=1)
    os.replace(file + ".part", file)


def duration(used):
    return "%.3g" % used["cpu"] if not used["exit"] and "said" not in used else "–"


def table(results):
    rows = ["| unknowns | mean edge | meshed in, GB | Hookeye, CPU | GB | wall | Newton, factors | CalculiX, CPU | GB | largest difference |",
            "|---|---|---|---|---|---|---|---|---|---|"]
    refused = []
    for asked, r in sorted(results.items(), key=lambda item: float(item[0])):
        ours, theirs = r["hookeye"], r.get("ccx")
        row = ["%d" % ours.get("unknowns", float(asked)), "%.3g mm" % r["mesh"]["edge"],
               "%s s, %.2g" % (duration(r["mesh"]), r["mesh"]["gb"])]
        if "said" in ours:
            refused.append("%s: %s" % (row[0], ours["said"]))
            row += ["refused", "%.3g" % ours["gb"], "%.0f s" % ours["wall"], "–"]
        else:
            row += [duration(ours) + " s", "%.3g" % ours["gb"], "%.0f s" % ours["wall"],
                    "%d, %d" % (ours["newton_iterations"], ours["factorizations"])]
        if theirs and "said" not in theirs:
            row += [duration(theirs) + " s", "%.3g" % theirs["gb"], "%.1e mm" % theirs.get("difference", float("nan"))]
        else:
            row += ["fails" if theirs else "–", "%.3g" % theirs["gb"] if theirs else "–", "–"]
        rows.append("| " + " | ".join(row) + " |")
    return "\n".join(rows + ["", *refused]).strip()


def main():
    ask = argparse.ArgumentParser(description=__doc__)
    ask.add_argument("hookeye")
    ask.add_argument("out", help="folder for meshes and results")
    ask.add_argument("--unknowns", default="30e3,100e3,300e3", help="sizes, with commas")
    ask.add_argument("--ccx", default="30e3", help="sizes that CalculiX solves too")
    ask.add_argument("--solver", default="", help="direct, multigrid (with commas): bench_unknowns instead of the command")
    ask.add_argument("--memory", type=float, help="GB that one program may take")
    told = ask.parse_args()
    sizes = {"%g" % float(x) for x in told.unknowns.split(",")}
    beside = {"%g" % float(x) for x in told.ccx.split(",") if x}
    program, memory = os.path.abspath(told.hookeye), int(told.memory * 1e9) if told.memory else None
    os.makedirs(told.out, exist_ok=True)
    file = os.path.join(os.path.abspath(told.out), "results.json")
    results = {}
    if os.path.exists(file):
        with open(file) as there:
            results = json.load(there)
    for size in sorted(sizes if told.solver else sizes | beside, key=float):
        folder = os.path.join(os.path.abspath(told.out), size)
        os.makedirs(folder, exist_ok=True)
        result = results.setdefault(size, {})
        for solver in [one for one in told.solver.split(",") if one]:
            if "mesh" not in result:
                result["mesh"] = mesh_of(program, folder, float(size), memory)
            beside_app = os.path.join(os.path.dirname(program), "..", "bench", "bench_unknowns")
            result.setdefault("solvers", {})[solver] = solved_by(solver, os.path.abspath(beside_app), folder, memory)
            keep(file, results)
            print(size, solver, json.dumps(result["solvers"][solver]), flush=True)
        if told.solver:
            continue
        if "hookeye" not in result or "said" in result["hookeye"]:
            if "mesh" not in result:
                result["mesh"] = mesh_of(program, folder, float(size), memory)
            result["hookeye"] = hookeye(program, folder, memory)
            keep(file, results)
            print(size, json.dumps(result), flush=True)
        if size in beside and "ccx" not in result:
            result["ccx"] = calculix(folder, memory)
            keep(file, results)
            print(size, "CalculiX", json.dumps(result["ccx"]), flush=True)
    text = "\n\n".join(filter(None, [table({k: r for k, r in results.items() if "hookeye" in r}), solver_table(results)]))
    with open(os.path.join(told.out, "table.md"), "w") as there:
        there.write(text + "\n")
    print(text)


if __name__ == "__main__":
    main()
