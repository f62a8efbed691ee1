"""Tables and verdicts from the rows of registration_experiment. Pairs of scans are the unit of every statistic: starts
on one pair mostly end in the same place, so they say little about other scans."""

import math
from collections import defaultdict

import numpy as np

SPS = "stratified"  # the paper's rival
SBS = "shape-nb"    # ours as registration uses it
PAPER_SBS = "paper"
FEWEST_PAIRS = 5    # that a statistic over pairs asks for


class Runs:
    """Rows by (method, sampler, percent) and pair."""

    def __init__(self, rows):
        self.cells = defaultdict(lambda: defaultdict(list))
        for row in rows:
            for name in ("e_mu", "e_delta"):
                if row.get(name):
                    row[f"relative_{name}"] = float(row[name]) / float(row[f"truth_{name}"])
            self.cells[row["method"], row["sampler"], float(row["percent"])][row["pair"]].append(row)
        self.truth = {row["pair"]: row["truth"] for row in rows if "truth" in row}

    def pairs(self, method, sampler, percent):
        return self.cells.get((method, sampler, percent), {})

    def per_pair(self, method, sampler, percent, column, only_success=False):
        """{pair: median of the column}."""
        found = {}
        for pair, rows in self.pairs(method, sampler, percent).items():
            values = [float(r[column]) for r in rows if r.get(column) and (r["success"] == "1" or not only_success)]
            if values:
                found[pair] = float(np.median(values))
        return found

    def solved(self, method, sampler, percent, column):
        """The same for the pairs that are solved from half of their starts or more."""
        cells = self.pairs(method, sampler, percent)
        solved = {p for p, rows in cells.items() if np.mean([r["success"] == "1" for r in rows]) >= 0.5}
        return {p: v for p, v in self.per_pair(method, sampler, percent, column).items() if p in solved}

    def success(self, method, sampler, percent):
        """Share over all runs, each pair counting the same; None without runs."""
        shares = [np.mean([r["success"] == "1" for r in rows])
                  for rows in self.pairs(method, sampler, percent).values()]
        return float(np.mean(shares)) if shares else None


def ratio(one, other, repeats=2000):
    """Geometric mean over pairs of one[pair] / other[pair], and its 95 % interval, bootstrapped over pairs.
    {"ratio", "low", "high", "pairs"}, or None when fewer than five pairs have both."""
    both = sorted(set(one) & set(other))
    logs = np.array([math.log(max(one[p], 1e-9) / max(other[p], 1e-9)) for p in both])
    if len(logs) < FEWEST_PAIRS:
        return None
    draws = np.random.default_rng(2013).integers(0, len(logs), (repeats, len(logs)))
    low, high = np.exp(np.percentile(logs[draws].mean(axis=1), [2.5, 97.5]))
    return {"ratio": float(np.exp(logs.mean())), "low": float(low), "high": float(high), "pairs": len(logs)}


def say_ratio(r):
    return f"{r['ratio']:.2f} [{r['low']:.2f}, {r['high']:.2f}]" if r else ""


def markdown_table(heads, lines):
    return "\n".join("| " + " | ".join(map(str, line)) + " |"
                     for line in [heads, ["---"] * len(heads), *lines]) + "\n"


def median_of(values):
    return float(np.median(list(values))) if values else None


def number(value, form=".2f"):
    return "" if value is None else format(value, form)


def accuracy_table(runs, methods, samplers, percent):
    """Median over pairs of the rotation error of successful runs, and the share of successes."""
    lines = []
    for sampler in samplers:
        cells = [(median_of(runs.per_pair(m, sampler, percent, "rotation_deg", True).values()),
                  runs.success(m, sampler, percent)) for m in methods]
        if any(share is not None for _, share in cells):
            lines.append([sampler, *(f"{number(error)} ({100 * share:.0f} %)" if share is not None else ""
                                     for error, share in cells)])
    return markdown_table(["sampler", *methods], lines)


