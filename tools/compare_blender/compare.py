"""Compares `parbake raycast` with Blender's bake on pairs of models: quality and seconds a texel.

See README.md. Everything runs one after the other with the same number of threads.
"""

import argparse
import json
import os
import subprocess
import sys
import time

HERE = os.path.dirname(os.path.abspath(__file__))
ENDINGS = (".obj", ".glb", ".gltf")


def model_in(folder):
    names = sorted(n for n in os.listdir(folder) if n.lower().endswith(ENDINGS))
    return os.path.join(folder, names[0]) if names else None


def pairs(data, levels, wanted):
    """(name, high, low, the high-poly's colour or none) of folders laid out as `parbake reproduce` wants them."""
    root = os.path.join(data, "pairs")
    for name in sorted(os.listdir(root)):
        folder = os.path.join(root, name)
        high_folder = os.path.join(folder, "high")
        if not os.path.isdir(high_folder) or (wanted and not any(w in name for w in wanted)):
            continue
        high = model_in(high_folder)
        pictures = [n for n in sorted(os.listdir(high_folder)) if n.endswith("_kd.png")]
        color = os.path.join(high_folder, pictures[0]) if pictures else None
        for level in levels:
            low_folder = os.path.join(folder, level)
            low = model_in(low_folder) if os.path.isdir(low_folder) else None
            if high and low:
                yield f"{name} {level}", high, low, color


def run(command):
    begin = time.perf_counter()
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(command)}\n{done.stdout}{done.stderr}")
    return done.stdout, time.perf_counter() - begin


def last_json(text):
    return json.loads(next(line for line in reversed(text.splitlines()) if line.startswith("{")))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("data", help="folder of data that holds pairs/")
    parser.add_argument("--parbake", required=True, help="the program")
    parser.add_argument("--blender-python", default=sys.executable, help="a Python that has bpy")
    parser.add_argument("--evaluator", help="script with the options of reference_eval.py; none measures time alone")
    parser.add_argument("--evaluator-python", default=sys.executable)
    parser.add_argument("--out", default="compared")
    parser.add_argument("--size", type=int, default=512)
    parser.add_argument("--samples", type=int, default=4)
    parser.add_argument("--distance", type=float, default=0.05)
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--levels", nargs="+", default=["low_simplygon", "low_simplygon100", "low_simplygon50"])
    parser.add_argument("--only", nargs="*", default=[], help="parts of names of pairs")
    parser.add_argument("--views", type=int, default=24)
    parser.add_argument("--repeats", type=int, default=3, help="times are the least of so many runs")
    parser.add_argument("--cage", action="store_true", help="Blender's automatic cage")
    parser.epilog = "Options behind -- go to parbake raycast."
    typed = sys.argv[1:]
    end = typed.index("--") if "--" in typed else len(typed)
    a, rest = parser.parse_args(typed[:end]), typed[end + 1:]
    os.makedirs(a.out, exist_ok=True)
    rows = []
    for name, high, low, color in pairs(a.data, a.levels, a.only):
        stem = os.path.join(a.out, name.replace(" ", "_"))
        common = ["--threads", str(a.threads), "--samples", str(a.samples)]
        ours, theirs = [], []
        for _ in range(a.repeats):
            # In turn, so that what else the machine does hits both.
            _, whole = run([a.parbake, "raycast", high, low, "-o", stem + ".glb", "--json", stem + ".json", "-q",
                            "--texture-size", str(a.size), "--max-distance", str(a.distance), "--uv", "keep",
                            *common, *rest])
            with open(stem + ".json") as file:
                stages = {s["stage"]: s["seconds"] for s in json.load(file)["stages"]}
            ours.append((stages["prepare"] + stages["start"], whole))
            text, whole = run([a.blender_python, os.path.join(HERE, "bake.py"), high, low, stem + "_color.png",
                               stem + "_normal.png", "--size", str(a.size), "--distance", str(a.distance),
                               *common, *(["--texture", color] if color else []),
                               *(["--cage"] if a.cage else [])])
            said = last_json(text)
            theirs.append((said["bake_seconds"], whole))
        row = {"pair": name, "blender": said["blender"], "size": a.size, "samples": a.samples, "threads": a.threads,
               "parbake_bake_s": min(ours)[0], "blender_bake_s": min(theirs)[0],
               "parbake_command_s": min(w for _, w in ours), "blender_command_s": min(w for _, w in theirs)}
        row["times_faster"] = row["blender_bake_s"] / row["parbake_bake_s"]
        if a.evaluator and color:
            base = [a.evaluator_python, a.evaluator, "--high", high, "--high-texture", color,
                    "--views", str(a.views), "--summary", "--threads", str(a.threads)]
            for whose, more in (("parbake", ["--low", stem + ".glb"]),
                                ("blender", ["--low", low, "--low-texture", stem + "_color.png",
                                             "--low-normal", stem + "_normal.png"])):
                text, _ = run(base + more)
                figures = json.loads(text[text.index("{"):])
                mean = figures.get("mean", figures)
                row[f"{whose}_psnr"], row[f"{whose}_ms_ssim"] = mean["psnr"], mean["ms_ssim"]
        rows.append(row)
        print(json.dumps(row), flush=True)
        with open(os.path.join(a.out, "compared.json"), "w") as file:
            json.dump(rows, file, indent=1)
    with open(os.path.join(a.out, "compared.md"), "w") as file:
        file.write(table(rows))
    print(table(rows))


def table(rows):
    text = ("| pair | PSNR Blender | PSNR Parbake | gain | MS-SSIM Blender | Parbake | ns a texel Blender | Parbake | faster |\n"
            "|---|---|---|---|---|---|---|---|---|\n")
    for row in rows:
        texels = row["size"] ** 2
        psnr = [row.get(f"{w}_psnr") for w in ("blender", "parbake")]
        ssim = [row.get(f"{w}_ms_ssim") for w in ("blender", "parbake")]
        shown = (["—"] * 5 if None in psnr else
                 [f"{psnr[0]:.2f}", f"{psnr[1]:.2f}", f"{psnr[1] - psnr[0]:+.2f}", f"{ssim[0]:.4f}", f"{ssim[1]:.4f}"])
        nanoseconds = [1e9 * row[f"{w}_bake_s"] / texels for w in ("blender", "parbake")]
        text += "| " + " | ".join([row["pair"], *shown, *(f"{n:.0f}" for n in nanoseconds),
                                   f"{row['times_faster']:.1f} ×"]) + " |\n"
    return text


if __name__ == "__main__":
    main()
