"""A table of palm positions from a motion-capture system becomes a dataset."""

import csv
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt

import igrip

folder = Path(tempfile.mkdtemp())
with (folder / "take1.csv").open("w", newline="") as file:  # 100 Hz, millimetres
    table = csv.writer(file)
    table.writerow(["frame", "palm x", "palm y", "palm z"])
    for frame in range(200):
        done = min(max((frame - 50) / 100, 0.0), 1.0)
        done = 10 * done**3 - 15 * done**4 + 6 * done**5
        table.writerow([frame, 200 - 150 * done, 350 * done, 50 + 40 * done])
(folder / "map.toml").write_text("""
unit = "mm"
rate = 100.0
[samples]
frame = "frame"
x = "palm x"
y = "palm y"
z = "palm z"
[trials]
hand = "=right"
target = "=mustard"
[objects.mustard]
x = 50
y = 400
z = 0
""")
command = [sys.executable, "-m", "igrip", "import", "take1.csv"]
command += ["--columns", "map.toml", "--out", "ours"]
print(subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True).stdout)

recording = next((folder / "ours" / "recordings").iterdir())
messages = list(igrip.open_source(recording))
palms = [m.hands["right"].position for m in messages if m.hands]
figure, axes = plt.subplots(figsize=(4, 4), layout="constrained")
axes.plot([p[0] for p in palms], [p[1] for p in palms], label="palm")
axes.plot(0.05, 0.4, "s", label="mustard")
axes.set(xlabel="x [m]", ylabel="y [m]", aspect="equal", title="seen from above")
axes.legend()
figure.savefig(sys.argv[1]) if len(sys.argv) > 1 else plt.show()