def ratio_table(runs, methods, samplers, percent, column="rotation_deg"):
    """Error relative to stratified samples of the same pair, over the pairs that both solve."""
    lines = []
    for sampler in samplers:
        if sampler == SPS:
            continue
        cells = [say_ratio(ratio(runs.solved(m, sampler, percent, column), runs.solved(m, SPS, percent, column)))
                 for m in methods]
        if any(cells):
            lines.append([sampler, *cells])
    return markdown_table(["sampler", *methods], lines)


def unsolved_table(runs, methods, samplers, percent):
    """Success on the pairs that not every method solves from every start."""
    lines = []
    for pair in sorted(runs.truth):
        cells = []
        for method in methods:
            for sampler in samplers:
                rows = runs.pairs(method, sampler, percent).get(pair, [])
                cells.append(f"{100 * np.mean([r['success'] == '1' for r in rows]):.0f} %" if rows else "")
        if any(cell not in ("", "100 %") for cell in cells):
            lines.append([pair, *cells])
    return markdown_table(["pair", *(f"{m}, {s}" for m in methods for s in samplers)], lines)


def sampling_table(samplings, percent):
    columns = ["no_counterpart", "hit", "chance", "close_hit", "mutual", "boundary", "cpu_ms"]
    lines = []
    for sampler in dict.fromkeys(row["sampler"] for row in samplings):
        rows = [r for r in samplings if r["sampler"] == sampler and float(r["percent"]) == percent]
        if rows:
            means = [np.mean([float(r[c]) for r in rows]) for c in columns]
            lines.append([sampler, *(f"{m:.3f}" for m in means[:-1]), f"{means[-1]:.0f}"])
    heads = ["sampler", "no counterpart", "hit", "chance", "within one spacing", "mutual", "on the border", "CPU ms"]
    return markdown_table(heads, lines)


def sweep_table(runs, methods, samplers, percents):
    """Rotation error, e_mu and CPU time against P, over the pairs that were run at every P."""
    lines = []
    for method in methods:
        for sampler in samplers:
            common = set.intersection(*(set(runs.pairs(method, sampler, p)) for p in percents))
            if not common:
                continue

            def over_pairs(percent, column):
                found = runs.per_pair(method, sampler, percent, column)
                return median_of([found[p] for p in common if p in found])

            lines.append([method, sampler,
                          *(" / ".join([number(over_pairs(p, "rotation_deg")), number(over_pairs(p, "relative_e_mu")),
                                        number(over_pairs(p, "cpu_ms"), ".0f")]) for p in percents)])
    return markdown_table(["method", "sampler", *(f"{p:g} %" for p in percents)], lines)


def polish_table(runs, methods, samplers, percent):
    lines = []
    for sampler in samplers:
        cells = []
        for m in methods:
            before, after = (runs.per_pair(m, sampler, percent, c) for c in ("rotation_deg", "polished_rotation_deg"))
            common = before.keys() & after.keys()
            cells.append(f"{median_of([before[p] for p in common]):.2f} -> "
                         f"{median_of([after[p] for p in common]):.2f}" if common else "")
        if any(cells):
            lines.append([sampler, *cells])
    return markdown_table(["sampler", *methods], lines)


def polish_ratio(runs, method, percent):
    """Polished error with samples by shape over that with stratified ones."""
    return say_ratio(ratio(runs.solved(method, SBS, percent, "polished_rotation_deg"),
                           runs.solved(method, SPS, percent, "polished_rotation_deg")))


def peer_table(runs, peers, samplers, percent):
    """Our methods and others' on the same samples and starts."""
    lines = []
    for source, methods in ((runs, ["ficp", "softicp", "icp", "plane", "gicp"]),
                            (peers, list(dict.fromkeys(m for m, *_ in peers.cells)))):
        for method in methods:
            for sampler in samplers:
                if not source.pairs(method, sampler, percent):
                    continue
                prepare = median_of(source.per_pair(method, sampler, percent, "prepare_cpu_ms").values())
                lines.append([method if source is peers else f"shapelight {method}", sampler,
                              f"{100 * source.success(method, sampler, percent):.0f} %",
                              number(median_of(source.per_pair(method, sampler, percent, "rotation_deg",
                                                               True).values()), ".3f"),
                              number(median_of(source.per_pair(method, sampler, percent, "cpu_ms").values()), ".1f"),
                              number(prepare, ".1f")])
    heads = ["method", "sampler", "success", "rotation error [deg]", "CPU ms", "preparing, CPU ms"]
    return markdown_table(heads, lines)


