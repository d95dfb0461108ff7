"""Two estimators on a small simulated cohort: how early is each right?"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt


def igrip(*arguments: str | Path) -> str:
    command = [sys.executable, "-m", "igrip", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


cohort = Path(tempfile.mkdtemp()) / "cohort"
igrip("simulate", cohort, "--participants", "1", "--trials", "8", "--no-reach", "0")
results = json.loads(igrip("replay", cohort, "--targets", "bayes", "--targets", "paper", "--json"))

columns = ["accuracy_40%", "accuracy_60%", "success"]
labels = ["at 40 % of\nthe movement", "at 60 %", "trials right"]
figure, axes = plt.subplots(figsize=(5, 3), layout="constrained")
overall = [row for row in results["results"] if row["group"] == "all"]
for place, row in enumerate(overall):
    shares = [100 * row[column] for column in columns]
    positions = [index + 0.4 * place for index in range(len(columns))]
    bars = axes.bar(positions, shares, width=0.35, label=row["targets"], hatch=["", "//"][place])
    axes.bar_label(bars, fmt="%.0f")
    print(row["targets"], [f"{share:.0f} %" for share in shares])
axes.set(ylabel="right [%]", ylim=(0, 110), title=f"{results['trials']} simulated recordings")
axes.set_xticks([0.2, 1.2, 2.2], labels)
axes.legend(loc="lower right")
figure.savefig(sys.argv[1]) if len(sys.argv) > 1 else plt.show()