def verdict(r, wanted="below"):
    """holds, does not hold or undecided: the interval against 1."""
    if r is None:
        return "not measured"
    if wanted == "above":
        r = {"low": 1 / r["high"], "high": 1 / r["low"]}
    return "holds" if r["high"] < 1 else "does not hold: the opposite" if r["low"] > 1 else "undecided"


def claims(runs, samplings):
    """[(claim of section III.B, what was measured, verdict)]."""
    found = []

    def add(claim, measured, result):
        found.append([claim, measured, result])

    def compare(claim, method, one, other, percent, column, wanted="below"):
        r = ratio(runs.solved(method, one, percent, column), runs.solved(method, other, percent, column))
        add(claim, f"{say_ratio(r)} over {r['pairs']} pairs" if r else "", verdict(r, wanted))

    for sbs in (PAPER_SBS, SBS):
        for method in ("ficp-pure", "ficp", "softicp"):
            for percent in (10.0, 5.0):
                compare(f"{method} at P = {percent:g} %: `{sbs}` turns out more accurate than `{SPS}` "
                        "(rotation error, ratio)", method, sbs, SPS, percent, "rotation_deg")
            compare(f"{method} at P = 5 %: smaller e_mu with `{sbs}` (ratio)", method, sbs, SPS, 5.0, "e_mu")
            compare(f"{method} at P = 5 %: `{sbs}` takes less time than `{SPS}`, sampling left out (CPU, ratio)",
                    method, sbs, SPS, 5.0, "cpu_ms")
    for sampler in (SBS, SPS):
        r = ratio(runs.solved("softicp", sampler, 5.0, "rotation_deg"),
                  runs.solved("ficp-pure", sampler, 5.0, "rotation_deg"))
        add(f"SoftICP is more accurate than FICP (`{sampler}`, P = 5 %, ratio)", say_ratio(r), verdict(r))
        for method in ("ficp-pure", "softicp"):
            r = ratio(runs.solved(method, sampler, 5.0, "rotation_deg"),
                      runs.solved(method, sampler, 10.0, "rotation_deg"))
            add(f"{method} gets worse from P = 10 % to 5 % (`{sampler}`, ratio)", say_ratio(r), verdict(r, "above"))
    drop = {s: ratio(runs.solved("ficp-pure", s, 5.0, "rotation_deg"),
                     runs.solved("ficp-pure", s, 95.0, "rotation_deg")) for s in (SBS, SPS)}
    add("accuracy drops more slowly with `shape-nb` than with `stratified` (FICP, error at 5 % over error at 95 %)",
        f"{say_ratio(drop[SBS])} against {say_ratio(drop[SPS])}",
        "not measured" if not all(drop.values())
        else "holds" if drop[SBS]["high"] < drop[SPS]["low"]
        else "does not hold: the opposite" if drop[SBS]["low"] > drop[SPS]["high"] else "undecided")
    r = ratio(runs.solved("softicp", SBS, 5.0, "cpu_ms"), runs.solved("softicp", SBS, 95.0, "cpu_ms"))
    add("time falls with P (SoftICP, CPU at 5 % over CPU at 95 %; the paper: 3 s over 15 s)", say_ratio(r), verdict(r))
    limit = [r["stop"] == "iteration limit" for (m, *_), cell in runs.cells.items() if m == "softicp"
             for rows in cell.values() for r in rows]
    if limit:
        share = float(np.mean(limit))
        add("SoftICP sometimes oscillates (share of its runs that still move at the iteration limit)",
            f"{100 * share:.1f} %", "holds" if share > 0.01 else "does not hold")
    shares = {s: [float(row["mutual"]) for row in samplings
                  if row["sampler"] == s and float(row["percent"]) == 5.0] for s in (SBS, PAPER_SBS, SPS)}
    if all(shares.values()):
        for sbs in (PAPER_SBS, SBS):
            one, other = np.array(shares[sbs]), np.array(shares[SPS])
            add(f"`{SPS}` keeps fewer of the same places than `{sbs}` (mutual hits at 5 %, pairs where that is so)",
                f"{np.mean(one):.2f} against {np.mean(other):.2f}; {np.sum(one > other)} of {len(one)} pairs",
                "holds" if np.mean(one > other) > 0.8 else "does not hold" if np.mean(one > other) < 0.5
                else "undecided")
    return found


def border_table(runs, methods, percent):
    """How much of the gain is the border that is left out, and how much the choice of points."""
    steps = [("border left out: `stratified-nb` over `stratified`", "stratified-nb", SPS),
             ("then points by shape: `shape-nb` over `stratified-nb`", SBS, "stratified-nb"),
             ("both: `shape-nb` over `stratified`", SBS, SPS),
             ("points by shape, border kept: `shape` over `stratified`", "shape", SPS)]
    return markdown_table(["rotation error, ratio", *methods],
                          [[name, *(say_ratio(ratio(runs.solved(m, one, percent, "rotation_deg"),
                                                    runs.solved(m, other, percent, "rotation_deg")))
                                    for m in methods)] for name, one, other in steps])


def targets(runs, samplings):
    """[(target, measured, met)] of our own."""
    found = []

    def add(target, value, met, form=".2f"):
        found.append([target, number(value, form), "met" if met else "missed"] if value is not None
                     else [target, "", "not measured"])

    for method in ("ficp", "softicp"):
        share = runs.success(method, SBS, 5.0)
        add(f"{method}, P = 5 %, starts 5 to 20 degrees off: success >= 99 %", None if share is None else 100 * share,
            share is not None and share >= 0.99, ".1f")
    published = [e for p, e in runs.per_pair("ficp", SBS, 5.0, "rotation_deg").items()
                 if runs.truth.get(p) == "published"]
    add("ficp, P = 5 %, published truth: rotation error <= 0.15 degrees (largest)", max(published, default=None),
        bool(published) and max(published) <= 0.15)
    for method, percent, bound in (("ficp", 5.0, 0.6), ("softicp", 5.0, 0.8), ("ficp", 10.0, 0.8)):
        r = ratio(runs.solved(method, SBS, percent, "rotation_deg"),
                  runs.solved(method, SPS, percent, "rotation_deg"))
        add(f"{method}, P = {percent:g} %: error with {SBS} over error with {SPS} <= {bound}, interval below 1",
            r["ratio"] if r else None, bool(r) and r["ratio"] <= bound and r["high"] < 1)
    for name in ("e_mu", "e_delta"):
        r = ratio(runs.solved("ficp", SBS, 5.0, name), runs.solved("ficp", SBS, 5.0, f"truth_{name}"))
        add(f"ficp, P = 5 %: {name} on the full scans over {name} at the truth, within 3 %", r["ratio"] if r else None,
            bool(r) and abs(r["ratio"] - 1) <= 0.03, ".3f")
    rows = [r for r in samplings if r["sampler"] == SBS and float(r["percent"]) == 5.0]
    add("hit rate at 5 % >= 0.50 (mean)", float(np.mean([float(r["hit"]) for r in rows])) if rows else None,
        bool(rows) and np.mean([float(r["hit"]) for r in rows]) >= 0.5)
    for method, bound in (("ficp", 25), ("softicp", 60)):
        cpu = median_of(runs.per_pair(method, SBS, 5.0, "cpu_ms").values())
        add(f"{method}, P = 5 %: CPU <= {bound} ms (median pair)", cpu, cpu is not None and cpu <= bound, ".1f")
    polished = runs.per_pair("ficp", SBS, 5.0, "polished_rotation_deg")
    full = runs.solved("plane", SBS, 95.0, "polished_rotation_deg")
    common = polished.keys() & full.keys()
    if common:
        best = median_of([full[p] for p in common])
        value = median_of([polished[p] for p in common])
        add(f"polish brings P = 5 % to within 0.03 degrees of plane's optimum at 95 % ({best:.3f})", value,
            value <= best + 0.03, ".3f")
    return found
